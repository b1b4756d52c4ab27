#pragma once

#include "tests/figures/thesis/algorithm1.hpp"
#include "tests/figures/thesis/region_switch.hpp"

namespace palpate::figures {

/// What the tracked closest point is turned into.
enum class ThesisLaw : std::uint8_t {
    frictionless,  ///< F = K (CP - HIP)                      thesis eq. 2.17
    literal,       ///< Algorithm 1 as it is written          thesis 3.1.1
    latched,       ///< Algorithm 1, FN[k-1] read as "when slipping began"
};

/// What is to be felt in the thesis' own way. SI.
struct ThesisSpec {
    double stiffness = 1000.0;  ///< K, N/m, 0 < K <= 1e9
    double period = 0.001;      ///< T, s, > 0
    TrackerSpec tracker{};      ///< of the closest point, one for all curves
    /// Of GO after break-away; none: as `tracker`. The thesis slows this one down to make the
    /// transition last (figure 3.2.2, 2 -> 3).
    std::optional<TrackerSpec> release{};
    ThesisLaw law = ThesisLaw::literal;
    double mu_s = 0.7;
    double mu_d = 0.5;
    double epsilon = 1e-5;   ///< as Algorithm1Spec
    double dead_band = 0.0;  ///< as Algorithm1Spec
    RegionRule region = RegionRule::nearest_feature;
};

/// What lives on from tick to tick. A plain value: copying it copies the contact.
struct ThesisState {
    bool started = false;  ///< a first HIP was seen
    bool touching = false;
    std::size_t active = 0;      ///< curve whose region HIP is in
    std::size_t go_segment = 0;  ///< curve on which GO sits
    double go_u = 0.0;
    PointOfApplication go{};
    std::array<TrackerState, kMaxRegions> cp{};
    TrackerState release{};
    Algorithm1State friction{};
    Vec2 last_hip{};  ///< m
};

/// One tick's answer; the force is the one on the user.
struct ThesisTick {
    Mode mode = Mode::free;
    std::size_t segment = 0;     ///< of GO
    double u = 0.0;              ///< of GO
    std::size_t cp_segment = 0;  ///< active curve
    double cp_u = 0.0;
    Vec2 cp{};             ///< tracked closest point on the active curve, m
    Vec2 go{};             ///< m
    Vec2 force{};          ///< N
    double fn = 0.0;       ///< along GO's normal, N
    double ft = 0.0;       ///< along GO's tangent, N
    double mu = 0.0;       ///< coefficient in force, 0 while free and without friction
    double psi = 0.0;      ///< projection error of GO, (GO - HIP) . t, m
    bool refused = false;  ///< HIP was not finite or beyond 1e9 m: force zero, contact ended
};

/// The thesis' renderer: local trackers, Voronoi switching, Algorithm 1. For comparison with Scene
/// (engine/rendering), which is what a study should use.
///
/// The closest point is only as good as its tracker: what lags, lags in the force too (without
/// friction as a drag K psi along the surface). On break-away past a corner GO is put on the start
/// of the curve that HIP has reached (thesis, figure 3.2.4, marker 12): the force jumps there.
/// Whether HIP touches is judged at the nearest tracked foot, also while the region is locked; the
/// thesis asks the locked curve, which would go on pushing a HIP that has left through the other
/// one.
class ThesisScene {
public:
    /// @param segments  1 to kMaxRegions curves joined end to end, the object on the right of
    ///       travel
    /// @param closed    the last ends where the first starts; else both ends are open, and HIP past
    ///                  the normal of an open end is outside
    /// @throws std::invalid_argument for values out of range: which one, the value, what to give
    ThesisScene(std::vector<NurbsCurve<2>> segments, bool closed, const ThesisSpec& spec);

    /// The contact after HIP moved to `hip`. No allocation, no lock; bit-reproducible.
    ThesisTick tick(ThesisState& state, const Vec2& hip) const noexcept;

    /// The spec that was given.
    [[nodiscard]] const ThesisSpec& spec() const noexcept { return spec_; }
    /// The tracker of each curve's closest point.
    [[nodiscard]] const std::vector<CurveTracker>& trackers() const noexcept { return trackers_; }

private:
    using Feet = std::array<TrackedFoot, kMaxRegions>;

    [[nodiscard]] Feet track(ThesisState& state, const Vec2& hip) const noexcept;
    void seat(ThesisState& state, std::size_t segment, const TrackedFoot& foot) const noexcept;
    void follow(ThesisState& state, const Vec2& hip) const noexcept;
    void end_contact(ThesisState& state,
                     const TrackedFoot& cp,
                     const Vec2& velocity) const noexcept;

    ThesisSpec spec_;
    std::vector<CurveTracker> trackers_;
    std::vector<CurveTracker> releases_;
    RegionSwitch regions_;
    ThesisFriction friction_;
};

}  // namespace palpate::figures
