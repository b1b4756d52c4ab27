#pragma once

#include <algorithm>
#include <cmath>

#include "engine/friction/laws/law_task.hpp"
#include "engine/math/exponential.hpp"

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

}  // namespace palpate::engine
