#pragma once

#include <cmath>

#include "engine/friction/laws/law_task.hpp"
#include "engine/math/elementary.hpp"

namespace palpate::engine {

/// Coulomb friction as a function of velocity (Coulomb 1785; thesis 1.4.1, figure 1.4.1 a):
///
///     F = -mu_d F_N sgn(v),    v = dx / T,    F = 0 at v = 0
///
/// A benchmark's foil: at rest it holds nothing, and where an encoder counts once in several ticks
/// it chatters between 0 and mu_d F_N. In the cone; not passive, since after a reversal the held
/// force pushes along for one tick.
[[nodiscard]] inline FrictionForce coulomb_sign(const LawTask& law,
                                                LawState& /*state*/,
                                                const Rub& rub) noexcept {
    return {.force = -law.mu_d * rub.load * sign_of(rub.travel),
            .mu = law.mu_d,
            .slid = rub.travel != 0.0};
}

inline constexpr LawTraits kCoulombSign{.word = "coulomb_sign",
                                        .paper = "Coulomb 1785",
                                        .step = coulomb_sign,
                                        .in_cone = true,
                                        .creeps = true,
                                        .chatters = true};

/// Coulomb friction with a viscous term (thesis figure 1.4.1 b):
///
///     F = -mu_d F_N sgn(v) - b v,    v = dx / T
///
/// b is `viscosity`, N s/m. Leaves the cone by b |v|, and asks the device for b more damping, as
/// any sampled damper does (thesis eq. 1.1). Else as coulomb_sign.
[[nodiscard]] inline FrictionForce viscous(const LawTask& law,
                                           LawState& /*state*/,
                                           const Rub& rub) noexcept {
    return {.force = -law.mu_d * rub.load * sign_of(rub.travel) -
                     law.spec.viscosity * rub.travel / law.period,
            .mu = law.mu_d,
            .slid = rub.travel != 0.0};
}

inline constexpr LawTraits kViscous{.word = "viscous",
                                    .paper = "Coulomb with a viscous term",
                                    .step = viscous,
                                    .reads = {"viscous"},
                                    .needs_first = true,
                                    .creeps = true,
                                    .chatters = true};

/// The Stribeck curve as a map of velocity (Stribeck 1902; thesis eq. 1.3, figure 1.4.1 d), its
/// step at v = 0 smoothed:
///
///    F = -tanh(v / eps) mu(v) F_N,    mu(v) = mu_d + (mu_s - mu_d) exp(-(v / v_s)^2),   v = dx / T
///
/// eps is `smoothing_speed`, v_s `stribeck_speed`. In the cone. At rest it holds nothing, so that
/// it creeps under any load; near rest it is a damper of mu_s F_N / eps, 1400 N s/m for 4 N and 2
/// mm/s, far beyond what a sampled loop can give passively: it chatters.
[[nodiscard]] inline FrictionForce stribeck_map(const LawTask& law,
                                                LawState& /*state*/,
                                                const Rub& rub) noexcept {
    const double v = rub.travel / law.period;
    const double share = v / law.spec.stribeck_speed;
    const double mu = law.mu_d + (law.mu_s - law.mu_d) * exponential(-share * share);
    return {.force = -hyperbolic_tangent(v / law.spec.smoothing_speed) * mu * rub.load,
            .mu = mu,
            .slid = rub.travel != 0.0};
}

inline constexpr LawTraits kStribeck{.word = "stribeck",
                                     .paper = "Stribeck 1902",
                                     .step = stribeck_map,
                                     .reads = {"stribeck_speed", "smoothing_speed"},
                                     .sticks = true,
                                     .in_cone = true,
                                     .creeps = true,
                                     .chatters = true};

/// What stiction and Karnopp's law share. Stuck, the unknown force of the hand is that of a spring
/// from where it stuck (Salcudean & Vlaar 1997); beyond mu_s F_N it breaks away, and slides with
/// mu_d F_N against the motion. On coming to rest the spring is seated so that the force is kept:
/// put to the place of HIP instead, as often published, it would fall to 0 in one tick.
///
/// In the cone; falls by (mu_s - mu_d) F_N in the tick of break-away. Not passive: the stretch that
/// the force of sliding stands for was never wound up where the load rose while it slid; the gain
/// is below (mu_d F_N)^2 / 2 k a slide.
/// @param rests  the sliding is over
[[nodiscard]] inline FrictionForce stuck_spring(const LawTask& law,
                                                LawState& state,
                                                const Rub& rub,
                                                bool rests) noexcept {
    if (state.sliding && rests) {
        state.sliding = false;
        state.stretch = -state.force / law.stiffness;
    }
    if (!state.sliding) {
        state.stretch += rub.travel;
        const double force = -law.stiffness * state.stretch;
        if (std::fabs(force) <= law.mu_s * rub.load) {
            state.force = force;
            return {.force = force, .mu = law.mu_s, .slid = false};
        }
        state.sliding = true;
        state.way = sign_of(state.stretch);
    } else {
        state.way = sign_of(rub.travel);
    }
    state.force = -law.mu_d * rub.load * state.way;
    return {.force = state.force, .mu = law.mu_d, .slid = true};
}

/// Stiction (thesis eq. 1.2, figure 1.4.1 c):
///
///     v = 0:   F holds against the hand up to mu_s F_N        (a spring k: stuck_spring)
///     v != 0:  F = -mu_d F_N sgn(v)
///
/// "v = 0" is meant literally: a tick without travel, or a change of sign. So with an encoder that
/// counts once in several ticks it sticks and breaks away again, a chatter of (mu_s - mu_d) F_N.
[[nodiscard]] inline FrictionForce stiction(const LawTask& law,
                                            LawState& state,
                                            const Rub& rub) noexcept {
    return stuck_spring(law, state, rub, sign_of(rub.travel) != state.way);
}

inline constexpr LawTraits kStiction{.word = "stiction",
                                     .paper = "Morin 1833",
                                     .step = stiction,
                                     .reads = {"tangential_stiffness"},
                                     .sticks = true,
                                     .in_cone = true,
                                     .chatters = true};

/// Karnopp's law (Karnopp, "Computer simulation of stick-slip friction in mechanical dynamic
/// systems", J. Dyn. Sys. Meas. Control 107, 1985; thesis figure 1.4.2):
///
///     |v| < DV:  stuck, holds up to mu_s F_N                  (a spring k: stuck_spring)
///     else:      F = -mu_d F_N sgn(v)
///
/// DV is `stick_speed`. A velocity that changed its sign was within DV in between. How it feels
/// depends on DV, and on the rate: v = dx / T of an encoder's count q jumps by q / T, 10 mm/s for
/// 10 um at 1 kHz, which DV has to exceed or it chatters.
[[nodiscard]] inline FrictionForce karnopp(const LawTask& law,
                                           LawState& state,
                                           const Rub& rub) noexcept {
    const bool slow = std::fabs(rub.travel) < law.spec.stick_speed * law.period;
    return stuck_spring(law, state, rub, slow || sign_of(rub.travel) != state.way);
}

inline constexpr LawTraits kKarnopp{.word = "karnopp",
                                    .paper = "Karnopp 1985",
                                    .step = karnopp,
                                    .reads = {"tangential_stiffness", "stick_speed"},
                                    .sticks = true,
                                    .in_cone = true,
                                    .chatters = true};

/// The friction cone algorithm (Harwin & Melder, "Improved haptic rendering for multi-finger
/// manipulation using friction cone based god-objects", EuroHaptics 2002): the god-object stays
/// while HIP sees it within the static cone; outside, it is put onto the dynamic cone at once, and
/// sticks again once within that:
///
///     stuck:    F = -k z                      until |F| > mu_s F_N
///     sliding:  z = +- mu_d F_N / k           until |k z| < mu_d F_N
///
/// One spring for all directions in the paper; here k is `stiffness`, and the cone that of the
/// tangent plane at the closest point. Without a velocity it does not chatter. In the cone, passive
/// for k <= K (the god-object only ever comes nearer); falls by (mu_s - mu_d) F_N in the tick of
/// break-away.
[[nodiscard]] inline FrictionForce friction_cone(const LawTask& law,
                                                 LawState& state,
                                                 const Rub& rub) noexcept {
    state.stretch += rub.travel;
    const double dynamic = law.mu_d * rub.load / law.stiffness;
    const double length = std::fabs(state.stretch);
    state.sliding =
        state.sliding ? length >= dynamic : length > law.mu_s * rub.load / law.stiffness;
    if (state.sliding) {
        state.stretch = sign_of(state.stretch) * dynamic;
    }
    return {.force = -law.stiffness * state.stretch,
            .mu = state.sliding ? law.mu_d : law.mu_s,
            .slid = state.sliding};
}

inline constexpr LawTraits kFrictionCone{.word = "friction_cone",
                                         .paper = "Harwin & Melder 2002",
                                         .step = friction_cone,
                                         .reads = {"tangential_stiffness"},
                                         .sticks = true,
                                         .passive = true,
                                         .in_cone = true};

}  // namespace palpate::engine
