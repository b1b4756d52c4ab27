#include "engine/device/five_bar.hpp"

#include "engine/geometry/pair.hpp"

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

/// Both links at once: a Pair has what is of link 1 and of link 2.
struct Links {
    Links(const FiveBar& of, const FiveBar::Pose& pose) noexcept
        : x(pose.handle.x - Pair{pose.elbow_1.x, pose.elbow_2.x}),
          y(pose.handle.y - Pair{pose.elbow_1.y, pose.elbow_2.y}),
          arm_x{pose.elbow_1.x, pose.elbow_2.x - of.base},
          arm_y{pose.elbow_1.y, pose.elbow_2.y},
          det(x[0] * y[1] - y[0] * x[1]) {}

    /// Two columns v, each with [u; w] v = right, u and w the free links.
    /// @param top, low  both columns' right.x, and right.y
    [[nodiscard]] Jacobian solved(Pair top, Pair low) const noexcept {
        const double inverse = 1.0 / det;
        Jacobian columns;
        put(inverse * (y[1] * top - y[0] * low), columns.row_x);
        put(inverse * (x[0] * low - x[1] * top), columns.row_y);
        return columns;
    }

    Pair x;  ///< of u and w, from the elbows to the handle
    Pair y;
    Pair arm_x;  ///< of the driven links A and B
    Pair arm_y;
    double det;  ///< u x w
};

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
    const Links links(*this, pose);
    if (!(std::fabs(links.det) > kSingular * free_1 * free_2)) {
        return std::nullopt;
    }
    // [u; w] dP = [u . A' dt1; w . B' dt2], A' = A turned by 90 degrees
    const Pair drive = links.x * -links.arm_y + links.y * links.arm_x;
    return links.solved(Pair{drive[0], 0.0}, Pair{0.0, drive[1]});
}

Jacobian FiveBar::drift(const Pose& pose,
                        const Jacobian& jacobian,
                        const Vec2& rates) const noexcept {
    // u . P'' + |P' - A'|^2 = u . A'' with A'' = -A t1'^2; w and B alike.
    const Links links(*this, pose);
    const auto& [x, y, arm_x, arm_y, det] = links;
    const Pair by_x = pair(jacobian.row_x);
    const Pair by_y = pair(jacobian.row_y);
    const Pair turns = pair(rates);
    const Vec2 speed = jacobian * rates;
    const Pair past_x = speed.x - turns * -arm_y;
    const Pair past_y = speed.y - turns * arm_x;
    const Pair own =
        -turns * (x * arm_x + y * arm_y) - (past_x * (by_x + arm_y) + past_y * (by_y - arm_x));
    const Pair other = -(past_x * Pair{by_x[1], by_x[0]} + past_y * Pair{by_y[1], by_y[0]});
    return links.solved(Pair{own[0], other[0]}, Pair{other[1], own[1]});
}

}  // namespace palpate::engine
