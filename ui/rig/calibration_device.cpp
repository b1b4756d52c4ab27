#include "ui/rig/calibration_device.hpp"

#include <stdexcept>

#include <fmt/format.h>

#include "engine/device/simulated_pantograph.hpp"
#include "ui/rig/open_device.hpp"

namespace palpate::ui {
namespace {

/// rad that the simulated encoders are off by.
constexpr std::array<double, 2> kHidden{0.2345, -0.1234};
constexpr double kPeriod = 1e-3;

}  // namespace

std::unique_ptr<engine::Device> open_for_calibration(const std::string& device,
                                                     const engine::Calibration& calibration) {
    if (device == "sim") {
        engine::PantographModel model;
        model.plant.machine = calibration.pantograph;
        for (std::size_t i = 0; i < 2; ++i) {
            model.plant.machine.axes[i].zero += kHidden[i];
        }
        return std::make_unique<engine::SimulatedPantograph>(model, kPeriod);
    }
    const DeviceChoice choice = parse_device(device);
    if (choice.kind != DeviceChoice::Kind::haply && choice.kind != DeviceChoice::Kind::comedi) {
        throw std::invalid_argument(
            fmt::format("--device {}: there is nothing to calibrate; give sim, haply:PORT or "
                        "comedi:FILE",
                        device));
    }
    return open_device(choice, calibration, kPeriod);
}

bool bring_handle(engine::Device& device, const engine::Vec2& place) {
    auto* simulated = dynamic_cast<engine::SimulatedPantograph*>(&device);
    if (simulated == nullptr) {
        return false;
    }
    simulated->begin({.start = place, .speed = 1e-9, .tremor = 0.0});  // its hand stays there
    return true;
}

}  // namespace palpate::ui
