#pragma once

#include <array>
#include <span>
#include <vector>

#include "engine/commissioning/pulses.hpp"
#include "engine/commissioning/rig_record.hpp"

/// How a free handle moves, found from pulses by the motion itself: the numbers whose predicted
/// motion is nearest to the counts (Levenberg and Marquardt's method).
namespace palpate::engine {

/// A pulse as the fit needs it.
struct Track {
    struct Step {
        Vec2 torque{};   ///< N m that act on the joints, mean of the step
        Vec2 turned{};   ///< counts since the start, at the step's end
        Vec2 carry_1{};  ///< J^T J, J the handle's Jacobian halfway: rows
        Vec2 carry_2{};
        /// J^T C of a rate of joint 1, and of joint 2, rows: FiveBar::drift, linear in the rates.
        std::array<Vec2, 2> drift_1{};
        std::array<Vec2, 2> drift_2{};
        bool fresh = true;
    };
    double period = 1e-3;  ///< s of a step
    Vec2 per_count{};      ///< rad
    std::vector<Step> steps;
};

/// @param swapped, sign  which motor turns which joint, and which way
/// @param delay          s from a tick's reading to the force of that tick
[[nodiscard]] Track track_of(
    const Pantograph& machine, const Pulse& pulse, bool swapped, const Vec2& sign, double delay);

/// In the torques of motor 1: what motor 2 gives is `ratio` times as much.
struct FittedHandle {
    HandleDynamics dynamics{};
    double ratio = 1.0;
    double late = 0.0;  ///< s by which the counts are older than the track's delay says, to kLatest
    /// Of the pulse that the numbers explain worst: what is left over of its counts by their size,
    /// root mean square, beyond the rounding of whole counts.
    double unexplained = 0.0;
};

/// What is looked for: the dynamics, with them the ratio, with both the lateness.
enum class Unknowns : std::uint8_t { dynamics = 9, ratio = 10, lateness = 11 };

/// What is not looked for is as at the start.
[[nodiscard]] FittedHandle fit_handle(std::span<const Track> tracks,
                                      const FittedHandle& start,
                                      Unknowns unknowns);

/// What has become of a handle since its numbers were found: torques and friction by what they
/// were.
struct HandleChange {
    Vec2 gain{1.0, 1.0};       ///< of each motor
    double friction = 1.0;     ///< of all that rubs, damping and dry alike
    double late = 0.0;         ///< s, as above
    double unexplained = 0.0;  ///< as above
};

/// A push out and back tells strength from friction: friction takes of both, and a weak motor gives
/// less.
/// @param tracks  of four directions at one place
[[nodiscard]] HandleChange fit_change(std::span<const Track> tracks, const HandleDynamics& before);

}  // namespace palpate::engine
