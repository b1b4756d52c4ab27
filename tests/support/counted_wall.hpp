#pragma once

#include "tests/support/device_wall.hpp"

namespace palpate::tests {

/// The simulated pantograph pressed against a wall by a weight, its positions read in counts that
/// show. Nobody holds it, and its motors follow at once.
struct CountedWall {
    double stiffness = 1000.0;  ///< K, N/m
    double period = 1e-3;       ///< T, s
    int delay = 0;
    double damping = 1.0;  ///< b at the handle, N s/m
    double counts_per_turn = 16384.0;
    double friction = 0.0;  ///< dry, at the handle along the wall's normal, N
    double beside = 0.2;    ///< where it is let go, in parts of the depth of its rest
    double shift = 0.0;     ///< of the wall, m: where in a count the handle would rest
};

/// What became of it.
struct CountedRest {
    double speed = 0.0;          ///< of the handle, root mean square over the last third, m/s
    double reading_error = 0.0;  ///< the most that a reading lies off the handle, m
};

inline CountedRest let_go(const CountedWall& c, double seconds) {
    using namespace engine;
    DeviceWall wall = fine_wall(c.damping, c.period, c.delay);
    for (Axis& axis : wall.model.plant.machine.axes) {
        axis.counts_per_turn = c.counts_per_turn;
    }
    const Pantograph machine(wall.model.plant.machine);
    const double lever = machine.locate(*machine.reach({0.0, wall.rest}))->jacobian.row_y.y;
    wall.model.plant.coulomb = std::fabs(lever) * Vec2{c.friction, c.friction};
    constexpr double kWeight = 2.0;  // N
    const double depth = kWeight / c.stiffness;
    PantographPlant plant(wall.model.plant);
    plant.begin({.start = {0.0, wall.rest + c.beside * depth}, .speed = 1e-6, .tremor = 0.0});
    const auto handle = [&] {
        return machine.locate(plant.angles())->hip;
    };
    Vec2 waiting{};
    Vec2 before = handle();
    double sum = 0.0;
    const int ticks = static_cast<int>(seconds / c.period);
    const int late = ticks - ticks / 3;
    for (int i = 0; i < ticks; ++i) {
        const auto read = machine.locate(machine.angles(machine.counts(plant.angles())));
        const double deep = wall.rest + depth + c.shift - read->hip.y;
        const Vec2 force{0.0, std::fmax(0.0, c.stiffness * deep) - kWeight};
        const Vec2 torque = machine.drive(*read, force).torque;
        plant.set_torque(c.delay == 1 ? waiting : torque);
        waiting = torque;
        plant.advance(c.period);
        const double speed = glm::length(handle() - before) / c.period;
        before = handle();
        sum += i >= late ? speed * speed : 0.0;
    }
    return {std::sqrt(sum / (ticks - late)), machine.reading_error({0.0, wall.rest}).value()};
}

/// The least dry friction with which it comes to rest wherever in a count that is, N, bisected
/// below `max`; NaN if that is not enough.
inline double least_friction(CountedWall c, double max, int halvings) {
    c.beside = 0.03;  // little, so that seconds are enough
    const double step = 2.0 * let_go(c, 0.01).reading_error;
    const auto rests = [&c, step](double friction) {
        c.friction = friction;
        for (int k = 0; k < 8; ++k) {
            c.shift = step * k / 8;
            if (let_go(c, 2.5).speed > 1e-9) {
                return false;
            }
        }
        return true;
    };
    if (!rests(max)) {
        return std::nan("");
    }
    double low = 0.0;
    double high = max;
    for (int i = 0; i < halvings; ++i) {
        const double middle = 0.5 * (low + high);
        (rests(middle) ? high : low) = middle;
    }
    return high;
}

}  // namespace palpate::tests
