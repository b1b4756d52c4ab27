#pragma once

#include "engine/geometry/vec.hpp"
#include "engine/rendering/mode.hpp"
#include "tests/support/std.hpp"

namespace palpate::figures {

using engine::Mode;
using engine::Vec2;

/// How Algorithm 1's test for slip -> stuck reads FN[k-1].
enum class Algorithm1Variant : std::uint8_t {
    /// the tick before: mu_d FN[k] > mu_s FN[k-1] asks for 40 % more load within one tick
    literal,
    latched,  ///< the load when slipping began: then figure 3.2.2's markers 3 -> 4 -> 5 can happen
};

struct Algorithm1Spec {
    Algorithm1Variant variant = Algorithm1Variant::literal;
    double stiffness = 1000.0;  ///< K, N/m, 0 < K <= 1e9
    double mu_s = 0.7;          ///< >= mu_d
    double mu_d = 0.5;          ///< >= 0
    double epsilon = 1e-5;      ///< |Psi| below which mu = mu_d, m (unit tangent), > 0
    /// m/s, >= 0. 0: any change of the sign of HIP's tangential velocity counts, stopping included.
    /// > 0: a change of sign counts only if both speeds exceed it, and stopping does not.
    double dead_band = 0.0;
};

/// The variables of Algorithm 1 that live on. Forces are signed along the tangent at GO.
struct Algorithm1State {
    bool dynamic = false;     ///< state = DYNAMIC, else STATIC
    bool seat = true;         ///< Stuck_Transition_Flag: GO := CP at the next STATIC tick
    bool continuity = false;  ///< Force_Continuity_Flag
    bool locked = false;      ///< not Voronoi_Switch_Flag
    double friction = 0.0;    ///< F_f, N; keeps its old value on ticks that do not assign it
    double offset = 0.0;      ///< F_offset, N
    double last_load = 0.0;   ///< FN[k-1], N
    double slip_load = 0.0;   ///< FN when slipping began, N
    double psi_0 = 0.0;       ///< |Psi| when slipping began, m
    double direction = 0.0;   ///< sign of F_T when slipping began
    Vec2 last_velocity{};     ///< of HIP, m/s
};

/// Where the force is applied: GO's own point and frame (the curve it sits on).
struct PointOfApplication {
    Vec2 point{};
    Vec2 tangent{1.0, 0.0};
    Vec2 normal{0.0, 1.0};
};

struct Algorithm1Force {
    Mode mode = Mode::free;
    Vec2 force{};      ///< F_N n + F_f t, N
    double fn = 0.0;   ///< F_N, N
    double ft = 0.0;   ///< F_f, N: what is felt; not K times the stretch once slipping
    double mu = 0.0;   ///< mu_s in STATIC, the modulated one in DYNAMIC
    double psi = 0.0;  ///< (GO - HIP) . t, m
};

/// The thesis' Algorithm 1 (3.1.1), one tick at a time, kept as the history that it is.
///
/// Kept on purpose, though each breaks a promise of the thesis (numbers:
/// tests/figures/tests/thesis_friction_test.cpp):
///  - F_offset is added in STATIC but not tested, so |F_f| may exceed mu_s F_N while stuck; it
///    stays and is added again to mu F_N in DYNAMIC, so |F_f| may exceed mu_s F_N for good.
///  - F_f keeps its old value on the tick of break-away and on those of slip -> stuck.
///  - GO := CP when HIP's tangential velocity changes sign or stops: friction falls to 0 in one
///    tick. A dead band hides that, and then friction pushes along with a motion that has turned
///    round.
///  - The direction of dynamic friction is that of the break-away; velocity never turns it.
///  - mu = mu_d + (mu_s - mu_d) min(1, |Psi| / Psi_0), Psi_0 that of the break-away: a tracker that
///    lags by v / lambda keeps mu above mu_d for good, more so the faster it goes (against
///    Stribeck).
///
/// Repaired, because it could not run otherwise: F_T is signed and its magnitude is tested; GO and
/// CP are two points; HIP is sampled every tick, contact or not; the region lock ends with the
/// contact.
class ThesisFriction {
public:
    /// @throws std::invalid_argument for a number out of range: its name, the value, the remedy
    explicit ThesisFriction(const Algorithm1Spec& spec);

    /// A tick without contact: STATIC, forces zero, GO will be seated anew, regions may switch.
    void no_contact(Algorithm1State& state, const Vec2& velocity) const noexcept;

    /// A tick in contact, with GO at `at` (already seated, stuck or tracked), HIP at `hip` moving
    /// with `velocity`, m/s.
    Algorithm1Force contact(Algorithm1State& state,
                            const PointOfApplication& at,
                            const Vec2& hip,
                            const Vec2& velocity) const noexcept;

    [[nodiscard]] const Algorithm1Spec& spec() const noexcept { return spec_; }

private:
    [[nodiscard]] bool turned(double before, double now) const noexcept;
    [[nodiscard]] double modulated(const Algorithm1State& state, double psi) const noexcept;

    Algorithm1Spec spec_;
};

}  // namespace palpate::figures
