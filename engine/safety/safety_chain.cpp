#include "engine/safety/safety_chain.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::engine {

Vec3 heated(const Vec3& heat, const Vec3& load, double step) noexcept {
    const double kept = 1.0 / (1.0 + step * (1.0 + 0.5 * step));  // 0 after an infinite time
    return heat + (1.0 - kept) * (load * load - heat);
}

namespace {

/// `force`, or where it is longer than `limit` the vector of that length in its direction: a force
/// that is clipped axis by axis would turn, and a wall would feel as if it had friction.
/// @param force  N, finite, |force| < 1e154   @param limit  N, >= 0
Vec3 saturated(const Vec3& force, double limit) noexcept {
    const double length = glm::length(force);
    return length > limit ? force * (limit / length) : force;
}

/// `target`, or where that is further than `slew` from `last` the point at that distance on the way
/// to it. Between two vectors of a ball the way stays inside: what is no longer than a limit stays
/// so.
/// @param last    the force of the tick before, N   @param slew  N, >= 0, infinity: no limit
Vec3 within_slew(const Vec3& last, const Vec3& target, double slew) noexcept {
    const Vec3 change = target - last;
    const double length = glm::length(change);
    return length > slew ? last + change * (slew / length) : target;
}

/// The gain of the ramp a tick later, 0 off ... 1 on. @param step  share a tick, > 0
double ramped(double gain, double step, bool enable) noexcept {
    return std::clamp(enable ? gain + step : gain - step, 0.0, 1.0);
}

/// |v|^2 is a number: beyond 1e154 it is not, and that is a fault too.
bool finite(const Vec3& v) noexcept {
    return std::isfinite(glm::dot(v, v));
}

constexpr double kRounding = 1e-9;  ///< share by which a full command may be less than its limit

bool finite(const SafetyInput& input) noexcept {
    return finite(input.force) && finite(input.spring) && finite(input.hip) && finite(input.load) &&
           std::isfinite(input.depth) && std::isfinite(input.behind);
}

/// One of them stands still while others move, or all do under a force.
bool encoders_dead(SafetyState& state,
                   const SafetyLimits& limits,
                   const SafetyInput& input) noexcept {
    const bool one = encoder_stuck(state.encoders, input.counts, input.hip, limits.axes,
                                   state.command, limits.stuck_travel);
    const auto all =
        stillness(state.still, input.counts, glm::length(state.command), state.clock.now);
    return one || all == StillWatch::State::dead;
}

bool silent_too_long(SafetyState& state, const SafetyLimits& limits, bool fresh) noexcept {
    state.silent = fresh ? 0 : state.silent + 1;
    return limits.silent_run > 0 && state.silent >= limits.silent_run;
}

/// Nobody knows where the handle is: no force until it is known again.
bool quiet(const SafetyState& state, const SafetyLimits& limits) noexcept {
    return limits.quiet_run > 0 && state.silent >= limits.quiet_run;
}

/// E of this tick is above its limit, or not a number. Without a limit nothing is summed.
bool too_active(SafetyState& state, const SafetyLimits& limits, const SafetyInput& input) noexcept {
    return std::isfinite(limits.energy) &&
           !(observe_energy(state.energy, limits, input.hip, input.spring, state.gain,
                            state.clock.since) <= limits.energy);
}

/// Full is what the limit or the motors cut.
bool handle_runs_away(SafetyState& state,
                      const SafetyLimits& limits,
                      const SafetyInput& input) noexcept {
    const bool full =
        input.clipped || glm::length(state.command) >= limits.max_force * (1.0 - kRounding);
    return limits.watch_runaway &&
           runs_away(state.runaway, full, input.depth, input.hip, state.clock.now);
}

bool contact_buzzes(SafetyState& state,
                    const SafetyLimits& limits,
                    const SafetyInput& input) noexcept {
    return limits.watch_buzz && buzzes(state.buzz, input.depth, state.clock.now);
}

bool too_hot(SafetyState& state, const SafetyLimits& limits, const SafetyInput& input) noexcept {
    if (limits.heat_step > 0.0) {
        state.heat = heated(state.heat, input.load, limits.heat_step);
    }
    return limits.heat_step > 0.0 &&
           !(state.heat.x <= 1.0 && state.heat.y <= 1.0 && state.heat.z <= 1.0);
}

/// What ends a force although nothing is wrong with it: whoever watches it, and for how long. The
/// ramp out is the servo's own: nobody is asked for it, and it ends by itself.
Trip people(const SafetyState& state,
            const SafetyLimits& limits,
            const SafetyInput& input) noexcept {
    if (input.enable && !(input.screen_age <= limits.screen_silence)) {
        return Trip::screen_silent;
    }
    if (input.enable && !(state.clock.now <= limits.time_limit)) {
        return Trip::time_limit;
    }
    if (input.stop != Trip::none) {
        return input.stop;
    }
    return limits.dead_man && !input.held ? Trip::let_go : Trip::none;
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
    if (limits.watch_encoders && encoders_dead(state, limits, input)) {
        return Trip::stuck_encoder;
    }
    if (late_too_often(state.late, limits, input.lateness_ns)) {
        return Trip::late;
    }
    if (silent_too_long(state, limits, input.fresh)) {
        return Trip::device_silent;
    }
    if (!quiet(state, limits) &&
        delayed(state.delay, input.behind, limits.spare_delay, limits.period)) {
        return Trip::delayed;
    }
    if (too_active(state, limits, input)) {
        return Trip::energy;
    }
    if (handle_runs_away(state, limits, input)) {
        return Trip::runaway;
    }
    if (contact_buzzes(state, limits, input)) {
        return Trip::buzz;
    }
    if (too_hot(state, limits, input)) {
        return Trip::overheated;
    }
    return people(state, limits, input);
}

Command limited(SafetyState& state, const SafetyLimits& limits, const SafetyInput& input) noexcept {
    Command command;
    const Vec3 strong = saturated(input.force, limits.max_force);
    command.saturated = strong != input.force;
    const bool off = quiet(state, limits);
    const bool eases = state.still.eases;
    const double step =
        eases ? std::fmax(limits.ramp_step, ramp_step(kStillTrip - kStillEase, limits.period))
              : limits.ramp_step;
    state.gain = off ? 0.0 : ramped(state.gain, step, input.enable && !eases);
    command.ramped = state.gain < 1.0;
    const Vec3 target = state.gain * strong;
    command.force = off ? Vec3{} : within_slew(state.command, target, limits.slew);
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
    note_command(state.energy, state.command);
    return command;
}

SafetyState fresh_state(const SafetyState& last, const SafetyLimits& limits, double rest) noexcept {
    SafetyState state;
    if (limits.heat_step > 0.0) {
        state.heat = heated(last.heat, Vec3{}, rest / limits.period * limits.heat_step);
    }
    return state;
}

}  // namespace palpate::engine
