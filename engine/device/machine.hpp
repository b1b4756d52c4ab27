#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <variant>

#include "engine/device/gantry.hpp"
#include "engine/device/pantograph.hpp"

namespace palpate::engine {

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

    using Drive = Gantry::Drive;

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
    [[nodiscard]] Drive drive(const Place& place, const Vec3& force) const noexcept;
    /// As Device::weakest_force
    [[nodiscard]] std::optional<double> weakest_force(const Vec3& hip) const noexcept;
    /// As Device::reading_error
    [[nodiscard]] std::optional<double> reading_error(const Vec3& hip) const noexcept;

private:
    Calibration calibration_;
    std::variant<Pantograph, Gantry> parts_;
    Counts home_{};
};

}  // namespace palpate::engine
