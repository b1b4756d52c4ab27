#include "ui/rig/calibration_device.hpp"

#include <charconv>
#include <stdexcept>

#include <fmt/format.h>

#include "engine/device/pantograph.hpp"
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
    using enum DeviceChoice::Kind;
    if (choice.kind != haply && choice.kind != board && choice.kind != comedi) {
        throw std::invalid_argument(
            fmt::format("--device {}: there is nothing to calibrate; give sim, haply:PORT, "
                        "board:PORT or comedi:FILE",
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

engine::Vec2 parse_place(const std::string& text, const std::string& word) {
    engine::Vec2 mm{};
    const char* const end = text.data() + text.size();
    const auto x = std::from_chars(text.data(), end, mm.x);
    const bool comma = x.ec == std::errc{} && x.ptr != end && *x.ptr == ',';
    const auto y = comma ? std::from_chars(x.ptr + 1, end, mm.y) : x;
    constexpr double kFar = 1000.0;
    if (!comma || y.ec != std::errc{} || y.ptr != end || !(glm::length(mm) <= kFar)) {
        throw std::invalid_argument(fmt::format(
            "{0} {1}: give its place in the object's frame in mm, as in {0} 0,40", word, text));
    }
    return mm / 1000.0;
}

bool starts_at_home(const engine::Calibration& calibration) {
    return calibration.home || calibration.haply || calibration.board;
}

engine::Vec2 home_of(const engine::Calibration& calibration) {
    if (calibration.home) {
        return *calibration.home;
    }
    const engine::Pantograph machine(calibration.pantograph);
    const auto fix =
        starts_at_home(calibration) ? machine.locate(machine.angles({0, 0})) : std::nullopt;
    return fix ? fix->hip : engine::Vec2{0.0, 0.020};
}

}  // namespace palpate::ui
