#include "engine/safety/safety_chain.hpp"

#include <cmath>

#include "engine/safety/command_limits.hpp"
#include "engine/safety/motor_heat.hpp"

namespace palpate::engine {
namespace {

/// |v| is a number: beyond 1e154 its square is not, and that is a fault too.
bool finite(const Vec2& v) noexcept {
    return std::isfinite(glm::length(v));
}

bool finite(const SafetyInput& input) noexcept {
    return finite(input.force) && finite(input.spring) && finite(input.hip) && finite(input.load);
}

bool silent_too_long(SafetyState& state, const SafetyLimits& limits, bool fresh) noexcept {
    state.silent = fresh ? 0 : state.silent + 1;
    return limits.silent_run > 0 && state.silent >= limits.silent_run;
}

/// E of this tick is above its limit, or not a number. Without a limit nothing is summed.
bool too_active(SafetyState& state, const SafetyLimits& limits, const SafetyInput& input) noexcept {
    return std::isfinite(limits.energy) &&
           !(observe_energy(state.energy, limits, input.hip, input.spring, state.gain,
                            state.clock.since) <= limits.energy);
}

bool too_hot(SafetyState& state, const SafetyLimits& limits, const SafetyInput& input) noexcept {
    if (limits.heat_step > 0.0) {
        state.heat = heated(state.heat, input.load, limits.heat_step);
    }
    return limits.heat_step > 0.0 && !(state.heat.x <= 1.0 && state.heat.y <= 1.0);
}

Trip cause(SafetyState& state, const SafetyLimits& limits, const SafetyInput& input) noexcept {
    if (input.found != Trip::none) {
        return input.found;
    }
    if (!finite(input)) {
        return Trip::not_finite;
    }
    advance(state.clock, input.time_ns, limits.period, input.fresh);
    if (const Trip motion = watch_motion(state.motion, limits, input.hip, input.fresh, state.clock);
        motion != Trip::none) {
        return motion;
    }
    if (limits.watch_encoders &&
        encoder_stuck(state.encoders, input.counts, input.hip, limits.stuck_travel)) {
        return Trip::stuck_encoder;
    }
    if (late_too_often(state.late, limits, input.lateness_ns)) {
        return Trip::late;
    }
    if (silent_too_long(state, limits, input.fresh)) {
        return Trip::device_silent;
    }
    if (too_active(state, limits, input)) {
        return Trip::energy;
    }
    if (too_hot(state, limits, input)) {
        return Trip::overheated;
    }
    if (limits.dead_man && !input.held) {
        return Trip::let_go;
    }
    return input.stop ? Trip::stopped : Trip::none;
}

Command limited(SafetyState& state, const SafetyLimits& limits, const SafetyInput& input) noexcept {
    Command command;
    const Vec2 most = saturated(input.force, limits.most);
    command.saturated = most != input.force;
    state.gain = ramped(state.gain, limits.ramp_step, input.enable);
    command.ramped = state.gain < 1.0;
    const Vec2 target = state.gain * most;
    command.force = within_slew(state.command, target, limits.slew);
    command.force_slew = command.force != target;
    return command;
}

}  // namespace

Command make_safe(SafetyState& state,
                  const SafetyLimits& limits,
                  const SafetyInput& input) noexcept {
    if (state.trip == Trip::none) {
        state.trip = cause(state, limits, input);
    }
    Command command;
    if (state.trip == Trip::none) {
        command = limited(state, limits, input);
    } else {
        state.gain = 0.0;
    }
    command.trip = state.trip;
    state.command = command.force;
    note_command(state.energy, command.force);
    return command;
}

SafetyState fresh_state(const SafetyState& last, const SafetyLimits& limits, double rest) noexcept {
    SafetyState state;
    if (limits.heat_step > 0.0) {
        state.heat = heated(last.heat, Vec2{}, rest / limits.period * limits.heat_step);
    }
    return state;
}

}  // namespace palpate::engine
