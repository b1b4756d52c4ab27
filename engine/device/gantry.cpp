#include "engine/device/gantry.hpp"

#include <cmath>

namespace palpate::engine {
namespace {

constexpr double kSteps = 1e7;  ///< of a recorded HIP in a metre

}  // namespace

Gantry::Gantry(const GantrySpec& spec) : spec_(spec) {
    check(spec);
    for (int i = 0; i < 3; ++i) {
        const StraightAxis& axis = spec_.axes[static_cast<std::size_t>(i)];
        quantum_[i] = axis.radius * axis.motor.count_angle();
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

Gantry::Drive Gantry::drive(const Vec3& force) const noexcept {
    Drive drive;
    double largest = 0.0;
    for (int i = 0; i < 3; ++i) {
        const StraightAxis& axis = spec_.axes[static_cast<std::size_t>(i)];
        drive.torque[i] = axis.radius * force[i];
        largest = std::fmax(largest, std::fabs(drive.torque[i]) / axis.motor.torque_limit);
    }
    if (largest > 1.0) {
        drive.torque /= largest;
        drive.saturated = true;
    }
    for (int i = 0; i < 3; ++i) {
        drive.load[i] = std::fabs(drive.torque[i]) /
                        spec_.axes[static_cast<std::size_t>(i)].motor.torque_forever;
    }
    return drive;
}

std::optional<double> Gantry::weakest_force(const Vec3& hip) const noexcept {
    if (!holds(hip)) {
        return std::nullopt;
    }
    double weakest = spec_.axes[0].motor.torque_limit / spec_.axes[0].radius;
    for (const StraightAxis& axis : spec_.axes) {
        weakest = std::fmin(weakest, axis.motor.torque_limit / axis.radius);
    }
    return weakest;
}

std::optional<double> Gantry::reading_error(const Vec3& hip) const noexcept {
    return holds(hip) ? std::optional(0.5 * glm::length(quantum_ + Vec3(1.0 / kSteps)))
                      : std::nullopt;
}

Vec3 Gantry::quantum() const noexcept {
    return quantum_;
}

}  // namespace palpate::engine
