#include "engine/base/text.hpp"
#include "engine/device/open/open_line.hpp"

// What the line of an open board says of it to people.
namespace palpate::engine {
namespace {

/// "1 and 2", "1, 2 and 3"
std::string listed(const OpenAxes& numbers, std::size_t axes) {
    std::string text = std::to_string(numbers[0]);
    for (std::size_t i = 1; i < axes; ++i) {
        text += (i + 1 == axes ? " and " : ", ") + std::to_string(numbers[i]);
    }
    return text;
}

}  // namespace

std::string OpenLine::identity() const {
    return "id " + std::to_string(ident_.id) + ", firmware " + std::to_string(ident_.firmware) +
           ", protocol " + std::to_string(ident_.major) + "." + std::to_string(ident_.minor);
}

/// What the board says of itself, against the calibration.
std::string OpenLine::other_machine() const {
    switch (problem_) {
        case Problem::id:
            return " has the id " + std::to_string(ident_.id) +
                   ", and the calibration is of the board " + std::to_string(*wiring_.id) +
                   ": plug that one in, or calibrate this one";
        case Problem::axes:
            return " has " + std::to_string(ident_.axes) +
                   " axes, and the calibration is of a machine with " + std::to_string(axes_) +
                   ": give the other machine's calibration, or flash the board with AXES=" +
                   std::to_string(axes_);
        case Problem::counts:
            return " was flashed for " + listed(ident_.counts_per_turn, axes_) +
                   " counts a turn, and the calibration says " + listed(counts_per_turn_, axes_) +
                   ": correct counts_per_turn, or flash it with COUNTS_1" +
                   (axes_ > 2 ? ", COUNTS_2 and COUNTS_3" : " and COUNTS_2") + " of these";
        case Problem::torque:
            return " gives " + listed(ident_.torque_full, axes_) +
                   " uN m at most, less than the calibration's torque_limit_mn_m: lower that";
        default:
            return {};
    }
}

std::string OpenLine::refusal() const {
    const std::string board = "the board at " + link_->name();
    switch (problem_) {
        case Problem::version:
            return board + " speaks version " + std::to_string(ident_.major) +
                   " of the open board's protocol, and palpate version " +
                   std::to_string(kOpenMajor) + ": flash the firmware that comes with palpate";
        case Problem::id:
        case Problem::axes:
        case Problem::counts:
        case Problem::torque:
            return board + other_machine();
        case Problem::watchdog:
            return board + " has a watchdog of " + std::to_string(ident_.watchdog_min) + " to " +
                   std::to_string(ident_.watchdog_max) +
                   " ms: give watchdog_ms within that in the calibration";
        case Problem::config:
            return board +
                   " did not take its limits as they were sent: flash the firmware that comes with "
                   "palpate, and use a shorter cable";
        case Problem::clock:
            return "the clock of " + board + " runs wrong: " +
                   (bare_ ? "it must count microseconds, and no machine between may be busy"
                          : "its crystal must have 16 MHz, and this machine must not be busy");
        case Problem::moves:
            return "the handle on " + board + " moves: let it rest at home, and try again";
        case Problem::silent:
        case Problem::none:
            return board + (bare_ ? " does not answer: does the device's program run there, and "
                                    "does it listen at this port?"
                                  : " does not answer at 1,000,000 baud: is it an open board, and "
                                    "has it power? Unplug it, plug it in again");
        case Problem::other_device:
            return "what is at " + link_->name() +
                   " answers, but not as an open board: is it another device's port?";
        default:
            return complaint();
    }
}

std::string OpenLine::complaint() const {
    const std::string board = "the board at " + link_->name();
    switch (problem_) {
        case Problem::stop_pressed:
            return "the emergency stop of " + board +
                   " was pressed, or its wire is broken: release it when it is safe";
        case Problem::was_reset:
            return board +
                   " was reset, or its power failed: check power, cable and the motors' current";
        case Problem::watchdog_fired:
            return board + " has switched its motors off, since no torque came for " +
                   number_text(1e3 * wiring_.watchdog) +
                   " ms: close other programs on this machine, or check the cable";
        case Problem::skipped_edge:
            return "an encoder of " + board +
                   " skipped an edge, so that where the handle is is lost: check its cable, and "
                   "move more slowly";
        case Problem::other_host:
            return "another program speaks to " + board +
                   ": end that one, which the board listens to until it has been silent for a "
                   "second";
        case Problem::jump:
            return board + " sent what cannot be: check the encoders' cables";
        default:
            return {};
    }
}

}  // namespace palpate::engine
