#include "ui/rig/open_device.hpp"

#include <stdexcept>

#include <fmt/format.h>

#include "engine/device/drivers/comedi_card.hpp"
#include "engine/device/emulator/emulated_haply.hpp"
#include "engine/device/pointer_device.hpp"
#include "protocols/file/calibration_file.hpp"

namespace palpate::ui {

using Kind = DeviceChoice::Kind;

engine::Calibration calibration_of(const DeviceChoice& choice, const std::string& name_or_file) {
    if (!name_or_file.empty()) {
        engine::Calibration calibration = protocols::load_calibration(name_or_file);
        if (calibration.gantry && choice.kind != Kind::board && choice.kind != Kind::replay) {
            throw std::invalid_argument(fmt::format(
                "--calibration {}: {} has three axes, which an open board alone drives: give "
                "--device board:PORT, or the calibration of a pantograph",
                name_or_file, calibration.name()));
        }
        return calibration;
    }
    const bool small = choice.kind == Kind::haply || choice.kind == Kind::haply_emulator ||
                       choice.kind == Kind::board;
    return protocols::load_calibration(small ? "2diy_gen3" : "mk2");
}

std::string device_name(const DeviceChoice& choice, const std::string& machine, bool surface) {
    switch (choice.kind) {
        case Kind::simulated:
            return surface ? "simulated gantry" : "simulated pantograph";
        case Kind::mouse:
            return "mouse";
        case Kind::replay:
            return "replay of " + choice.file;
        case Kind::haply:
            return "Haply " + machine + " at " + choice.file;
        case Kind::haply_emulator:
            return "emulated Haply " + machine;
        case Kind::board:
            return "open board " + machine + " at " + choice.file;
        case Kind::comedi:
            return "comedi " + choice.file + " (" + machine + ")";
    }
    return {};
}

std::unique_ptr<engine::Device> open_device(const DeviceChoice& choice,
                                            const engine::Calibration& calibration,
                                            double period) {
    switch (choice.kind) {
        case Kind::mouse:
            return std::make_unique<engine::PointerDevice>();
        case Kind::haply:
            return engine::open_haply(choice.file, calibration, {.period = period},
                                      {.apart = true});
        case Kind::board:
            return engine::open_board(choice.file, calibration, {.period = period},
                                      {.apart = true});
        case Kind::comedi:
            return engine::open_comedi(choice.file, calibration);
        case Kind::simulated:
        case Kind::haply_emulator:
        case Kind::replay:
            break;
    }
    throw std::invalid_argument("a simulated hand is no device that can be opened alone");
}

}  // namespace palpate::ui
