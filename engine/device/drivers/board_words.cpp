#include <cmath>

#include "engine/base/text.hpp"
#include "engine/device/drivers/board_device.hpp"

// What the driver of a board says of it to people.
namespace palpate::engine {

std::string BoardDevice::name() const {
    return line_->kind() + " " + machine_.calibration().name() + " at " + link_->name();
}

bool BoardDevice::force_unproved() const {
    return zero_unproved_ && std::isinf(line_->holds_force());
}

std::string BoardDevice::warning() const {
    return force_unproved() ? std::string(kForceUnproved) + ". Then: " : "";
}

std::string BoardDevice::explained(DeviceFault fault) const {
    if (fault == DeviceFault::none) {
        return {};
    }
    const std::string board = "the board at " + link_->name();
    if (std::string said = line_->complaint(); !said.empty() && fault != DeviceFault::unreachable) {
        return said;
    }
    switch (fault) {
        case DeviceFault::none:
        case DeviceFault::ended:
            return {};
        case DeviceFault::lost:
            return board + (link_->keeps_packets()
                                ? " is gone: start its program again and check the cable"
                                : " is gone: plug it in again and check its power");
        case DeviceFault::silent:
            return board + " stopped answering in time: check its power and cable";
        case DeviceFault::garbage:
            return board + " sent what cannot be: end other programs that use it, check the cable";
        case DeviceFault::stopped:
            return board + " has switched its motors off";
        case DeviceFault::held:
            return "palpate stood still with the force on, so that its guard switched the motors "
                   "off: end what keeps this machine busy";
        case DeviceFault::unguarded:
            return "the guard process of the motors is gone: it is started again";
        case DeviceFault::unreachable:
            break;
    }
    return board +
           " is back, but where the handle was is lost: put the handle at "
           "its home pose " +
           place_text(home_of(machine_.calibration()), machine_.axes()) +
           " and let it rest there for " + number_text(timing_.still) + " s";
}

}  // namespace palpate::engine
