#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "engine/commissioning/pulses.hpp"
#include "engine/commissioning/rig_record.hpp"

/// What marks and pulses say of three straight axes. Each is alone: a count is a way, a torque a
/// force, and no linkage has to be reckoned with.
namespace palpate::engine {

/// Home, then a place along each axis alone, towards its further end.
/// @throws std::invalid_argument for an axis whose way is too short, and for a home at an end
[[nodiscard]] std::vector<Vec3> straight_places(const GantrySpec& spec);
/// @throws std::invalid_argument for other places than home and one along each axis, 20 mm from it
/// or more
void check_straight_places(const GantrySpec& spec, std::span<const Vec3> places);

/// Each encoder that does not say where the handle is, by name, with what to do: a sentence without
/// a full stop, empty if all do.
/// @param places  as above   @param rests  what was read at each
[[nodiscard]] std::string wrong_encoders(const Calibration& machine,
                                         std::span<const Vec3> places,
                                         std::span<const Rest> rests);

/// Each motor that does not move its own axis its own way, as above.
/// @param pulses  both directions of every axis, none broken off
[[nodiscard]] std::string wrong_motors(const Calibration& machine, std::span<const Pulse> pulses);

/// The handle went so far that its way tells something: 1 mm.
[[nodiscard]] bool moved_enough(const Gantry& gantry, const Pulse& pulse);

/// A pulse that is over before an axis that nobody sees, its encoder being dead, is 2 cm away.
/// @param force  N   @param mass  of the axis, kg
[[nodiscard]] PulsePlan straight_pulse(double force, double mass);

/// How a machine of either kind is pushed. @param mass  kg of straight axes
[[nodiscard]] PulsePlan pulse_plan(const Calibration& machine,
                                   const Vec3& direction,
                                   double force,
                                   const Vec3& mass);

/// From the start of the pulse to a sample, m, as the encoders say.
[[nodiscard]] Vec3 way_of(const Gantry& gantry, const Pulse& pulse, std::size_t sample);
/// The same of axes that move so:
///
///     m v' = F - b v - f sgn v - pull        F: the motor's force, `delay` s after its sample
[[nodiscard]] Vec3 predicted_way(const Gantry& gantry,
                                 const Pulse& pulse,
                                 std::size_t sample,
                                 const std::array<AxisDynamics, 3>& axes,
                                 double delay);

/// Numbers of axes, and what share of the ways of each they leave over.
struct FittedAxes {
    std::array<AxisDynamics, 3> axes{};
    double late = 0.0;  ///< s by which answers are older than they should be, of the latest axis
    std::array<double, 3> unexplained{};
};

/// The numbers of each axis whose motion is nearest to that of its pulses.
/// @param mass  kg, where to begin
[[nodiscard]] FittedAxes fit_axes(const Gantry& gantry,
                                  std::span<const Pulse> pulses,
                                  const Vec3& mass,
                                  double delay);

/// Each motor that is too strong or too weak for the mass that it moves, as above; and before that
/// a motion that mass and friction do not explain.
[[nodiscard]] std::string wrong_strength(const FittedAxes& found, const Vec3& mass);

/// What each motor gives by what it gave when `axes` were found, friction being what it may.
struct AxesChange {
    Vec3 gain{1.0};
    double late = 0.0;         ///< s by which answers are older, of the axis with the oldest
    double unexplained = 0.0;  ///< of the axis that this explains worst
};
/// @param pulses  both directions of every axis
[[nodiscard]] AxesChange change_of_axes(const Gantry& gantry,
                                        std::span<const Pulse> pulses,
                                        const std::array<AxisDynamics, 3>& axes,
                                        double delay);

}  // namespace palpate::engine
