#pragma once

#include "engine/friction/laws/law_task.hpp"

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

}  // namespace palpate::engine
