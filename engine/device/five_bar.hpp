#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "engine/geometry/vec.hpp"
#include "engine/math/elementary.hpp"

namespace palpate::engine {

using JointAngles = std::array<double, 2>;  ///< of the two driven links, rad, anticlockwise from +x

/// 2 x 2, row major: [dx/dt1 dx/dt2; dy/dt1 dy/dt2], m/rad.
struct Jacobian {
    Vec2 row_x{};
    Vec2 row_y{};

    /// J w: velocity of the handle, m/s. @param rates  of the joints, rad/s
    [[nodiscard]] Vec2 operator*(const Vec2& rates) const noexcept {
        return Vec2{glm::dot(row_x, rates), glm::dot(row_y, rates)};
    }
    /// J^T f: joint torques that hold the force f, N m.
    [[nodiscard]] Vec2 transposed(const Vec2& f) const noexcept {
        return row_x * f.x + row_y * f.y;
    }
    /// What joint 1, or 2, does to the handle, m/rad.
    [[nodiscard]] Vec2 column_1() const noexcept { return Vec2{row_x.x, row_y.x}; }
    [[nodiscard]] Vec2 column_2() const noexcept { return Vec2{row_x.y, row_y.y}; }
    /// Its determinant, m^2/rad^2: 0 in a singular pose.
    [[nodiscard]] double determinant() const noexcept { return cross(row_x, row_y); }
};

/// Largest and smallest singular value of a 2 x 2 matrix.
struct SingularValues {
    double largest = 0.0;
    double smallest = 0.0;
};
/// Both singular values of `matrix`, m/rad, >= 0.
[[nodiscard]] SingularValues singular_values(const Jacobian& matrix) noexcept;

/// Which of the poses of a linkage it is in. Four pairs of elbows bring the handle to one place,
/// and two places of the handle go with one pair of driven links; singular poses lie between them.
struct WorkingMode {
    bool elbow_1_left = true;   ///< of the line from pivot 1 to the handle
    bool elbow_2_left = false;  ///< of the line from pivot 2 to the handle
    bool handle_left = true;    ///< of the line from elbow 1 to elbow 2

    friend bool operator==(const WorkingMode&, const WorkingMode&) = default;
};

/// How far a pose is from the singular ones, m. Positive inside the working mode, 0 at a singular
/// pose, negative beyond it.
struct Clearance {
    /// By which the handle may move towards the place where driven and free link lie in line,
    /// before it is there: the less of l + L - r and r - |l - L|, r from the pivot to the handle.
    /// Exact. There the motor moves the handle no more along that line.
    double serial_1 = 0.0;
    double serial_2 = 0.0;
    /// The less of h, from the handle to the line of the elbows, and of the elbows' distance. At 0
    /// the motors do not hold the handle.
    double parallel = 0.0;

    /// The smallest of the three.
    [[nodiscard]] double min() const noexcept { return std::min({serial_1, serial_2, parallel}); }
};

/// The planar five-bar linkage ("pantograph"): two driven links from pivots on the x axis, two free
/// links that meet at the handle. Frame: pivot 1 at the origin, pivot 2 at (base, 0), m.
/// Lengths are not checked here; see check() of engine/device/calibration.hpp.
struct FiveBar {
    double driven_1 = 0.063;  ///< a1, m
    double driven_2 = 0.063;  ///< a4, m
    double free_1 = 0.075;    ///< a2, m
    double free_2 = 0.075;    ///< a3, m
    double base = 0.025;      ///< a5, m, >= 0
    WorkingMode mode{};       ///< elbows out, handle on the side away from the base

    struct Pose {
        Vec2 elbow_1{};
        Vec2 elbow_2{};
        Vec2 handle{};
    };

    /// The pose of two joint angles. The elbows may be on either side of their lines: ask mode_of
    /// or clearance. None where the free links cannot meet or are in line.
    [[nodiscard]] std::optional<Pose> forward(const JointAngles& angles) const noexcept;

    /// The elbow of driven link 1, or 2, at an angle of which sine and cosine are given, m.
    [[nodiscard, gnu::always_inline]] Vec2 elbow_1_at(const SinCos& angle) const noexcept {
        return Vec2{driven_1 * angle.cos, driven_1 * angle.sin};
    }
    [[nodiscard, gnu::always_inline]] Vec2 elbow_2_at(const SinCos& angle) const noexcept {
        return Vec2{base + driven_2 * angle.cos, driven_2 * angle.sin};
    }
    /// Handle = foot + h n, foot at (a2^2 - a3^2 + D^2) / 2D along the line of the elbows, D their
    /// distance, on the mode's side of it. NaN where the free links cannot meet or are in line (h =
    /// 0).
    [[nodiscard, gnu::always_inline]] Vec2 handle_over(const Vec2& elbow_1,
                                                       const Vec2& elbow_2) const noexcept {
        const Vec2 between = elbow_2 - elbow_1;
        const double d2 = glm::dot(between, between);
        const double along = (free_1 * free_1 - free_2 * free_2 + d2) / (2.0 * d2);  // share of D
        const double h2 = free_1 * free_1 - along * along * d2;
        // Both choices without a branch, so that compilers make vectors of many.
        const double side = mode.handle_left ? 1.0 : -1.0;
        const double up =
            std::sqrt((h2 > 0.0 ? h2 : std::numeric_limits<double>::quiet_NaN()) / d2);
        return elbow_1 + along * between + side * up * perp(between);
    }

    /// Angles, in (-2 pi, 2 pi), that bring the handle to `handle` in the working mode; none
    /// outside the reach, or where these elbows leave the handle on the other side of their line.
    [[nodiscard]] std::optional<JointAngles> inverse(const Vec2& handle) const noexcept;

    /// On which side of their lines elbows and handle of `pose` are.
    [[nodiscard]] WorkingMode mode_of(const Pose& pose) const noexcept;
    /// How far `pose` is from the singular ones of this mode, m.
    [[nodiscard]] Clearance clearance(const Pose& pose) const noexcept;

    /// By implicit differentiation of |P - A|^2 = a2^2 and |P - B|^2 = a3^2 (Campion, Wang &
    /// Hayward 2005, whose printed Jacobian lacks two signs). None where the handle and the elbows
    /// are in line to within 1e-6 of the product of the free links.
    [[nodiscard]] std::optional<Jacobian> jacobian(const Pose& pose) const noexcept;

    /// C with J' w = C w for joint rates v = w: the handle's acceleration that comes of the rates
    /// alone, m/s^2. From the second derivative of the same two lengths. Symmetric in v and w:
    /// C(v) w = C(w) v.
    /// @param jacobian  of `pose`
    [[nodiscard]] Jacobian drift(const Pose& pose,
                                 const Jacobian& jacobian,
                                 const Vec2& rates) const noexcept;
};

}  // namespace palpate::engine
