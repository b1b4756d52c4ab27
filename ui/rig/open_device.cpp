#include "ui/rig/open_device.hpp"

#include <charconv>
#include <stdexcept>
#include <utility>

#include "engine/base/refuse.hpp"
#include "engine/device/drivers/comedi_card.hpp"
#include "engine/device/emulator/emulated_board.hpp"
#include "engine/device/pointer_device.hpp"
#include "engine/device/simulated_pantograph.hpp"

namespace palpate::ui {

using Kind = DeviceChoice::Kind;

protocols::RigFile rig_file_of(const DeviceChoice& choice, const std::string& name_or_file) {
    if (!name_or_file.empty()) {
        protocols::RigFile rig = protocols::load_rig(name_or_file);
        engine::Calibration& calibration = rig.calibration;
        if (rig.record && pushes_a_person(choice.kind) &&
            parse_device(rig.record->device) != choice) {
            calibration.pantograph.damping.reset();
            if (calibration.gantry) {
                calibration.gantry->damping.reset();
            }
        }
        refuse_if(calibration.gantry && choice.kind != Kind::board && choice.kind != Kind::replay,
                  "--calibration {}: {} has three axes, which an open board alone drives: give "
                  "--device board:PORT, or the calibration of a pantograph",
                  name_or_file, calibration.name());
        return rig;
    }
    const bool small = choice.kind == Kind::haply || choice.kind == Kind::haply_emulator ||
                       choice.kind == Kind::board;
    return protocols::load_rig(small ? "2diy_gen3" : "mk2");
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

namespace {

/// rad that the simulated encoders are off by.
constexpr std::array<double, 2> kHidden{0.2345, -0.1234};
constexpr double kPeriod = 1e-3;

/// "1,2" or "1,2,3".
template <int kNumbers>
std::optional<engine::Vec<kNumbers>> numbers_of(const std::string& text) {
    engine::Vec<kNumbers> numbers{};
    const char* const end = text.data() + text.size();
    const char* at = text.data();
    bool good = true;
    for (int i = 0; i < kNumbers && good; ++i) {
        const auto number = std::from_chars(at, end, numbers[i]);
        at = number.ptr;
        good = number.ec == std::errc{};
        if (good && i + 1 < kNumbers) {
            good = at != end && *at++ == ',';
        }
    }
    return good && at == end ? std::optional(numbers) : std::nullopt;
}

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
    refuse_if(choice.kind != haply && choice.kind != board && choice.kind != comedi,
              "--device {}: there is nothing to calibrate; give sim, haply:PORT, board:PORT or "
              "comedi:FILE",
              device);
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

template <int kAxes>
engine::Vec<kAxes> parse_place(const std::string& text, const std::string& word) {
    constexpr double kFar = 1000.0;
    const auto mm = numbers_of<kAxes>(text);
    refuse_if(!mm || !(glm::length(*mm) <= kFar),
              "{0} {1}: give its place in the object's frame in mm, as in {0} {2}", word, text,
              kAxes > 2 ? "0,40,20" : "0,40");
    return *mm / 1000.0;
}
template engine::Vec2 parse_place<2>(const std::string& text, const std::string& word);
template engine::Vec3 parse_place<3>(const std::string& text, const std::string& word);

std::optional<engine::Vec3> three_numbers(const std::string& text) {
    return numbers_of<3>(text);
}

}  // namespace palpate::ui
