#include "engine/safety/trip.hpp"

#include <array>

#include "engine/device/device.hpp"

namespace palpate::engine {

namespace {

struct TripWords {
    std::string_view name;         ///< for the database
    std::string_view explanation;  ///< for people
};

/// In the order of Trip.
constexpr std::array kWords{
    TripWords{"none", "nothing happened"},
    TripWords{"not_finite",
              "the rendered force was not a number: please report it with the database"},
    TripWords{"scene_refused",
              "the object could not be rendered there: please report it with the database"},
    TripWords{"device_lost", "the device is gone: check its cable and power"},
    TripWords{"device_silent", "the device stopped answering: check its cable and power"},
    TripWords{"device_stopped",
              "the device switched its motors off: release its emergency stop; if nobody pressed "
              "it, close other programs and check the cable"},
    TripWords{"device_garbage",
              "the device sends values that cannot be: unplug it, wait, plug it in again"},
    TripWords{"out_of_workspace", "the handle left the workspace: bring it back to the middle"},
    TripWords{"jump", "the handle jumped: check the encoder cables and calibrate again"},
    TripWords{"stuck_encoder",
              "an encoder stands still while the handle moves or is pushed: check the encoders' "
              "cables and supply"},
    TripWords{"over_speed",
              "the handle was faster than the limit: move more slowly; if nobody moved it so fast, "
              "keep hands off and check the cables of motors and encoders"},
    TripWords{"late",
              "the force loop was late too often: close other programs; see palpate doctor"},
    TripWords{"delayed",
              "the device's answers became later than this stiffness allows: use a port of the "
              "computer itself without a hub, and end programs that keep it busy"},
    TripWords{"energy",
              "the force gave more energy than it took: lower the stiffness or raise the rate"},
    TripWords{"runaway",
              "the handle sped up against the full force: keep hands off and test the motors' "
              "signs and cables; if they are right, press less suddenly"},
    TripWords{"buzz",
              "the contact buzzed: hold the handle more firmly, or lower stiffness_n_per_m"},
    TripWords{"overheated",
              "the motors are at their thermal limit: let them cool, press less hard"},
    TripWords{"screen_silent",
              "the screen or this program stood still: close other programs, check the display's "
              "cable and server"},
    TripWords{"time_limit",
              "the force was on for longer than explore_timeout_s: close other programs and report "
              "it with the database"},
    TripWords{"let_go",
              "the participant let go: hold the handle, and the dead-man key, until done"},
    TripWords{"focus_lost",
              "the participant's window lost the keyboard, was hidden or was to be closed: put "
              "away what stands before it, and go on with the chord for pauses"},
    TripWords{"stopped", "somebody stopped the force: the experimenter's chord for pauses goes on"},
};
static_assert(kWords.size() == static_cast<std::size_t>(Trip::stopped) + 1);

const TripWords& words_of(Trip trip) noexcept {
    const auto place = static_cast<std::size_t>(trip);
    return kWords[place < kWords.size() ? place : 0];
}

}  // namespace

Trip trip_of(DeviceFault fault) noexcept {
    switch (fault) {
        case DeviceFault::none:
            return Trip::none;
        case DeviceFault::silent:
            return Trip::device_silent;
        case DeviceFault::stopped:
            return Trip::device_stopped;
        case DeviceFault::garbage:
            return Trip::device_garbage;
        case DeviceFault::unreachable:
            return Trip::out_of_workspace;
        case DeviceFault::held:
            return Trip::screen_silent;
        case DeviceFault::lost:
        case DeviceFault::unguarded:
        case DeviceFault::ended:
            break;
    }
    return Trip::device_lost;
}

std::string_view to_string(Trip trip) noexcept {
    return words_of(trip).name;
}

std::string_view explanation(Trip trip) noexcept {
    return words_of(trip).explanation;
}

}  // namespace palpate::engine
