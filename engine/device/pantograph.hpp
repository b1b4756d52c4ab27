#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "engine/device/calibration.hpp"

namespace palpate::engine {

/// The arithmetic between a pantograph's motors and encoders and the object frame. A plain value.
class Pantograph {
public:
    using Counts = std::array<std::int32_t, 2>;

    /// Where the handle is and how it moves there.
    struct Fix {
        Vec2 hip{};           ///< object frame, m
        Jacobian jacobian{};  ///< of hip by the joint angles, m/rad, object frame
    };

    /// Torques of both motors.
    struct Drive {
        Vec2 torque{};           ///< N m, within the limits, both scaled alike
        bool saturated = false;  ///< the force asked for needed more
        Vec2 load{};             ///< |torque| / torque_forever of each motor
    };

    explicit Pantograph(const PantographSpec& spec) : spec_(spec) {}

    [[nodiscard]] JointAngles angles(const Counts& counts) const noexcept;
    /// The nearest counts.
    [[nodiscard]] Counts counts(const JointAngles& angles) const noexcept;
    /// None where the linkage has no pose, or a singular one.
    [[nodiscard]] std::optional<Fix> locate(const JointAngles& angles) const noexcept;
    /// Joint angles with the handle at `hip`; none outside the reach.
    [[nodiscard]] std::optional<JointAngles> reach(const Vec2& hip) const noexcept;
    [[nodiscard]] Drive drive(const Fix& fix, const Vec2& force) const noexcept;
    /// The largest force that the motors can give in every direction at `hip`, N; none if the handle
    /// cannot be there.
    [[nodiscard]] std::optional<double> weakest_force(const Vec2& hip) const noexcept;

    [[nodiscard]] const PantographSpec& spec() const noexcept { return spec_; }

private:
    PantographSpec spec_;
};

}  // namespace palpate::engine
