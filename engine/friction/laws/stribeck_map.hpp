#pragma once

#include "engine/friction/laws/law_task.hpp"
#include "engine/math/exponential.hpp"

namespace palpate::engine {

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

}  // namespace palpate::engine
