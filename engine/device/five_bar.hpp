#pragma once

#include <array>
#include <optional>

#include "engine/geometry/vec.hpp"

namespace palpate::engine {

using JointAngles = std::array<double, 2>;  ///< of the two driven links, rad, anticlockwise from +x

/// 2 x 2, row major: [dx/dt1 dx/dt2; dy/dt1 dy/dt2], m/rad.
struct Jacobian {
    Vec2 row_x{};
    Vec2 row_y{};

    [[nodiscard]] Vec2 operator*(const Vec2& rates) const noexcept {
        return Vec2{glm::dot(row_x, rates), glm::dot(row_y, rates)};
    }
    /// J^T f: joint torques that hold the force f, N m.
    [[nodiscard]] Vec2 transposed(const Vec2& f) const noexcept {
        return row_x * f.x + row_y * f.y;
    }
    [[nodiscard]] double determinant() const noexcept { return cross(row_x, row_y); }
};

/// The planar five-bar linkage ("pantograph"): two driven links from pivots on the x axis, two free
/// links that meet at the handle. Frame: pivot 1 at the origin, pivot 2 at (base, 0), m.
/// Working mode: elbows out, handle on the side away from the base.
struct FiveBar {
    double driven_1 = 0.063;  ///< a1, m
    double driven_2 = 0.063;  ///< a4, m
    double free_1 = 0.075;    ///< a2, m
    double free_2 = 0.075;    ///< a3, m
    double base = 0.025;      ///< a5, m

    struct Pose {
        Vec2 elbow_1{};
        Vec2 elbow_2{};
        Vec2 handle{};
    };

    /// Handle = foot + h n, foot at (a2^2 - a3^2 + D^2) / 2D along the line of the elbows, D their
    /// distance. None where the free links cannot meet (or are stretched out: h = 0, singular).
    [[nodiscard]] std::optional<Pose> forward(const JointAngles& angles) const noexcept;

    /// Angles that bring the handle to `handle` in the working mode; none outside the reach.
    [[nodiscard]] std::optional<JointAngles> inverse(const Vec2& handle) const noexcept;

    /// By implicit differentiation of |P - A|^2 = a2^2 and |P - B|^2 = a3^2 (Campion, Wang & Hayward
    /// 2005, whose printed Jacobian lacks two signs). None at a singular pose.
    [[nodiscard]] std::optional<Jacobian> jacobian(const JointAngles& angles,
                                                   const Pose& pose) const noexcept;
};

}  // namespace palpate::engine
