#pragma once

#include <cstdint>
#include <string_view>

namespace palpate::engine {

enum class DeviceFault : std::uint8_t;

/// Why the safety chain switched the force off. Latched until the next trial.
enum class Trip : std::uint8_t {
    none,
    not_finite,        ///< the rendered force was not a number
    scene_refused,     ///< the scene could not render this HIP
    device_lost,       ///< unplugged, closed, or nothing guards it
    device_silent,     ///< no new reading for too many ticks
    device_stopped,    ///< it switched its motors off itself: emergency stop, its own watchdog
    device_garbage,    ///< readings that cannot be
    out_of_workspace,  ///< no pose, or a singular one
    jump,              ///< HIP moved further in a tick than a hand can
    stuck_encoder,     ///< an encoder stands still while the other moves, or all do under a force
    over_speed,        ///< HIP is faster than the limit
    late,              ///< too many late ticks
    delayed,           ///< readings became older than the stiffness allows
    energy,            ///< the rendering gave more energy than it took
    runaway,           ///< HIP sped up against the full force
    buzz,              ///< the contact oscillates faster than a hand can
    overheated,        ///< the motor model is at its limit
    screen_silent,  ///< the screen or the session's loop stood still: nobody could stop the force
    time_limit,     ///< the force was on for longer than the protocol allows
    let_go,         ///< the participant let go of the handle or of the dead-man key
    focus_lost,     ///< the participant's window lost the keyboard, was hidden or was to be closed
    stopped,        ///< by hand: a key, the terminal, another shell, a button
};

/// After it the experimenter goes on, and never the participant.
[[nodiscard]] constexpr bool waits_for_experimenter(Trip trip) noexcept {
    return trip == Trip::focus_lost || trip == Trip::stopped;
}

/// What a device's fault is to the safety chain. @return none for none
[[nodiscard]] Trip trip_of(DeviceFault fault) noexcept;

/// For the database: "over_speed".
[[nodiscard]] std::string_view to_string(Trip trip) noexcept;

/// For people: what happened and what to do, as a sentence without a full stop.
[[nodiscard]] std::string_view explanation(Trip trip) noexcept;

}  // namespace palpate::engine
