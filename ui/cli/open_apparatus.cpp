#include "ui/cli/open_apparatus.hpp"

#include <stdexcept>

namespace palpate::ui {

std::unique_ptr<protocols::Apparatus> open_apparatus(const RigSpec& spec) {
    const protocols::Protocol& protocol = spec.study.protocol;
    switch (spec.device.kind) {
        case DeviceChoice::Kind::simulated:
            return std::make_unique<protocols::SimulatedApparatus>(
                protocol, protocols::DrawnHand(protocol, spec.study.hash, spec.key, spec.seed),
                spec.screen.speed);
        case DeviceChoice::Kind::replay:
            return std::make_unique<protocols::ReplayApparatus>(
                protocol, spec.recordings, spec.device.file, spec.screen.speed);
        case DeviceChoice::Kind::mouse:
            return std::make_unique<protocols::PointerApparatus>(protocol);
        case DeviceChoice::Kind::haply:
        case DeviceChoice::Kind::haply_emulator:
        case DeviceChoice::Kind::comedi:
            break;
    }
    throw std::invalid_argument("this device cannot be opened yet");
}

}  // namespace palpate::ui
