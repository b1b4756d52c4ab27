#include "engine/device/five_bar.hpp"

namespace palpate::engine {
namespace {

/// |det| of the constraint matrix below this share of its scale counts as singular.
constexpr double kSingular = 1e-6;

/// Angle at a pivot between the driven link and the line to the handle, in (0, pi); none out of
/// reach. Its sine by Heron's formula, which keeps its digits where the links are nearly in line.
std::optional<double> elbow_angle(double driven, double free, double r) noexcept {
    const double area2 =
        (driven + free + r) * (driven + free - r) * (r + driven - free) * (r - driven + free);
    if (!(r > 0.0) || !(area2 > 0.0)) {
        return std::nullopt;
    }
    return arc_tan2(std::sqrt(area2), driven * driven + r * r - free * free);
}

double in_line(double driven, double free, double r) noexcept {
    return std::min(driven + free - r, r - std::fabs(driven - free));
}

/// x with [u; w] x = right, for inverse = 1 / cross(u, w).
Vec2 solved(const Vec2& u, const Vec2& w, double inverse, const Vec2& right) noexcept {
    return inverse * Vec2{w.y * right.x - u.y * right.y, u.x * right.y - w.x * right.x};
}

}  // namespace

SingularValues singular_values(const Jacobian& matrix) noexcept {
    const double a = matrix.row_x.x + matrix.row_y.y;
    const double b = matrix.row_x.x - matrix.row_y.y;
    const double c = matrix.row_y.x + matrix.row_x.y;
    const double d = matrix.row_y.x - matrix.row_x.y;
    const double sum = std::sqrt(a * a + d * d);
    const double difference = std::sqrt(b * b + c * c);
    return {.largest = 0.5 * (sum + difference), .smallest = 0.5 * std::fabs(sum - difference)};
}

double Clearance::min() const noexcept {
    return std::min(std::min(serial_1, serial_2), parallel);
}

std::optional<FiveBar::Pose> FiveBar::forward(const JointAngles& angles) const noexcept {
    const auto [t1, t2] = sin_cos(angles[0], angles[1]);
    const Vec2 elbow_1 = elbow_1_at(t1);
    const Vec2 elbow_2 = elbow_2_at(t2);
    const Vec2 handle = handle_over(elbow_1, elbow_2);
    if (std::isnan(handle.x)) {
        return std::nullopt;
    }
    return Pose{.elbow_1 = elbow_1, .elbow_2 = elbow_2, .handle = handle};
}

std::optional<JointAngles> FiveBar::inverse(const Vec2& handle) const noexcept {
    const Vec2 from_2 = handle - Vec2{base, 0.0};
    const auto bend_1 = elbow_angle(driven_1, free_1, glm::length(handle));
    const auto bend_2 = elbow_angle(driven_2, free_2, glm::length(from_2));
    if (!bend_1 || !bend_2) {
        return std::nullopt;
    }
    const JointAngles angles{
        arc_tan2(handle.y, handle.x) + (mode.elbow_1_left ? *bend_1 : -*bend_1),
        arc_tan2(from_2.y, from_2.x) + (mode.elbow_2_left ? *bend_2 : -*bend_2)};
    const auto [t1, t2] = sin_cos(angles[0], angles[1]);
    const Vec2 elbow_1 = elbow_1_at(t1);
    const Vec2 elbow_2 = elbow_2_at(t2);
    const double side = cross(elbow_2 - elbow_1, handle - elbow_1);
    if (!(mode.handle_left ? side > 0.0 : side < 0.0)) {
        return std::nullopt;
    }
    return angles;
}

WorkingMode FiveBar::mode_of(const Pose& pose) const noexcept {
    const Vec2 pivot_2{base, 0.0};
    return {.elbow_1_left = cross(pose.handle, pose.elbow_1) > 0.0,
            .elbow_2_left = cross(pose.handle - pivot_2, pose.elbow_2 - pivot_2) > 0.0,
            .handle_left = cross(pose.elbow_2 - pose.elbow_1, pose.handle - pose.elbow_1) > 0.0};
}

Clearance FiveBar::clearance(const Pose& pose) const noexcept {
    const WorkingMode is = mode_of(pose);
    const Vec2 between = pose.elbow_2 - pose.elbow_1;
    const double width = glm::length(between);
    const double reach_1 = in_line(driven_1, free_1, glm::length(pose.handle));
    const double reach_2 = in_line(driven_2, free_2, glm::length(pose.handle - Vec2{base, 0.0}));
    const double height =
        width > 0.0 ? std::fabs(cross(between, pose.handle - pose.elbow_1)) / width : 0.0;
    const double parallel = std::min(height, width);
    return {.serial_1 = is.elbow_1_left == mode.elbow_1_left ? reach_1 : -reach_1,
            .serial_2 = is.elbow_2_left == mode.elbow_2_left ? reach_2 : -reach_2,
            .parallel = is.handle_left == mode.handle_left ? parallel : -parallel};
}

std::optional<Jacobian> FiveBar::jacobian(const Pose& pose) const noexcept {
    const Vec2 u = pose.handle - pose.elbow_1;
    const Vec2 w = pose.handle - pose.elbow_2;
    const double det = cross(u, w);
    if (!(std::fabs(det) > kSingular * free_1 * free_2)) {
        return std::nullopt;
    }
    // [u; w] dP = [u . A' dt1; w . B' dt2], A' = A turned by 90 degrees
    const double drive_1 = glm::dot(u, perp(pose.elbow_1));
    const double drive_2 = glm::dot(w, perp(pose.elbow_2 - Vec2{base, 0.0}));
    const double inverse = 1.0 / det;
    const Vec2 column_1 = solved(u, w, inverse, {drive_1, 0.0});
    const Vec2 column_2 = solved(u, w, inverse, {0.0, drive_2});
    return Jacobian{.row_x = {column_1.x, column_2.x}, .row_y = {column_1.y, column_2.y}};
}

Jacobian FiveBar::drift(const Pose& pose,
                        const Jacobian& jacobian,
                        const Vec2& rates) const noexcept {
    // u . P'' + |P' - A'|^2 = u . A'' with A'' = -A t1'^2; w and B alike.
    const Vec2 arm_1 = pose.elbow_1;
    const Vec2 arm_2 = pose.elbow_2 - Vec2{base, 0.0};
    const Vec2 u = pose.handle - pose.elbow_1;
    const Vec2 w = pose.handle - pose.elbow_2;
    const double inverse = 1.0 / cross(u, w);
    const Vec2 by_1 = jacobian.column_1();
    const Vec2 by_2 = jacobian.column_2();
    const Vec2 speed = jacobian * rates;
    const Vec2 past_1 = speed - rates.x * perp(arm_1);
    const Vec2 past_2 = speed - rates.y * perp(arm_2);
    const Vec2 column_1 =
        solved(u, w, inverse,
               {-rates.x * glm::dot(u, arm_1) - glm::dot(past_1, by_1 - perp(arm_1)),
                -glm::dot(past_2, by_1)});
    const Vec2 column_2 =
        solved(u, w, inverse,
               {-glm::dot(past_1, by_2),
                -rates.y * glm::dot(w, arm_2) - glm::dot(past_2, by_2 - perp(arm_2))});
    return {.row_x = {column_1.x, column_2.x}, .row_y = {column_1.y, column_2.y}};
}

}  // namespace palpate::engine
