#pragma once

#include "engine/geometry/vec.hpp"

namespace palpate::engine {

/// Limits between the rendered force and the device.
struct ForceLimits {
    double most = 10.0;        ///< N; a stronger command is scaled to this, direction kept
    double ramp_step = 0.005;  ///< share of the force gained or lost a tick, > 0
};

/// What the chain remembers: how far the force is switched on. A plain value.
struct ForceGate {
    double gain = 0.0;     ///< 0 off, 1 on
    bool faulted = false;  ///< latched: zero until the next trial
};

struct Command {
    Vec2 force{};
    bool saturated = false;
    bool ramped = false;   ///< scaled down by the ramp
    bool refused = false;  ///< the force was not finite, or the gate is faulted: zero
};

/// Share of the force gained or lost each tick for a ramp of `ramp` s at period `period` s.
[[nodiscard]] constexpr double ramp_step(double ramp, double period) noexcept {
    return ramp > period ? period / ramp : 1.0;
}

/// Finite guard -> saturation that keeps the direction -> ramp. Finite in, finite and limited out;
/// anything else latches the fault and gives zero.
/// @param enable  ramp towards on (true) or off (false)
[[nodiscard]] Command guard(ForceGate& gate,
                            const ForceLimits& limits,
                            const Vec2& force,
                            bool enable) noexcept;

}  // namespace palpate::engine
