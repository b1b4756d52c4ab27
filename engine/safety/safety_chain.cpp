#include "engine/safety/safety_chain.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::engine {

Command make_safe(SafetyState& state,
                  const SafetyLimits& limits,
                  const SafetyInput& input) noexcept {
    Command command;
    const double length = glm::length(input.force);  // inf only beyond 1e154 N: a fault too
    if (state.trip == Trip::none) {
        state.trip = input.found;
    }
    if (state.trip == Trip::none && !std::isfinite(length)) {
        state.trip = Trip::not_finite;
    }
    if (state.trip != Trip::none) {
        state.gain = 0.0;
        command.trip = state.trip;
        return command;
    }
    const double step = input.enable ? limits.ramp_step : -limits.ramp_step;
    state.gain = std::clamp(state.gain + step, 0.0, 1.0);
    command.force = input.force;
    if (length > limits.most) {
        command.force = input.force * (limits.most / length);
        command.saturated = true;
    }
    if (state.gain < 1.0) {
        command.force *= state.gain;
        command.ramped = true;
    }
    return command;
}

}  // namespace palpate::engine
