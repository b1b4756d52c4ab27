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
        case Trip::energy:
            return "energy";
        case Trip::overheated:
            return "overheated";
        case Trip::let_go:
            return "let_go";
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
        case Trip::device_garbage:
            return "the device sends values that cannot be: unplug it, wait, plug it in again";
        case Trip::out_of_workspace:
            return "the handle left the workspace: bring it back to the middle";
        case Trip::jump:
            return "the handle jumped: check the encoder cables and calibrate again";
        case Trip::stuck_encoder:
            return "an encoder stands still while the other moves: check its cable";
        case Trip::over_speed:
            return "the handle was faster than the limit: move more slowly";
        case Trip::late:
            return "the force loop was late too often: close other programs; see palpate doctor";
        case Trip::energy:
            return "the force gave more energy than it took: lower the stiffness or raise the rate";
        case Trip::overheated:
            return "the motors are at their thermal limit: let them cool, press less hard";
        case Trip::let_go:
            return "the participant let go";
        case Trip::stopped:
            return "the experimenter stopped the force";
    }
    return "nothing happened";
}

}  // namespace palpate::engine
