#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "engine/device/calibration.hpp"
#include "engine/geometry/vec.hpp"
#include "engine/math/elementary.hpp"

namespace palpate::engine {

/// The object frame in the linkage's frame: moved by `origin`, then turned by `turn`.
class ObjectFrame {
public:
    /// @param origin  of the object frame, in the linkage's frame, m
    /// @param turn    from the linkage's x axis to the object frame's, rad
    ObjectFrame(const Vec2& origin, double turn) noexcept : origin_(origin), turn_(sin_cos(turn)) {}

    /// A vector of the linkage's frame, seen from the object frame.
    [[nodiscard]] Vec2 to_object(const Vec2& v) const noexcept {
        return Vec2{turn_.cos * v.x + turn_.sin * v.y, turn_.cos * v.y - turn_.sin * v.x};
    }
    [[nodiscard]] Vec2 to_linkage(const Vec2& v) const noexcept {
        return Vec2{turn_.cos * v.x - turn_.sin * v.y, turn_.sin * v.x + turn_.cos * v.y};
    }
    [[nodiscard]] Vec2 point_to_object(const Vec2& p) const noexcept {
        return to_object(p - origin_);
    }
    [[nodiscard]] Vec2 point_to_linkage(const Vec2& p) const noexcept {
        return origin_ + to_linkage(p);
    }

private:
    Vec2 origin_;
    SinCos turn_;
};

/// Torques of a machine's motors; of two the third is 0.
struct MotorDrive {
    Vec3 torque{};           ///< N m, within the limits, all scaled alike
    bool saturated = false;  ///< the force asked for needed more
    Vec3 load{};             ///< |torque| / torque_forever of each motor
};
/// `torque` scaled into the limits: the force keeps its direction.
/// @param limit, forever  N m, > 0, of each motor
[[nodiscard]] MotorDrive within_limits(const Vec3& torque,
                                       const Vec3& limit,
                                       const Vec3& forever) noexcept;

/// The arithmetic between a pantograph's motors and encoders and the object frame. A plain value.
class Pantograph {
public:
    using Counts = std::array<std::int32_t, kMaxAxes>;  ///< the third is 0

    /// Where the handle is and how it moves there.
    struct Fix {
        Vec2 hip{};              ///< object frame, m
        Jacobian jacobian{};     ///< of hip by the joint angles, m/rad, object frame
        double clearance = 0.0;  ///< from the next singular pose, m (Clearance::min)
    };

    /// @throws std::invalid_argument what check() refuses
    explicit Pantograph(const PantographSpec& spec);

    /// Angles of the driven links, rad, from the counts of their encoders.
    [[nodiscard]] JointAngles angles(const Counts& counts) const noexcept;
    /// The nearest counts; the ends of 32 bits beyond them, 0 for what is not a number.
    [[nodiscard]] Counts counts(const JointAngles& angles) const noexcept;
    /// None where the linkage has no pose, one in another working mode, or one within the machine's
    /// clearance of a singular pose.
    [[nodiscard]] std::optional<Fix> locate(const JointAngles& angles) const noexcept;
    /// Joint angles with the handle at `hip`; none where `locate` would refuse them. Whole turns
    /// are added until each lies within half a turn of the axis' `zero`, so that its counts are
    /// small.
    [[nodiscard]] std::optional<JointAngles> reach(const Vec2& hip) const noexcept;
    /// tau = J^T F, both torques scaled alike into the limits: the force keeps its direction.
    /// @param force  finite, N, object frame
    [[nodiscard]] MotorDrive drive(const Fix& fix, const Vec2& force) const noexcept;
    /// The largest force that the motors can give in every direction at `hip`, N; none if the
    /// handle cannot be there. Motor i holds F in the direction of column i of J with F |column i|,
    /// its worst: the least of torque_limit / |column|.
    [[nodiscard]] std::optional<double> weakest_force(const Vec2& hip) const noexcept;
    /// The most that the nearest counts lie off a handle at `hip`, m; none if it cannot be there.
    [[nodiscard]] std::optional<double> reading_error(const Vec2& hip) const noexcept;
    /// How far one count of the worst mix of both encoders moves HIP, and of the best, m: the
    /// singular values of J diag(2 pi / counts_per_turn).
    [[nodiscard]] SingularValues quantum(const Fix& fix) const noexcept;

    /// The machine as it was given.
    [[nodiscard]] const PantographSpec& spec() const noexcept { return spec_; }

private:
    PantographSpec spec_;
    ObjectFrame frame_;
};

}  // namespace palpate::engine
