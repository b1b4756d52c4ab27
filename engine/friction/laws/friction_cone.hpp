#pragma once

#include <cmath>

#include "engine/friction/laws/law_task.hpp"

namespace palpate::engine {

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
