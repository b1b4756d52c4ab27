#pragma once

#include <array>
#include <cstdint>

#include "engine/geometry/vec.hpp"
#include "engine/safety/contact_watch.hpp"
#include "engine/safety/encoder_watch.hpp"
#include "engine/safety/energy_observer.hpp"
#include "engine/safety/late_ticks.hpp"
#include "engine/safety/motion_watch.hpp"
#include "engine/safety/safety_limits.hpp"
#include "engine/safety/trip.hpp"

namespace palpate::engine {

/// Heat of the motors, as a share of what each can bear for ever: the I^2 t model, first order,
///
///     theta' = (load^2 - theta) / tau
///
/// by theta += a (load^2 - theta) with a = 1 - 1 / (1 + s + s^2/2), s = step / tau: 1 - exp(-s) to
/// s^3/6, and between 0 and 1 for any step. A load of 1 for ever never brings theta above 1.
/// @param heat  theta, >= 0   @param load  |torque| / torque_forever   @param step  time / tau, >=
///       0
[[nodiscard]] Vec3 heated(const Vec3& heat, const Vec3& load, double step) noexcept;

/// What the safety chain gets each tick. In the plane z, and what is of a third motor, are 0.
struct SafetyInput {
    Vec3 force{};        ///< rendered, N
    Vec3 spring{};       ///< GO - HIP, m; 0 out of contact
    double depth = 0.0;  ///< normal force / K, m; 0 out of contact
    Vec3 hip{};          ///< m
    std::array<std::int32_t, 3> counts{};
    Trip found = Trip::none;       ///< what device or scene reported this tick
    bool fresh = true;             ///< HIP was measured since the last tick
    double behind = 0.0;           ///< ticks that HIP is older than delay_ticks, >= 0
    std::int64_t time_ns = 0;      ///< of the wake-up; left alone, a tick is a period
    std::int64_t lateness_ns = 0;  ///< wake-up minus deadline
    Vec3 load{};              ///< motors' torque share of the last tick, see AppliedForce::load
    bool clipped = false;     ///< the motors could not give the last command
    double screen_age = 0.0;  ///< s since the screen's last sign of life
    bool enable = true;       ///< ramp towards on (true) or off (false)
    bool held = true;         ///< someone holds the dead-man key
    Trip stop = Trip::none;   ///< who ends it by hand: stopped, focus_lost; none: nobody
};

/// What the safety chain remembers. A plain value; 12 kB, most of it the ways of the last 20 ms.
struct SafetyState {
    double gain = 0.0;        ///< of the ramp: 0 off, 1 on
    Trip trip = Trip::none;   ///< latched: zero until the next trial
    Vec3 command{};           ///< of the last tick, N
    Vec3 heat{};              ///< of the motors, 1: what they bear for ever
    std::int32_t silent = 0;  ///< ticks in a row without a fresh reading
    DelayWatch delay{};
    ReadingClock clock{};
    LateTicks late{};
    EncoderWatch encoders{};
    StillWatch still{};
    MotionWatch motion{};
    EnergyObserver energy{};
    RunawayWatch runaway{};
    BuzzWatch buzz{};
};

/// What the chain makes of a rendered force, N.
struct Command {
    Vec3 force{};
    bool saturated = false;
    bool force_slew = false;  ///< it changed as fast as the limit allows
    bool ramped = false;      ///< scaled down by the ramp
    Trip trip = Trip::none;   ///< the latched cause; the force is zero
};

/// What stands between the rendered force and the device, in this order:
///
///     finite guard -> jump, speed -> stuck encoders -> late ticks -> silent device -> delayed
///     readings -> energy -> runaway -> buzz -> motor heat -> silent screen -> time -> stop by
///     hand -> dead-man -> latched fault, or: saturation -> ramp -> slew limit
///
/// For any input at all, finite or not: the command is finite, |F| <= max_force, and |F[k] -
/// F[k-1]| <= slew but for the step to zero at a trip or where the device is quiet (both to
/// rounding); after quiet_run ticks without a new reading it is zero until there is one, and ramps
/// in again; |F[k]| <= (k + 1) ramp_step max_force for tick k of a trial; from the tick of a trip
/// on it is zero and keeps the first cause. While no encoder counts under a force it eases off, see
/// StillWatch. When one tick has several, the order above decides. The slew limit comes last since
/// it bounds what the hand feels, the ramp included.
[[nodiscard]] Command make_safe(SafetyState& state,
                                const SafetyLimits& limits,
                                const SafetyInput& input) noexcept;

/// The state for the next trial: nothing but the motors' heat lives on, cooled for `rest` s.
[[nodiscard]] SafetyState fresh_state(const SafetyState& last,
                                      const SafetyLimits& limits,
                                      double rest) noexcept;

}  // namespace palpate::engine
