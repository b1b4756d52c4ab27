#pragma once

#include <cstdint>

#include "engine/contact/track_window.hpp"

namespace palpate::engine {

/// What certified tracking keeps from tick to tick. A plain value.
struct TrackState {
    Vec2 from{};          ///< HIP of the last search, m
    double slack2 = 0.0;  ///< while |h - from|^2 is less each window holds one minimum only, m^2
    double others = 0.0;  ///< nothing outside the windows was nearer to `from` than this, m

    TrackWindow best{};   ///< holds the global closest point
    TrackWindow rival{};  ///< the next nearest stretch, if it is close behind
    bool has_rival = false;
    Vec2 rival_seen{};      ///< HIP when the rival was last followed, m
    double rival_at = 0.0;  ///< nothing in it was nearer to that HIP than this, m

    std::uint64_t certified = 0;  ///< answers so far that were local, and proved global
    std::uint64_t searched = 0;   ///< answers so far by a global search
};

/// The global closest point of a moving HIP: followed locally, with a proof that it is global.
///
/// A search at h0 finds the global foot and a window of the outline around it in which the distance
/// has a single minimum for every h with |h - h0| < slack (WindowTracker). Where another stretch
/// comes close, as beside the medial axis, the nearest foot of that stretch gets a window too.
/// Everything else is at least `others` away from h0, by the boxes and capsules of the pieces. For
/// a later h the nearer of the followed feet, at distance d, is global if d + |h - h0| < others
/// (the triangle inequality), and no search runs. Otherwise a new search does. By the same
/// inequality the rival is followed only where it may have come nearer since it was followed last.
/// Every answer is therefore the global closest point, to rounding; the error of the distance is
/// that of one curve evaluation.
class CertifiedTracker {
public:
    /// @param outline  must live as long as the tracker
    explicit CertifiedTracker(const Outline& outline);
    CertifiedTracker(const CertifiedTracker&) = delete;
    CertifiedTracker& operator=(const CertifiedTracker&) = delete;

    /// The closest points without certificates, of the same outline.
    [[nodiscard]] const OutlineFeet& feet() const noexcept { return feet_; }

    /// The closest point after HIP moved to h. No allocation, no lock; bit-reproducible.
    [[nodiscard]] ClosestPoint track(TrackState& state, const Vec2& h) const noexcept;

private:
    template <class Curve>
    [[gnu::always_inline]] ClosestPoint track_on(const Curve& curve,
                                                 TrackState& state,
                                                 const Vec2& h) const noexcept;
    template <class Curve>
    [[gnu::noinline]] ClosestPoint track_apart(const Curve& curve,
                                               TrackState& state,
                                               const Vec2& h) const noexcept;
    ClosestPoint rest(TrackState& state, const Vec2& h) const noexcept;
    static bool rival_is_due(const TrackState& state, double distance, const Vec2& h) noexcept;
    ClosestPoint judge(TrackState& state, const WindowFoot& best, const Vec2& h) const noexcept;
    ClosestPoint search(TrackState& state, const Vec2& h) const noexcept;
    void open_rival(TrackState& state, const Vec2& h) const noexcept;

    OutlineFeet feet_;
    WindowTracker windows_;
};

}  // namespace palpate::engine
