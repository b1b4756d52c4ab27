#pragma once

#include <limits>

#include "engine/device/simulated_pantograph.hpp"
#include "tests/support/sampled_wall.hpp"

/// The simulated pantograph on a virtual wall, at its symmetric pose: there x and y decouple, and
/// the whole linkage is one mass with one damper.
namespace palpate::tests {

struct DeviceWall {
    engine::PantographModel model{};
    double period = 1e-3;  ///< s
    double rest = 0.020;   ///< y where the handle comes to rest, object frame, m
};

/// A machine without dry friction, current lag and hand, whose encoders and converters are so fine
/// that they do not show, with so much damping at the handle in y.
inline DeviceWall fine_wall(double damping, double period, int delay) {
    using engine::Vec2;
    DeviceWall wall{.period = period};
    engine::PlantModel& plant = wall.model.plant;
    for (engine::Axis& axis : plant.machine.axes) {
        axis.counts_per_turn = 1e9;
        axis.codes_full_scale = 2147483647.0;
    }
    plant.coulomb = Vec2{};
    plant.current_time = 0.0;
    plant.handle_mass = 0.16;
    plant.hand = {.mass = 0.0, .stiffness = 0.0, .damping = 0.0};
    wall.model.delay_ticks = delay;
    const engine::Pantograph machine(plant.machine);
    const double lever = machine.locate(*machine.reach({0.0, wall.rest}))->jacobian.row_y.y;
    plant.damping = Vec2{2.0 * lever * lever * damping, 2.0 * lever * lever * damping};
    return wall;
}

/// Mass and damping at the handle in y: joint numbers over twice the lever squared, q1' = -q2'.
inline SampledWall scalar_of(const DeviceWall& wall) {
    const engine::PlantModel& plant = wall.model.plant;
    const engine::Pantograph machine(plant.machine);
    const double lever = machine.locate(*machine.reach({0.0, wall.rest}))->jacobian.row_y.y;
    return {.mass = plant.handle_mass + plant.hand.mass + plant.inertia.x / (2.0 * lever * lever),
            .damping = plant.damping.x / (2.0 * lever * lever),
            .period = wall.period,
            .virtual_damping = 0.0,
            .delay = wall.model.delay_ticks};
}

/// Growth a tick of a handle that a weight presses into the wall, set free a little beside its
/// rest. Infinity if it left the wall, NaN if the machine was lost.
inline double device_growth(const DeviceWall& wall, double stiffness, int ticks) {
    constexpr double kWeight = 2.0;  // N
    constexpr double kBeside = 0.2;  // of the depth: it stays in the wall for five times that
    const double depth = kWeight / stiffness;
    const double surface = wall.rest + depth;
    engine::SimulatedPantograph device(wall.model, wall.period);
    device.begin({.start = {0.0, wall.rest + kBeside * depth}, .speed = 1e-6, .tremor = 0.0});
    std::vector<double> path;
    for (int i = 0; i < ticks; ++i) {
        const engine::Reading reading = device.read();
        if (!reading.ok()) {
            return std::nan("");
        }
        const double force = stiffness * (surface - reading.hip.y);
        if (force < 0.0) {
            return std::numeric_limits<double>::infinity();
        }
        path.push_back(reading.hip.y - wall.rest);
        device.write({0.0, force - kWeight, 0.0});
    }
    return growth_of(path, quarter_swing(scalar_of(wall), stiffness));
}

/// The largest stiffness at which the handle comes to rest on the wall, N/m.
inline double device_stiffness(const DeviceWall& wall, int ticks, int halvings) {
    const double guess = passive_stiffness(scalar_of(wall));
    double low = 0.9 * guess;
    double high = 1.1 * guess;
    if (!(device_growth(wall, low, ticks) < 0.0) || !(device_growth(wall, high, ticks) > 0.0)) {
        return std::nan("");
    }
    for (int i = 0; i < halvings; ++i) {
        const double middle = 0.5 * (low + high);
        (device_growth(wall, middle, ticks) < 0.0 ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

}  // namespace palpate::tests
