#include "engine/device/pantograph.hpp"

#include <cmath>

#include "engine/math/elementary.hpp"

namespace palpate::engine {
namespace {

/// `v` of the linkage's frame, in a frame turned by `s`.
Vec2 into(const SinCos& s, const Vec2& v) noexcept {
    return {s.cos * v.x + s.sin * v.y, s.cos * v.y - s.sin * v.x};
}

Vec2 out_of(const SinCos& s, const Vec2& v) noexcept {
    return {s.cos * v.x - s.sin * v.y, s.sin * v.x + s.cos * v.y};
}

}  // namespace

JointAngles Pantograph::angles(const Counts& counts) const noexcept {
    JointAngles angles{};
    for (std::size_t i = 0; i < 2; ++i) {
        const Axis& axis = spec_.axes[i];
        angles[i] = axis.zero + counts[i] * (2.0 * kPi / axis.counts_per_turn);
    }
    return angles;
}

Pantograph::Counts Pantograph::counts(const JointAngles& angles) const noexcept {
    Counts counts{};
    for (std::size_t i = 0; i < 2; ++i) {
        const Axis& axis = spec_.axes[i];
        const double turns = (angles[i] - axis.zero) / (2.0 * kPi);
        counts[i] = static_cast<std::int32_t>(std::floor(turns * axis.counts_per_turn + 0.5));
    }
    return counts;
}

std::optional<Pantograph::Fix> Pantograph::locate(const JointAngles& angles) const noexcept {
    const auto pose = spec_.linkage.forward(angles);
    const auto jacobian = pose ? spec_.linkage.jacobian(angles, *pose) : std::nullopt;
    if (!jacobian) {
        return std::nullopt;
    }
    const SinCos turn = sin_cos(spec_.turn);
    const Vec2 by_1 = into(turn, Vec2{jacobian->row_x.x, jacobian->row_y.x});
    const Vec2 by_2 = into(turn, Vec2{jacobian->row_x.y, jacobian->row_y.y});
    return Fix{.hip = into(turn, pose->handle - spec_.origin),
               .jacobian = {.row_x = {by_1.x, by_2.x}, .row_y = {by_1.y, by_2.y}}};
}

std::optional<JointAngles> Pantograph::reach(const Vec2& hip) const noexcept {
    return spec_.linkage.inverse(spec_.origin + out_of(sin_cos(spec_.turn), hip));
}

Pantograph::Drive Pantograph::drive(const Fix& fix, const Vec2& force) const noexcept {
    Drive drive;
    drive.torque = fix.jacobian.transposed(force);
    const auto& [one, two] = spec_.axes;
    const double most = std::fmax(std::fabs(drive.torque.x) / one.torque_limit,
                                  std::fabs(drive.torque.y) / two.torque_limit);
    if (most > 1.0) {  // both scaled alike: the force keeps its direction
        drive.torque /= most;
        drive.saturated = true;
    }
    drive.load = {std::fabs(drive.torque.x) / one.torque_forever,
                  std::fabs(drive.torque.y) / two.torque_forever};
    return drive;
}

std::optional<double> Pantograph::weakest_force(const Vec2& hip) const noexcept {
    const auto angles = reach(hip);
    const auto fix = angles ? locate(*angles) : std::nullopt;
    if (!fix) {
        return std::nullopt;
    }
    const Jacobian& j = fix->jacobian;
    const double gain_1 = glm::length(Vec2{j.row_x.x, j.row_y.x});
    const double gain_2 = glm::length(Vec2{j.row_x.y, j.row_y.y});
    return std::fmin(spec_.axes[0].torque_limit / gain_1, spec_.axes[1].torque_limit / gain_2);
}

}  // namespace palpate::engine
