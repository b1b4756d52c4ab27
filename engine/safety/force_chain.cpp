#include "engine/safety/force_chain.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::engine {

Command guard(ForceGate& gate, const ForceLimits& limits, const Vec2& force, bool enable) noexcept {
    Command command;
    const double length = glm::length(force);  // overflows to inf only beyond 1e154 N: a fault too
    if (gate.faulted || !std::isfinite(length)) {
        gate.faulted = true;
        gate.gain = 0.0;
        command.refused = true;
        return command;
    }
    gate.gain = std::clamp(gate.gain + (enable ? limits.ramp_step : -limits.ramp_step), 0.0, 1.0);
    command.force = force;
    if (length > limits.most) {
        command.force = force * (limits.most / length);
        command.saturated = true;
    }
    if (gate.gain < 1.0) {
        command.force *= gate.gain;
        command.ramped = true;
    }
    return command;
}

}  // namespace palpate::engine
