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

Vec2 vec(Pair p) noexcept {
    return Vec2{p[0], p[1]};
}

/// The links of a pose, of both chains side by side: in each Pair what is of chain 1, then of 2.
struct Chains {
    Pair x;  ///< of the free links, from elbow to handle
    Pair y;
    Pair arm_x;  ///< of the driven ones
    Pair arm_y;

    Chains(const FiveBar::Pose& pose, double base) noexcept {
        const Vec2 u = pose.handle - pose.elbow_1;
        const Vec2 w = pose.handle - pose.elbow_2;
        x = Pair{u.x, w.x};
        y = Pair{u.y, w.y};
        arm_x = Pair{pose.elbow_1.x, pose.elbow_2.x - base};
        arm_y = Pair{pose.elbow_1.y, pose.elbow_2.y};
    }
    /// det [u; w], u and w the free links.
    [[nodiscard]] double det() const noexcept { return cross(Pair{x[0], y[0]}, Pair{x[1], y[1]}); }
    /// X with [u; w] X = [right_1; right_2], for inverse = 1 / det().
    [[nodiscard]] Jacobian solved(double inverse, Pair right_1, Pair right_2) const noexcept {
        return {.row_x = vec(inverse * (y[1] * right_1 - y[0] * right_2)),
                .row_y = vec(inverse * (x[0] * right_2 - x[1] * right_1))};
    }
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
    const Chains chains(pose, base);
    const double det = chains.det();
    if (!(std::fabs(det) > kSingular * free_1 * free_2)) {
        return std::nullopt;
    }
    // [u; w] dP = [u . A' dt1; w . B' dt2], A' = A turned by 90 degrees
    const Pair drive = chains.x * -chains.arm_y + chains.y * chains.arm_x;
    return chains.solved(1.0 / det, Pair{drive[0], 0.0}, Pair{0.0, drive[1]});
}

Jacobian FiveBar::drift(const Pose& pose,
                        const Jacobian& jacobian,
                        const Vec2& rates) const noexcept {
    // u . P'' + |P' - A'|^2 = u . A'' with A'' = -A t1'^2; w and B alike.
    const Chains chains(pose, base);
    const Pair by_x = pair(jacobian.row_x);
    const Pair by_y = pair(jacobian.row_y);
    const Pair turns = pair(rates);
    const Vec2 speed = jacobian * rates;
    const Pair past_x = speed.x - turns * -chains.arm_y;
    const Pair past_y = speed.y - turns * chains.arm_x;
    const Pair own = -turns * (chains.x * chains.arm_x + chains.y * chains.arm_y) -
                     (past_x * (by_x - -chains.arm_y) + past_y * (by_y - chains.arm_x));
    const Pair other = -(Pair{past_x[1], past_x[0]} * by_x + Pair{past_y[1], past_y[0]} * by_y);
    return chains.solved(1.0 / chains.det(), Pair{own[0], other[1]}, Pair{other[0], own[1]});
}

}  // namespace palpate::engine
