#include "engine/device/five_bar.hpp"

#include <cmath>

#include "engine/math/elementary.hpp"

namespace palpate::engine {
namespace {

/// |det| of the constraint matrix below this share of its scale counts as singular.
constexpr double kSingular = 1e-6;

/// Angle at a pivot between the driven link and the line to the handle; none out of reach.
std::optional<double> elbow_angle(double driven, double free, double distance) noexcept {
    if (!(distance > 0.0)) {
        return std::nullopt;
    }
    const double c =
        (driven * driven + distance * distance - free * free) / (2.0 * driven * distance);
    if (!(std::fabs(c) < 1.0)) {
        return std::nullopt;
    }
    return arc_cos(c);
}

}  // namespace

std::optional<FiveBar::Pose> FiveBar::forward(const JointAngles& angles) const noexcept {
    const SinCos t1 = sin_cos(angles[0]);
    const SinCos t2 = sin_cos(angles[1]);
    Pose pose;
    pose.elbow_1 = Vec2{driven_1 * t1.cos, driven_1 * t1.sin};
    pose.elbow_2 = Vec2{base + driven_2 * t2.cos, driven_2 * t2.sin};
    const Vec2 between = pose.elbow_2 - pose.elbow_1;
    const double d2 = glm::dot(between, between);
    if (!(d2 > 0.0)) {
        return std::nullopt;
    }
    const double along = (free_1 * free_1 - free_2 * free_2 + d2) / (2.0 * d2);  // share of D
    const double h2 = free_1 * free_1 - along * along * d2;
    if (!(h2 > 0.0)) {
        return std::nullopt;
    }
    pose.handle = pose.elbow_1 + along * between + std::sqrt(h2 / d2) * perp(between);
    return pose;
}

std::optional<JointAngles> FiveBar::inverse(const Vec2& handle) const noexcept {
    const Vec2 from_2 = handle - Vec2{base, 0.0};
    const auto elbow_1 = elbow_angle(driven_1, free_1, glm::length(handle));
    const auto elbow_2 = elbow_angle(driven_2, free_2, glm::length(from_2));
    if (!elbow_1 || !elbow_2) {
        return std::nullopt;
    }
    return JointAngles{arc_tan2(handle.y, handle.x) + *elbow_1,
                       arc_tan2(from_2.y, from_2.x) - *elbow_2};
}

std::optional<Jacobian> FiveBar::jacobian(const JointAngles& angles,
                                          const Pose& pose) const noexcept {
    const SinCos t1 = sin_cos(angles[0]);
    const SinCos t2 = sin_cos(angles[1]);
    const Vec2 u = pose.handle - pose.elbow_1;
    const Vec2 w = pose.handle - pose.elbow_2;
    const double det = cross(u, w);
    if (!(std::fabs(det) > kSingular * free_1 * free_2)) {
        return std::nullopt;
    }
    // [u; w] dP = [u . A' dt1; w . B' dt2]
    const double drive_1 = driven_1 * (-u.x * t1.sin + u.y * t1.cos);
    const double drive_2 = driven_2 * (-w.x * t2.sin + w.y * t2.cos);
    Jacobian j;
    j.row_x = Vec2{w.y * drive_1, -u.y * drive_2} / det;
    j.row_y = Vec2{-w.x * drive_1, u.x * drive_2} / det;
    return j;
}

}  // namespace palpate::engine
