#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "engine/device/calibration.hpp"

namespace palpate::engine {

/// The arithmetic between the motors and encoders of three straight axes and the object frame. A
/// plain value.
///
///   HIP_i = home_i + r_i q_i,   torque_i = r_i F_i    r: m by rad, q: rad since the set-up at home
class Gantry {
public:
    using Counts = std::array<std::int32_t, kMaxAxes>;

    /// Torques of the three motors.
    struct Drive {
        Vec3 torque{};           ///< N m, within the limits, all scaled alike
        bool saturated = false;  ///< the force asked for needed more
        Vec3 load{};             ///< |torque| / torque_forever of each motor
    };

    /// @throws std::invalid_argument what check() refuses
    explicit Gantry(const GantrySpec& spec);

    /// HIP, m: a whole number of 100 nm, as a recording keeps it. None: outside the workspace.
    /// @param counts  since the set-up with the handle at home
    [[nodiscard]] std::optional<Vec3> locate(const Counts& counts) const noexcept;
    /// All torques scaled alike into the limits: the force keeps its direction.
    /// @param force  finite, N
    [[nodiscard]] Drive drive(const Vec3& force) const noexcept;
    /// The force that the motors can give in every direction at `hip`, N: the least of torque_limit
    /// / r. None: outside the workspace.
    [[nodiscard]] std::optional<double> weakest_force(const Vec3& hip) const noexcept;
    /// The most that a reading lies off a handle at `hip`, m: half a count of each axis and half of
    /// 100 nm. None: outside the workspace.
    [[nodiscard]] std::optional<double> reading_error(const Vec3& hip) const noexcept;
    /// m of way by one count of each axis.
    [[nodiscard]] Vec3 quantum() const noexcept;

    /// As the calibration gave it, SI.
    [[nodiscard]] const GantrySpec& spec() const noexcept { return spec_; }

private:
    [[nodiscard]] bool holds(const Vec3& hip) const noexcept;

    GantrySpec spec_;
    Vec3 quantum_{};
};

}  // namespace palpate::engine
