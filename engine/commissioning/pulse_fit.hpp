#pragma once

#include <array>
#include <span>
#include <string>

#include "engine/commissioning/encoder_proof.hpp"
#include "engine/commissioning/pulses.hpp"
#include "engine/commissioning/rig_record.hpp"
#include "engine/math/elementary.hpp"

/// What pulses say of motors and handle.
///
/// In joint angles q, with J the handle's Jacobian, and for a handle of mass m with driven links of
/// inertia I, damping B and dry friction f, the impulse of a motor is
///
///     int tau = (I + m J^T J) q' + B q + f int sgn q'
///
/// and integrated once more it speaks of positions alone. Of motor i that is linear in I_i, m, B_i,
/// f_i, each divided by its gain: pulses at three places tell them. A motor on the other joint, or
/// reversed, fits worse or with a mass below 0; one twice as strong, with half the mass.
namespace palpate::engine {

/// A free handle may move so much otherwise than predicted: a gain within 30 %, a direction within
/// 20 degrees.
inline constexpr double kMaxGainError = 0.3;
inline constexpr double kMaxTurn = 20.0 * kPi / 180.0;
/// So much of a motion may be left over before a motor is blamed for it: FittedHandle::unexplained.
inline constexpr double kMaxUnexplained = 0.2;

/// s by which answers may be older than the device says: what a bus is late by now and then. More
/// lateness takes from the stiffness that is passive, and looks like a weaker motor.
inline constexpr double kMaxLate = 0.005;

/// Why no motor is blamed for a motion, a sentence without a full stop. @param what  was seen of it
[[nodiscard]] std::string unexplained_text(const std::string& what);
/// Empty where no more is left over and nothing later than the above.
/// @param left  share of a motion, FittedHandle::unexplained   @param late  s, FittedHandle::late
[[nodiscard]] std::string unexplained_by_motion(double left, double late);

/// What was found of the motors.
struct MotorProof {
    Connection connection{};       ///< nearest to what was found
    std::array<double, 2> gain{};  ///< as found: 1 is right
    HandleDynamics dynamics{};     ///< if the connection is right
    bool moved = false;            ///< every motor moved its joint
    double late = 0.0;             ///< s, FittedHandle::late
    double unexplained = 0.0;      ///< FittedHandle::unexplained of the gains
};
/// Which motor turns which joint, and which way, from the pulses of one place or more: factors of 1
/// and -1.
[[nodiscard]] Connection order_of_motors(const PantographSpec& spec,
                                         std::span<const Pulse> pulses,
                                         double delay);

/// @param pulses  at three places or more, all directions; encoders are right (prove_encoders)
/// @param mass    what the handle weighs, kg: strength and mass cannot be distinguished by motion
[[nodiscard]] MotorProof prove_motors(const PantographSpec& spec,
                                      std::span<const Pulse> pulses,
                                      double mass,
                                      double delay);

}  // namespace palpate::engine
