#include "engine/device/pantograph.hpp"

#include <cmath>
#include <limits>

namespace palpate::engine {
namespace {

std::int32_t rounded(double value) noexcept {
    constexpr double kMax = std::numeric_limits<std::int32_t>::max();
    const double whole = std::floor(value + 0.5);
    if (!(std::fabs(whole) <= kMax)) {
        return whole > kMax  ? std::numeric_limits<std::int32_t>::max()
             : whole < -kMax ? -std::numeric_limits<std::int32_t>::max()
                             : 0;
    }
    return static_cast<std::int32_t>(whole);
}

}  // namespace

MotorDrive within_limits(const Vec3& torque, const Vec3& limit, const Vec3& forever) noexcept {
    MotorDrive drive{.torque = torque};
    double largest = 0.0;
    for (int i = 0; i < 3; ++i) {
        largest = std::fmax(largest, std::fabs(torque[i]) / limit[i]);
    }
    if (largest > 1.0) {
        drive.torque /= largest;
        drive.saturated = true;
    }
    for (int i = 0; i < 3; ++i) {
        drive.load[i] = std::fabs(drive.torque[i]) / forever[i];
    }
    return drive;
}

Pantograph::Pantograph(const PantographSpec& spec) : spec_(spec), frame_(spec.origin, spec.turn) {
    check(spec);
}

JointAngles Pantograph::angles(const Counts& counts) const noexcept {
    JointAngles angles{};
    for (std::size_t i = 0; i < 2; ++i) {
        const Axis& axis = spec_.axes[i];
        angles[i] = axis.zero + counts[i] * axis.count_angle();
    }
    return angles;
}

Pantograph::Counts Pantograph::counts(const JointAngles& angles) const noexcept {
    Counts counts{};
    for (std::size_t i = 0; i < 2; ++i) {
        const Axis& axis = spec_.axes[i];
        counts[i] = rounded((angles[i] - axis.zero) / kTurn * axis.counts_per_turn);
    }
    return counts;
}

std::optional<Pantograph::Fix> Pantograph::locate(const JointAngles& angles) const noexcept {
    const auto pose = spec_.linkage.forward(angles);
    if (!pose) {
        return std::nullopt;
    }
    const double clearance = spec_.linkage.clearance(*pose).min();
    const auto jacobian = spec_.linkage.jacobian(*pose);
    if (!(clearance >= spec_.clearance) || !jacobian) {
        return std::nullopt;
    }
    const Vec2 by_1 = frame_.to_object(jacobian->column_1());
    const Vec2 by_2 = frame_.to_object(jacobian->column_2());
    return Fix{.hip = frame_.point_to_object(pose->handle),
               .jacobian = {.row_x = {by_1.x, by_2.x}, .row_y = {by_1.y, by_2.y}},
               .clearance = clearance};
}

std::optional<JointAngles> Pantograph::reach(const Vec2& hip) const noexcept {
    auto angles = spec_.linkage.inverse(frame_.point_to_linkage(hip));
    if (!angles || !locate(*angles)) {
        return std::nullopt;
    }
    for (std::size_t i = 0; i < 2; ++i) {
        double& angle = (*angles)[i];
        angle -= kTurn * std::floor((angle - spec_.axes[i].zero) / kTurn + 0.5);
    }
    return angles;
}

MotorDrive Pantograph::drive(const Fix& fix, const Vec2& force) const noexcept {
    const auto& [one, two] = spec_.axes;
    return within_limits(Vec3(fix.jacobian.transposed(force), 0.0),
                         Vec3(one.torque_limit, two.torque_limit, 1.0),
                         Vec3(one.torque_forever, two.torque_forever, 1.0));
}

std::optional<double> Pantograph::weakest_force(const Vec2& hip) const noexcept {
    const auto angles = reach(hip);
    const auto fix = angles ? locate(*angles) : std::nullopt;
    if (!fix) {
        return std::nullopt;
    }
    return std::fmin(spec_.axes[0].torque_limit / glm::length(fix->jacobian.column_1()),
                     spec_.axes[1].torque_limit / glm::length(fix->jacobian.column_2()));
}

/// Both encoders half a count off: 1 / sqrt(2) counts of the worst mix.
std::optional<double> Pantograph::reading_error(const Vec2& hip) const noexcept {
    const auto angles = reach(hip);
    const auto fix = angles ? locate(*angles) : std::nullopt;
    return fix ? std::optional<double>(std::sqrt(0.5) * quantum(*fix).largest) : std::nullopt;
}

SingularValues Pantograph::quantum(const Fix& fix) const noexcept {
    const Vec2 count{kTurn / spec_.axes[0].counts_per_turn, kTurn / spec_.axes[1].counts_per_turn};
    return singular_values(
        {.row_x = fix.jacobian.row_x * count, .row_y = fix.jacobian.row_y * count});
}

}  // namespace palpate::engine
