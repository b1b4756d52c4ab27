#include "engine/device/machine.hpp"

#include <cmath>
#include <stdexcept>

#include "engine/base/text.hpp"

namespace palpate::engine {
namespace {

constexpr double kSteps = 1e7;  ///< of a recorded HIP in a metre

std::variant<Pantograph, Gantry> parts_of(const Calibration& calibration) {
    if (calibration.gantry) {
        return Gantry(*calibration.gantry);
    }
    return Pantograph(calibration.pantograph);
}

Machine::Counts home_counts(const Calibration& calibration) {
    if (calibration.gantry || !calibration.home) {
        return {};
    }
    const Pantograph pantograph(calibration.pantograph);
    const auto angles = pantograph.reach(*calibration.home);
    if (!angles || !pantograph.locate(*angles)) {
        throw std::invalid_argument(
            "the linkage of " + calibration.pantograph.name + " does not reach its home pose (" +
            number_text(1e3 * calibration.home->x) + ", " + number_text(1e3 * calibration.home->y) +
            ") mm: correct home, the link lengths or the origin");
    }
    return pantograph.counts(*angles);
}

}  // namespace

Gantry::Gantry(const GantrySpec& spec) : spec_(spec) {
    check(spec);
    for (int i = 0; i < 3; ++i) {
        const StraightAxis& axis = spec_.axes[static_cast<std::size_t>(i)];
        quantum_[i] = axis.radius * axis.motor.count_angle();
        radius_[i] = axis.radius;
        limit_[i] = axis.motor.torque_limit;
        forever_[i] = axis.motor.torque_forever;
    }
}

bool Gantry::holds(const Vec3& hip) const noexcept {
    for (int i = 0; i < 3; ++i) {
        const StraightAxis& axis = spec_.axes[static_cast<std::size_t>(i)];
        if (!(hip[i] >= axis.low && hip[i] <= axis.high)) {
            return false;
        }
    }
    return true;
}

std::optional<Vec3> Gantry::locate(const Counts& counts) const noexcept {
    Vec3 hip = spec_.home();
    for (int i = 0; i < 3; ++i) {
        hip[i] += quantum_[i] * counts[static_cast<std::size_t>(i)];
        hip[i] = std::floor(hip[i] * kSteps + 0.5) / kSteps;
    }
    return holds(hip) ? std::optional(hip) : std::nullopt;
}

std::optional<double> Gantry::weakest_force(const Vec3& hip) const noexcept {
    if (!holds(hip)) {
        return std::nullopt;
    }
    const Vec3 max = limit_ / radius_;
    return std::fmin(max.x, std::fmin(max.y, max.z));
}

std::optional<double> Gantry::reading_error(const Vec3& hip) const noexcept {
    return holds(hip) ? std::optional(0.5 * glm::length(quantum_ + Vec3(1.0 / kSteps)))
                      : std::nullopt;
}

Machine::Machine(const Calibration& calibration)
    : calibration_(calibration), parts_(parts_of(calibration)), home_(home_counts(calibration)) {}

std::optional<Machine::Place> Machine::locate(const Counts& counts) const noexcept {
    if (const auto* gantry = std::get_if<Gantry>(&parts_)) {
        const auto hip = gantry->locate(counts);
        return hip ? std::optional(Place{.hip = *hip}) : std::nullopt;
    }
    const auto* pantograph = std::get_if<Pantograph>(&parts_);
    const auto fix = pantograph->locate(pantograph->angles(counts));
    return fix ? std::optional(Place{.hip = Vec3(fix->hip, 0.0), .fix = *fix}) : std::nullopt;
}

MotorDrive Machine::drive(const Place& place, const Vec3& force) const noexcept {
    const auto* gantry = std::get_if<Gantry>(&parts_);
    return gantry != nullptr ? gantry->drive(force)
                             : std::get_if<Pantograph>(&parts_)->drive(place.fix, Vec2(force));
}

std::optional<double> Machine::weakest_force(const Vec3& hip) const noexcept {
    const auto* gantry = std::get_if<Gantry>(&parts_);
    return gantry != nullptr ? gantry->weakest_force(hip)
                             : std::get_if<Pantograph>(&parts_)->weakest_force(Vec2(hip));
}

std::optional<double> Machine::reading_error(const Vec3& hip) const noexcept {
    const auto* gantry = std::get_if<Gantry>(&parts_);
    return gantry != nullptr ? gantry->reading_error(hip)
                             : std::get_if<Pantograph>(&parts_)->reading_error(Vec2(hip));
}

bool starts_at_home(const Calibration& calibration) {
    return calibration.home || calibration.haply || calibration.board;
}

Vec3 home_of(const Calibration& calibration) {
    if (calibration.gantry) {
        return calibration.gantry->home();
    }
    if (calibration.home) {
        return {*calibration.home, 0.0};
    }
    const Pantograph machine(calibration.pantograph);
    const auto fix =
        starts_at_home(calibration) ? machine.locate(machine.angles({0, 0})) : std::nullopt;
    return {fix ? fix->hip : Vec2{0.0, 0.020}, 0.0};
}

std::string place_text(const Vec3& place, std::size_t axes) {
    const auto text = [](double metres) {
        return number_text(std::round(metres * 1e4) / 10.0 + 0.0);
    };
    std::string said(1, '(');
    said.append(text(place.x)).append(", ").append(text(place.y));
    if (axes > 2) {
        said.append(", ").append(text(place.z));
    }
    return said.append(") mm");
}

}  // namespace palpate::engine
