#pragma once

#include <algorithm>
#include <cmath>

#include "engine/friction/laws/law_task.hpp"

namespace palpate::engine {

/// The reset integrator (Haessig & Friedland, J. Dyn. Sys. Meas. Control 113, 1991): one bond whose
/// strain stops growing where it would rupture,
///
///     F = -((1 + a) sigma_0 z + sigma_1 dz/dt)   for |z| < z_0,      F = -sigma_0 z at |z| = z_0
///
/// with sigma_0 z_0 = mu_d F_N and 1 + a = mu_s / mu_d, so that it holds up to mu_s F_N. (1 + a)
/// sigma_0 is `stiffness`: what is felt while stuck, and what has to be at most K. sigma_1 is
/// `bristle_damping`. Jumps by (mu_s - mu_d) F_N on break-away and, by design, back again on each
/// return. In the cone for sigma_1 = 0. Passive under a load that does not rise; where it rises
/// while HIP slides, the strain grows along, paid for with mu_d F_N and given back with mu_s F_N.
[[nodiscard]] inline FrictionForce reset_integrator(const LawTask& law,
                                                    LawState& state,
                                                    const Rub& rub) noexcept {
    const double reach = law.mu_s * rub.load / law.stiffness;
    state.stretch = std::clamp(state.stretch + rub.travel, -reach, reach);
    if (std::fabs(state.stretch) >= reach) {
        return {
            .force = -law.mu_d * rub.load * sign_of(state.stretch), .mu = law.mu_d, .slid = true};
    }
    return {.force =
                -law.stiffness * state.stretch - law.spec.bristle_damping * rub.travel / law.period,
            .mu = law.mu_s,
            .slid = false};
}

inline constexpr LawTraits kResetIntegrator{.word = "reset_integrator",
                                            .paper = "Haessig & Friedland 1991",
                                            .step = reset_integrator,
                                            .reads = {"tangential_stiffness", "bristle_damping"},
                                            .sticks = true,
                                            .in_cone = true};

}  // namespace palpate::engine
