#include "engine/device/emulator/emulated_haply.hpp"

#include <stdexcept>

#include "engine/device/drivers/serial_link.hpp"

namespace palpate::engine {
namespace {

constexpr Vec2 kHome{0.0, 0.060};  ///< m

Calibration machine(std::string_view name,
                    const FiveBar& linkage,
                    double counts_per_turn,
                    const Vec2& origin,
                    const HaplyWiring& wiring) {
    const Axis axis{.counts_per_turn = counts_per_turn,
                    .zero = 0.0,
                    .torque_limit = kHaplyTorque,
                    .torque_forever = 0.5 * kHaplyTorque,
                    .codes_full_scale = 4095.0};
    Calibration calibration;
    calibration.pantograph.name = name;
    calibration.pantograph.linkage = linkage;
    calibration.pantograph.axes = {axis, axis};
    calibration.pantograph.origin = origin;
    calibration.haply = wiring;
    calibration.home = kHome;
    return calibration;
}

FiveBar linkage(double driven, double free, double base) {
    return {.driven_1 = driven, .driven_2 = driven, .free_1 = free, .free_2 = free, .base = base};
}

}  // namespace

Calibration emulated_calibration(std::string_view preset) {
    if (preset == "gen3") {
        return machine("2DIY gen3", linkage(0.07, 0.09, 0.038), 4880.0, {0.019, 0.065},
                       {.id = 5, .port = {2, 1}, .grip_pin = {}});
    }
    if (preset == "gen2") {
        return machine("2DIY gen2", linkage(0.07, 0.09, 0.0), 10752.0, {0.0, 0.065},
                       {.id = 5,
                        .port = {2, 1},
                        .motor_clockwise = {false, true},
                        .encoder_clockwise = {false, true},
                        .grip_pin = {}});
    }
    if (preset == "haplet") {
        return machine("Haplet", linkage(0.05, 0.07, 0.02), 13824.0, {0.010, 0.035},
                       {.id = 3,
                        .port = {1, 2},
                        .motor_clockwise = {true, true},
                        .encoder_clockwise = {true, true},
                        .grip_pin = {}});
    }
    throw std::invalid_argument("there is no emulated machine \"" + std::string(preset) +
                                "\": there are gen3, gen2 and haplet");
}

std::unique_ptr<HaplyDevice> open_haply(const std::string& path,
                                        const Calibration& calibration,
                                        const HaplyTiming& timing,
                                        const GuardTiming& guard) {
    return std::make_unique<HaplyDevice>(calibration, std::make_unique<SerialLink>(path),
                                         std::make_unique<GuardProcess>(guard), timing);
}

}  // namespace palpate::engine
