#pragma once

#include <algorithm>
#include <cmath>

#include "engine/friction/laws/law_task.hpp"
#include "engine/math/elementary.hpp"

namespace palpate::engine {

/// What is left of u0 after du/dc = -u^alpha over a length c: u0 e^-c for alpha = 1, else
/// (u0^(1-alpha) - (1 - alpha) c)^(1/(1-alpha)), 0 from where that ends. @param u0, c  >= 0
[[nodiscard]] inline double dahl_rest(double u0, double c, double alpha) noexcept {
    const double p = 1.0 - alpha;
    if (std::fabs(p) < 1e-7) {
        return u0 * exponential(-c);
    }
    const double w = power(u0, p) - p * c;
    return u0 > 0.0 ? power(w, 1.0 / p) : 0.0;
}

/// Dahl's law (Dahl, "A solid friction model", Aerospace Corporation TOR-0158(3107-18), 1968;
/// thesis eq. 1.4), for friction f = -F against the motion:
///
///     df/dx = sigma (1 - (f / f_c) sgn(dx))^alpha,     f_c = mu_d F_N
///
/// sigma is `stiffness`, alpha `exponent`. Solved exactly over the travel of a tick (dahl_rest), so
/// that it knows neither time nor rate. Where the load falls, f is cut to f_c. In the cone; passive
/// for sigma <= K. No static friction; drifts under an oscillating load below f_c, for it slips a
/// little at any force.
[[nodiscard]] inline FrictionForce dahl(const LawTask& law,
                                        LawState& state,
                                        const Rub& rub) noexcept {
    const double max = law.mu_d * rub.load;
    const double before = std::clamp(-state.force, -max, max);
    double after = before;
    if (rub.travel != 0.0 && max > 0.0) {
        const double way = sign_of(rub.travel);
        const double length = std::fabs(rub.travel) * law.stiffness / max;
        const double rest = dahl_rest(1.0 - way * before / max, length, law.spec.exponent);
        after = std::clamp(way * max * (1.0 - rest), -max, max);
    }
    state.force = -after;
    return {.force = state.force,
            .mu = law.mu_d,
            .slid = std::fabs(after - before) < 0.5 * law.stiffness * std::fabs(rub.travel)};
}

inline constexpr LawTraits kDahl{.word = "dahl",
                                 .paper = "Dahl 1968",
                                 .step = dahl,
                                 .reads = {"tangential_stiffness", "dahl_exponent"},
                                 .passive = true,
                                 .in_cone = true,
                                 .creeps = true};

/// Bonds that snap and form anew (Haessig & Friedland, "On the modeling and simulation of
/// friction", J. Dyn. Sys. Meas. Control 113, 1991; thesis eq. 1.5):
///
///     F = -sum sigma (x - b_i),    |x - b_i| <= reach = mu_s F_N / (n sigma)
///
/// n is `bristles`, n sigma `stiffness`. A bond stretched beyond its reach snaps, and a new one
/// forms where its stretch is a random share of the reach, uniform in [3 mu_d / mu_s - 2, 1]:
/// carried on from there, bonds that slide along pull by mu_d F_N in the mean. All first bonds are
/// formed where the contact begins, so that they first break away together, at mu_s F_N. Random
/// numbers are those of `seed`, by their number in this trial.
///
/// In the cone and passive (n sigma <= K): a new bond is never stretched more than the one that
/// snapped. Needs mu_d >= mu_s / 3; costs a tick by every bristle; ripples by chance, by a share of
/// 1 / sqrt n.
[[nodiscard]] inline FrictionForce bristle(const LawTask& law,
                                           LawState& state,
                                           const Rub& rub) noexcept {
    const double reach = law.mu_s * rub.load / law.stiffness;
    const double lowest = law.mu_s > 0.0 ? 3.0 * law.mu_d / law.mu_s - 2.0 : 1.0;
    const double max_over = std::fabs(rub.travel);
    double sum = 0.0;
    bool snapped = false;
    for (int i = 0; i < law.spec.bristles; ++i) {
        double& stretch = state.bristles[static_cast<std::size_t>(i)];
        stretch += rub.travel;
        const double way = sign_of(stretch);
        // What of the travel came after the bond snapped stretches the new one.
        double over = std::min(std::fabs(stretch) - reach, max_over);
        for (int again = 0; over > 0.0 && again < 16; ++again) {
            snapped = true;
            const double share = lowest + (1.0 - lowest) * uniform(law.spec.seed, state.draws++);
            stretch = way * (share * reach + over);
            over = way * stretch - reach;
        }
        stretch = std::clamp(stretch, -reach, reach);
        sum += stretch;
    }
    return {.force = -law.stiffness / law.spec.bristles * sum,
            .mu = snapped ? law.mu_d : law.mu_s,
            .slid = snapped};
}

inline constexpr LawTraits kBristle{.word = "bristle",
                                    .paper = "Haessig & Friedland 1991",
                                    .step = bristle,
                                    .reads = {"tangential_stiffness", "bristles", "law_seed"},
                                    .sticks = true,
                                    .max_mu_s = 3,
                                    .passive = true,
                                    .in_cone = true};

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
        const double left = exponential(-law.stiffness * std::fabs(rub.travel) / level);
        after = std::isfinite(steady) ? steady + (before - steady) * left
                                      : before + rub.travel;  // sigma_0 -> 0: dz/dt = v
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

/// The stretch after a travel s > 0 in its direction, for the adhesion map of hayward_armstrong().
/// @param z  in [-max, max]   @param stick  z_stick, m, in [0, max)
[[nodiscard]] inline double adhesion_step(double z, double s, double stick, double max) noexcept {
    const double width = max - stick;
    if (z < -stick) {  // the anchor comes along, ever slower, until it holds again
        const double begun = 1.0 - (z + stick) / width;
        const double left = begun * exponential(-s / width);
        if (left > 1.0) {
            return -stick - width * (left - 1.0);
        }
        s -= width * natural_log(begun);
        z = -stick;
    }
    const double held = std::min(s, std::max(stick - z, 0.0));
    z += held;
    s -= held;
    return s > 0.0 ? max + (z - max) * exponential(-s / width) : z;
}

/// The law of Hayward & Armstrong ("A new computational model of friction applied to haptic
/// rendering", Experimental Robotics VI, LNCIS 250, 2000): a spring to an anchor w that follows HIP
/// by travel alone,
///
///     z = x - w,    dw = alpha(z) z |dx|,    F = -k z,    |z| cut to z_max = mu_d F_N / k
///
/// k is `stiffness`, z_stick = `stick_share` z_max. Of the adhesion map alpha the authors ask that
/// it be 0 about z = 0, where the anchor holds, and lead to |z| = z_max in sliding. Here
///
///     alpha(z) |z| = max(|z| - z_stick, 0) / (z_max - z_stick)
///
/// for which a tick is solved exactly (adhesion_step), and which holds for good: below
/// stick_share mu_d F_N nothing drifts. z_stick = 0 is Dahl's law. Formulas recalled, the paper not
/// at hand; the map alpha = z^8 / (z_max (z_stick^8 + z^8)) that goes with them is above 0
/// everywhere and creeps (`palpate bench friction` shows both). Regimes: sticking, creeping,
/// sliding; the oscillating one, which needs a map that falls again, is not rendered. In the cone;
/// passive for k <= K; knows neither time nor rate; no static friction.
[[nodiscard]] inline FrictionForce hayward_armstrong(const LawTask& law,
                                                     LawState& state,
                                                     const Rub& rub) noexcept {
    const double max = law.mu_d * rub.load / law.stiffness;
    const double before = std::clamp(state.stretch, -max, max);
    double after = before;
    if (rub.travel != 0.0 && max > 0.0) {
        const double way = sign_of(rub.travel);
        after = way *
                adhesion_step(way * before, std::fabs(rub.travel), law.spec.stick_share * max, max);
    }
    state.stretch = after;
    return {.force = -law.stiffness * after,
            .mu = law.mu_d,
            .slid = std::fabs(after - before) < 0.5 * std::fabs(rub.travel)};
}

inline constexpr LawTraits kHaywardArmstrong{.word = "hayward_armstrong",
                                             .paper = "Hayward & Armstrong 2000",
                                             .step = hayward_armstrong,
                                             .reads = {"tangential_stiffness", "stick_share"},
                                             .passive = true,
                                             .in_cone = true};

}  // namespace palpate::engine
