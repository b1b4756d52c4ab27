#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/contact/closest_point.hpp"

namespace palpate::engine {

/// What certified tracking keeps from tick to tick. A plain value.
struct TrackState {
    bool valid = false;   ///< a window is known
    Vec2 from{};          ///< HIP of the last search, m
    double slack = 0.0;   ///< while |h - from| < slack the window holds one minimum at most, m
    double others = 0.0;  ///< nothing outside the window was nearer to `from` than this, m

    std::size_t span = 0;  ///< of the foot
    double u = 0.0;  ///< where the jet was taken: within rounding of the foot, or a step beside
    Jet<2> jet{};

    std::size_t first_span = 0;  ///< of the window, in the direction of travel
    std::size_t last_span = 0;
    double first_u = 0.0;
    double last_u = 1.0;
    std::array<std::size_t, 2> vertices{};  ///< true vertices within the window
    std::uint32_t vertex_count = 0;

    /// u of `of_span` lies in the part of the window that is on the foot's own span.
    [[nodiscard]] bool holds(std::size_t of_span, double at) const noexcept {
        return of_span == span && at >= (of_span == first_span ? first_u : 0.0) &&
               at <= (of_span == last_span ? last_u : 1.0);
    }
};

/// How often each way of answering was taken.
struct TrackCounts {
    std::uint64_t certified = 0;  ///< local answer, proved global by the certificate
    std::uint64_t searched = 0;   ///< global search
};

/// The global closest point of a moving HIP: followed locally, with a proof that it is global.
///
/// A search at h0 finds the global foot, and around it a window of the outline such that
/// * the distance to h has a single minimum within the window for every h with |h - h0| < slack: over
///   each of its pieces f(u) = (C - h) . C' W^k rises (Pieces::rise_slack: half-planes of h), and at a
///   vertex inside the window it is not falling behind while rising ahead;
/// * everything else is at least `others` away from h0, by the boxes and capsules of the pieces.
/// For a later h the followed foot at distance d is global if d + |h - h0| < others (the triangle
/// inequality), and no search runs. Otherwise a new search does. Every answer is therefore the global
/// closest point, to rounding; the error of the distance is that of one curve evaluation.
class CertifiedTracker {
public:
    /// @param outline  must live as long as the tracker
    explicit CertifiedTracker(const Outline& outline);

    [[nodiscard]] const OutlineFeet& feet() const noexcept { return feet_; }

    [[nodiscard]] ClosestPoint track(TrackState& state,
                                     const Vec2& h,
                                     TrackCounts& counts) const noexcept;

private:
    struct Followed {
        bool settled = false;
        bool on_joint = false;
        std::size_t joint = 0;
        Foot<2> foot{};
    };

    [[nodiscard]] Followed follow(TrackState& state, const Vec2& h) const noexcept;
    [[nodiscard]] bool one_minimum(const TrackState& state, const Vec2& h) const noexcept;
    ClosestPoint search(TrackState& state, const Vec2& h) const noexcept;
    void open_window(TrackState& state, const Vec2& h) const noexcept;

    OutlineFeet feet_;
    std::vector<double>
        taylor_;  ///< of each span: steps of u below it are finished by Taylor's series
};

}  // namespace palpate::engine
