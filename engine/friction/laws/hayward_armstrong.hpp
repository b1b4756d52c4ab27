#pragma once

#include <algorithm>
#include <cmath>

#include "engine/friction/laws/law_task.hpp"
#include "engine/math/elementary.hpp"
#include "engine/math/exponential.hpp"

namespace palpate::engine {

/// The stretch after a travel s > 0 in its direction, for the adhesion map of hayward_armstrong().
/// @param z  in [-most, most]   @param stick  z_stick, m, in [0, most)
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
