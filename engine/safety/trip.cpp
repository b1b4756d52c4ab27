#include "engine/safety/trip.hpp"

namespace palpate::engine {

std::string_view to_string(Trip trip) noexcept {
    switch (trip) {
        case Trip::none:
            return "none";
        case Trip::not_finite:
            return "not_finite";
        case Trip::scene_refused:
            return "scene_refused";
        case Trip::device_lost:
            return "device_lost";
        case Trip::device_silent:
            return "device_silent";
        case Trip::device_stopped:
            return "device_stopped";
        case Trip::device_garbage:
            return "device_garbage";
        case Trip::out_of_workspace:
            return "out_of_workspace";
        case Trip::jump:
            return "jump";
        case Trip::stuck_encoder:
            return "stuck_encoder";
        case Trip::over_speed:
            return "over_speed";
        case Trip::late:
            return "late";
        case Trip::delayed:
            return "delayed";
        case Trip::energy:
            return "energy";
        case Trip::runaway:
            return "runaway";
        case Trip::buzz:
            return "buzz";
        case Trip::overheated:
            return "overheated";
        case Trip::screen_silent:
            return "screen_silent";
        case Trip::time_limit:
            return "time_limit";
        case Trip::let_go:
            return "let_go";
        case Trip::focus_lost:
            return "focus_lost";
        case Trip::stopped:
            return "stopped";
    }
    return "none";
}

std::string_view explanation(Trip trip) noexcept {
    switch (trip) {
        case Trip::none:
            return "nothing happened";
        case Trip::not_finite:
            return "the rendered force was not a number: please report it with the database";
        case Trip::scene_refused:
            return "the object could not be rendered there: please report it with the database";
        case Trip::device_lost:
            return "the device is gone: check its cable and power";
        case Trip::device_silent:
            return "the device stopped answering: check its cable and power";
        case Trip::device_stopped:
            return "the device switched its motors off: release its emergency stop; if nobody "
                   "pressed it, close other programs and check the cable";
        case Trip::device_garbage:
            return "the device sends values that cannot be: unplug it, wait, plug it in again";
        case Trip::out_of_workspace:
            return "the handle left the workspace: bring it back to the middle";
        case Trip::jump:
            return "the handle jumped: check the encoder cables and calibrate again";
        case Trip::stuck_encoder:
            return "an encoder stands still while the handle moves or is pushed: check the "
                   "encoders' cables and supply";
        case Trip::over_speed:
            return "the handle was faster than the limit: move more slowly; if nobody moved it so "
                   "fast, keep hands off and check the cables of motors and encoders";
        case Trip::late:
            return "the force loop was late too often: close other programs; see palpate doctor";
        case Trip::delayed:
            return "the device's answers became later than this stiffness allows: use a port of "
                   "the computer itself without a hub, and end programs that keep it busy";
        case Trip::energy:
            return "the force gave more energy than it took: lower the stiffness or raise the rate";
        case Trip::runaway:
            return "the handle sped up against the full force: keep hands off and test the motors' "
                   "signs and cables; if they are right, press less suddenly";
        case Trip::buzz:
            return "the contact buzzed: hold the handle more firmly, or lower stiffness_n_per_m";
        case Trip::overheated:
            return "the motors are at their thermal limit: let them cool, press less hard";
        case Trip::screen_silent:
            return "the screen or this program stood still: close other programs, check the "
                   "display's cable and server";
        case Trip::time_limit:
            return "the force was on for longer than explore_timeout_s: close other programs and "
                   "report it with the database";
        case Trip::let_go:
            return "the participant let go: hold the handle, and the dead-man key, until done";
        case Trip::focus_lost:
            return "the participant's window lost the keyboard, was hidden or was to be closed: "
                   "put away what stands before it, and go on with the chord for pauses";
        case Trip::stopped:
            return "somebody stopped the force: the experimenter's chord for pauses goes on";
    }
    return "nothing happened";
}

}  // namespace palpate::engine
