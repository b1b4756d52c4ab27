#pragma once

#include "engine/friction/laws/law_task.hpp"

namespace palpate::engine {

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

}  // namespace palpate::engine
