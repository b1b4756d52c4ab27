#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/commissioning/pulse_fit.hpp"

/// A rig is proved from nothing: first its encoders, by places to which a person brings the handle
/// and while no motor turns; then its motors, by weak pulses on a handle that nobody holds.
/// Whatever is wrong is found before a force is more than 0.3 N, on three straight axes 1 N.
namespace palpate::engine {

/// What the procedure needs of the world.
struct CommissioningDesk {
    /// A person brings the handle there and lets go. @return false: they gave up
    std::function<bool(const Vec3&)> bring;
    PulseRunner::Wait wait;  ///< see PulseRunner
    double period = 1e-3;    ///< s
};

/// What came of it.
struct CommissioningResult {
    std::string refused;  ///< why not, a sentence without a full stop; empty: the rig is proved
    bool given_up = false;
    /// Without device, calibration and program, which are of whoever keeps it.
    RigRecord record{};
    std::vector<Pulse> pulses;
    EncoderProof encoders{};             ///< of a pantograph
    std::optional<MotorProof> motors{};  ///< the same; none: no motor was turned at all places
};

/// Where the handle is brought: home first, then so few places that they tell the encoders.
/// @param home  of a pantograph   @throws std::invalid_argument if there are none
[[nodiscard]] std::vector<Vec3> places_to_commission(const Calibration& machine, const Vec2& home);

/// @param places  those of places_to_commission(), or others that tell the encoders, home first
/// @param mass    kg: what the handle of a pantograph weighs, or what each of three motors moves
/// @throws std::invalid_argument for places that do not tell how encoders are connected, and for a
///         mass that cannot be
[[nodiscard]] CommissioningResult commission(Device& device,
                                             const Calibration& machine,
                                             const std::vector<Vec3>& places,
                                             const Vec3& mass,
                                             const CommissioningDesk& desk);

}  // namespace palpate::engine
