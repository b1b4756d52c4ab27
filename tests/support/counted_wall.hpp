#pragma once

#include "engine/device/simulated_pantograph.hpp"
#include "tests/support/std.hpp"

/// A mass with a damper on a sampled, held spring: the textbook's virtual wall, without a linkage.
namespace palpate::tests {

struct SampledWall {
    double mass = 0.15;            ///< m, kg
    double damping = 0.5;          ///< b, N s/m, physical
    double period = 1e-3;          ///< T, s
    double virtual_damping = 0.0;  ///< B, N s/m, on the backward difference of the position
    int delay = 0;                 ///< ticks from a reading to its force, 0 or 1
};

/// b > K T (1/2 + delay) + |B| solved for K: the passivity bound of Colgate & Schenkel (1997) and
/// what a delay adds to it.
inline double passive_stiffness(const SampledWall& wall) {
    return (wall.damping - std::fabs(wall.virtual_damping)) / (wall.period * (0.5 + wall.delay));
}

/// All roots of the polynomial c[0] + c[1] z + ... + c[n] z^n inside the unit circle: the recursion
/// of Schur and Cohn.
template <std::size_t N>
bool schur_stable(std::array<double, N> c) {
    for (std::size_t n = N - 1; n >= 1; --n) {
        if (!(std::fabs(c[0]) < std::fabs(c[n]))) {
            return false;
        }
        std::array<double, N> next{};
        for (std::size_t i = 0; i < n; ++i) {
            next[i] = c[n] * c[i + 1] - c[0] * c[n - 1 - i];
        }
        c = next;
    }
    return true;
}

/// The closed loop's polynomial, from the exact zero-order-hold equivalent of 1 / (m s^2 + b s) and
/// the force -(K + B (1 - 1/z) / T) x / z^delay.
inline bool exactly_stable(const SampledWall& wall, double stiffness) {
    const double rate = wall.damping / wall.mass;
    const double left = std::exp(-rate * wall.period);
    const double gone = -std::expm1(-rate * wall.period) / rate;
    const double later = (wall.period - gone) / wall.damping;          // of z
    const double sooner = (gone - left * wall.period) / wall.damping;  // of 1
    const double now = stiffness + wall.virtual_damping / wall.period;
    const double before = -wall.virtual_damping / wall.period;
    // (z - 1)(z - left) z^(delay + 1) + (later z + sooner)(now z + before)
    std::array<double, 5> c{};
    const auto power = static_cast<std::size_t>(wall.delay) + 1U;
    c[power] += left;
    c[power + 1] -= 1.0 + left;
    c[power + 2] += 1.0;
    c[0] += sooner * before;
    c[1] += later * before + sooner * now;
    c[2] += later * now;
    return wall.delay == 1 ? schur_stable(c)
                           : schur_stable(std::array<double, 4>{c[0], c[1], c[2], c[3]});
}

/// Up to where `stable` holds, bisected between `low` and `high`; NaN if it is not between them.
template <class Stable>
double stability_limit(double low, double high, int halvings, Stable&& stable) {
    if (!stable(low) || stable(high)) {
        return std::nan("");
    }
    for (int i = 0; i < halvings; ++i) {
        const double middle = 0.5 * (low + high);
        (stable(middle) ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

/// The stiffness at which the sampled wall starts to swing up by itself, N/m: exact.
inline double exact_stiffness(const SampledWall& wall) {
    const double guess = wall.damping / wall.period;
    return stability_limit(0.5 * guess, 10.0 * guess, 60,
                           [&](double k) { return exactly_stable(wall, k); });
}

/// Growth a tick, ln r, of an oscillation x_k = r^k cos(...), read off its samples: x_k x_(k+2s) -
/// x_(k+s)^2 is multiplied by r^2 each tick, whatever phase and stride s. The sum over a window
/// late in the path over that of one early in it, so that rounded samples do no harm.
inline double growth_of(const std::vector<double>& x, std::size_t stride) {
    const std::size_t settle = x.size() / 10;  // the fast roots have died away
    const std::size_t window = x.size() / 4;
    const auto sum_from = [&](std::size_t first) {
        double sum = 0.0;
        for (std::size_t k = first; k < first + window; ++k) {
            sum += x[k] * x[k + 2 * stride] - x[k + stride] * x[k + stride];
        }
        return sum;
    };
    const std::size_t late = x.size() - window - 2 * stride;
    return 0.5 * std::log(sum_from(late) / sum_from(settle)) / static_cast<double>(late - settle);
}

/// Ticks of a quarter of a swing: the stride at which growth_of is surest.
inline std::size_t quarter_swing(const SampledWall& wall, double stiffness) {
    const double ticks = 1.5707963 / (std::sqrt(stiffness / wall.mass) * wall.period);
    return static_cast<std::size_t>(std::fmax(1.0, std::round(ticks)));
}

/// The same wall, stepped: mass and damper exact over each tick.
inline double stepped_growth(const SampledWall& wall, double stiffness, int ticks) {
    const double rate = wall.damping / wall.mass;
    const double left = std::exp(-rate * wall.period);
    const double gone = -std::expm1(-rate * wall.period) / rate;
    double x = 1.0;
    double v = 0.0;
    double previous = x;
    double waiting = 0.0;
    std::vector<double> path;
    for (int i = 0; i < ticks; ++i) {
        path.push_back(x);
        const double now = -stiffness * x - wall.virtual_damping * (x - previous) / wall.period;
        const double force = wall.delay == 1 ? waiting : now;
        waiting = now;
        previous = x;
        const double goal = force / wall.damping;  // speed that the force would bring at last
        x += goal * wall.period + (v - goal) * gone;
        v = goal + (v - goal) * left;
    }
    return growth_of(path, quarter_swing(wall, stiffness));
}

// The simulated pantograph on a virtual wall, at its symmetric pose: there x and y decouple, and
// the whole linkage is one mass with one damper.

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
    return stability_limit(0.9 * guess, 1.1 * guess, halvings,
                           [&](double k) { return device_growth(wall, k, ticks) < 0.0; });
}

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
        const Vec2 torque(machine.drive(*read, force).torque);
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
