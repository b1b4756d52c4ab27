#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "engine/device/calibration.hpp"
#include "engine/device/pantograph.hpp"

namespace palpate::engine {

/// The arithmetic between the motors and encoders of three straight axes and the object frame. A
/// plain value.
///
///   HIP_i = home_i + r_i q_i,   torque_i = r_i F_i    r: m by rad, q: rad since the set-up at home
class Gantry {
public:
    using Counts = std::array<std::int32_t, kMaxAxes>;

    /// @throws std::invalid_argument what check() refuses
    explicit Gantry(const GantrySpec& spec);

    /// HIP, m: a whole number of 100 nm, as a recording keeps it. None: outside the workspace.
    /// @param counts  since the set-up with the handle at home
    [[nodiscard]] std::optional<Vec3> locate(const Counts& counts) const noexcept;
    /// All torques scaled alike into the limits: the force keeps its direction.
    /// @param force  finite, N
    [[nodiscard]] MotorDrive drive(const Vec3& force) const noexcept {
        return within_limits(radius_ * force, limit_, forever_);
    }
    /// The force that the motors can give in every direction at `hip`, N: the least of torque_limit
    /// / r. None: outside the workspace.
    [[nodiscard]] std::optional<double> weakest_force(const Vec3& hip) const noexcept;
    /// The most that a reading lies off a handle at `hip`, m: half a count of each axis and half of
    /// 100 nm. None: outside the workspace.
    [[nodiscard]] std::optional<double> reading_error(const Vec3& hip) const noexcept;
    /// m of way by one count of each axis.
    [[nodiscard]] const Vec3& quantum() const noexcept { return quantum_; }

    /// As the calibration gave it, SI.
    [[nodiscard]] const GantrySpec& spec() const noexcept { return spec_; }

private:
    [[nodiscard]] bool holds(const Vec3& hip) const noexcept;

    GantrySpec spec_;
    Vec3 quantum_{};
    Vec3 radius_{};
    Vec3 limit_{};  ///< of each torque, N m
    Vec3 forever_{};
};

/// Whatever hangs on a board, between its motors and encoders and the object frame: a pantograph in
/// the plane, whose third count, torque and coordinate are 0, or three straight axes. A plain
/// value.
class Machine {
public:
    using Counts = std::array<std::int32_t, kMaxAxes>;

    /// Where the handle is.
    struct Place {
        Vec3 hip{};             ///< object frame, m
        Pantograph::Fix fix{};  ///< of a pantograph
    };

    /// @throws std::invalid_argument what check() refuses, and for a home out of reach
    explicit Machine(const Calibration& calibration);

    /// Motors, each with its encoder: 2 or 3.
    [[nodiscard]] std::size_t axes() const noexcept { return calibration_.axes(); }
    /// @param i  below axes()
    [[nodiscard]] const Axis& axis(std::size_t i) const noexcept { return calibration_.axis(i); }
    [[nodiscard]] const Calibration& calibration() const noexcept { return calibration_; }
    /// Counts with the handle at home; without a home those of count 0.
    [[nodiscard]] const Counts& home() const noexcept { return home_; }
    /// None where the handle cannot be.
    [[nodiscard]] std::optional<Place> locate(const Counts& counts) const noexcept;
    /// @param force  finite, N, object frame
    [[nodiscard]] MotorDrive drive(const Place& place, const Vec3& force) const noexcept;
    /// As Device::weakest_force
    [[nodiscard]] std::optional<double> weakest_force(const Vec3& hip) const noexcept;
    /// As Device::reading_error
    [[nodiscard]] std::optional<double> reading_error(const Vec3& hip) const noexcept;

private:
    Calibration calibration_;
    std::variant<Pantograph, Gantry> parts_;
    Counts home_{};
};

/// The device takes the pose in which it is opened for home.
[[nodiscard]] bool starts_at_home(const Calibration& calibration);
/// m, where the handle rests when the device is switched on: the calibration's home, or where its
/// counts are 0 on a Haply or open board, or a place in the middle of the workspace.
[[nodiscard]] Vec3 home_of(const Calibration& calibration);

/// "(0, 89.3) mm", or of three axes "(0, 0, 40) mm".
[[nodiscard]] std::string place_text(const Vec3& place, std::size_t axes);

}  // namespace palpate::engine
