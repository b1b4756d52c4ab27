#pragma once

#include <array>
#include <cstdint>

#include "engine/geometry/vec.hpp"
#include "engine/safety/safety_limits.hpp"
#include "engine/safety/trip.hpp"

namespace palpate::engine {

/// What the chain is told each tick.
struct SafetyInput {
    Vec2 force{};   ///< rendered, N
    Vec2 spring{};  ///< GO - HIP, m; 0 out of contact
    Vec2 hip{};     ///< m
    std::array<std::int32_t, 2> counts{};
    Trip found = Trip::none;       ///< what device or scene reported this tick
    bool fresh = true;             ///< HIP was measured since the last tick
    std::int64_t lateness_ns = 0;  ///< wake-up minus deadline
    Vec2 load{};                   ///< motors' torque share of the last tick, see Applied::load
    bool enable = true;            ///< ramp towards on (true) or off (false)
    bool held = true;              ///< someone holds the dead-man switch
    bool stop = false;             ///< the experimenter's key
};

/// What the chain remembers. A plain value.
struct SafetyState {
    double gain = 0.0;       ///< of the ramp: 0 off, 1 on
    Trip trip = Trip::none;  ///< latched: zero until the next trial
};

struct Command {
    Vec2 force{};
    bool saturated = false;
    bool slewed = false;
    bool ramped = false;     ///< scaled down by the ramp
    Trip trip = Trip::none;  ///< the latched cause; the force is zero
};

/// Finite guard -> saturation that keeps the direction -> slew limit -> ramp -> trips (speed, late
/// ticks, energy, motor heat, dead-man) -> latched fault. Finite in, finite and limited out; anything
/// else latches its cause and gives zero.
[[nodiscard]] Command make_safe(SafetyState& state,
                                const SafetyLimits& limits,
                                const SafetyInput& input) noexcept;

}  // namespace palpate::engine
