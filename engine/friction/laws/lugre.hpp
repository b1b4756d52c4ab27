#pragma once

#include <algorithm>
#include <cmath>

#include "engine/friction/laws/law_task.hpp"
#include "engine/math/exponential.hpp"

namespace palpate::engine {

/// LuGre's g(v), the friction of steady sliding, N.
[[nodiscard]] inline double lugre_level(const LawTask& law, const Rub& rub) noexcept {
    const double share = rub.travel / (law.period * law.spec.stribeck_speed);
    return (law.mu_d + (law.mu_s - law.mu_d) * exponential(-share * share)) * rub.load;
}

/// The LuGre law (Canudas de Wit, Olsson, Astrom & Lischinsky, "A new model for control of systems
/// with friction", IEEE Trans. Automatic Control 40, 1995; thesis eq. 1.6), scaled by the load:
///
///     dz/dt = v - sigma_0 |v| z / g(v),     F = -(sigma_0 z + sigma_1 dz/dt + sigma_2 v)
///     g(v)  = F_N (mu_d + (mu_s - mu_d) exp(-(v / v_s)^2))
///
/// sigma_0 is `stiffness`, sigma_1 `bristle_damping`, sigma_2 `viscosity`, v_s `stribeck_speed`. Of
/// constant v within a tick the exact solution: with z_ss = g sgn(v) / sigma_0,
///
///     z <- z_ss + (z - z_ss) exp(-sigma_0 |dx| / g)
///
/// stable for every stiffness, speed and load. Where the load falls, z is cut to mu_s F_N /
/// sigma_0. In the cone and passive for sigma_1 = sigma_2 = 0 and sigma_0 <= K; dampers leave the
/// cone and ask the device for as much damping more. Drifts under an oscillating load, as Dahl's
/// law does.
[[nodiscard]] inline FrictionForce lugre(const LawTask& law,
                                         LawState& state,
                                         const Rub& rub) noexcept {
    const double level = lugre_level(law, rub);
    const double max = law.mu_s * rub.load / law.stiffness;
    const double before = std::clamp(state.stretch, -max, max);
    double after = before;
    if (rub.travel != 0.0 && level > 0.0) {
        const double steady = sign_of(rub.travel) * level / law.stiffness;
        after = steady +
                (before - steady) * exponential(-law.stiffness * std::fabs(rub.travel) / level);
    } else if (!(level > 0.0)) {
        after = 0.0;
    }
    state.stretch = after;
    return {.force = -law.stiffness * after - (law.spec.bristle_damping * (after - before) +
                                               law.spec.viscosity * rub.travel) /
                                                  law.period,
            .mu = rub.load > 0.0 ? level / rub.load : law.mu_d,
            .slid = std::fabs(after - before) < 0.5 * std::fabs(rub.travel)};
}

/// The same by one explicit Euler step a tick, as it is often programmed: a failure, kept to be
/// shown.
///
///     z <- z + dx - sigma_0 |dx| z / g
///
/// Grows without bound where sigma_0 |v| T / g > 2 (euler_limit): at any speed, once the load is
/// small enough, as it is whenever a contact begins or ends. z is cut at 1e9 m, for finite in gives
/// finite out. A protocol may not use it.
[[nodiscard]] inline FrictionForce lugre_euler(const LawTask& law,
                                               LawState& state,
                                               const Rub& rub) noexcept {
    constexpr double kFar = 1e9;
    const double level = std::max(lugre_level(law, rub), 1e-30);
    const double change =
        rub.travel - law.stiffness * std::fabs(rub.travel) / level * state.stretch;
    state.stretch = std::clamp(state.stretch + change, -kFar, kFar);
    return {
        .force = -law.stiffness * state.stretch -
                 (law.spec.bristle_damping * change + law.spec.viscosity * rub.travel) / law.period,
        .mu = rub.load > 0.0 ? level / rub.load : law.mu_d,
        .slid = std::fabs(change) < 0.5 * std::fabs(rub.travel)};
}

inline constexpr LawTraits kLuGre{
    .word = "lugre",
    .paper = "Canudas de Wit et al. 1995",
    .step = lugre,
    .reads = {"tangential_stiffness", "bristle_damping", "viscous", "stribeck_speed"},
    .sticks = true,
    .passive = true,
    .in_cone = true,
    .creeps = true};

inline constexpr LawTraits kLuGreEuler{
    .word = "lugre_euler",
    .paper = "Canudas de Wit et al. 1995",
    .step = lugre_euler,
    .reads = {"tangential_stiffness", "bristle_damping", "viscous", "stribeck_speed"},
    .sticks = true,
    .creeps = true};

}  // namespace palpate::engine
