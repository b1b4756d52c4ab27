#pragma once

#include <cmath>

#include "engine/friction/laws/law_task.hpp"

namespace palpate::engine {

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

}  // namespace palpate::engine
