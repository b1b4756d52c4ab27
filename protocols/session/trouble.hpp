#pragma once

#include <functional>
#include <optional>

#include "protocols/session/ports.hpp"
#include "protocols/session/trust.hpp"

namespace palpate::protocols {

/// Between two questions to the observer after a fault, s; the device is asked every tenth time.
inline constexpr double kTroubleSlice = 0.05;
inline constexpr std::size_t kSlicesPerTry = 10;

/// What a session says of a rig that nothing is wrong with; a screen translates it.
inline constexpr const char* kAnother =
    "the device began anew while nobody looked, and may be another one: the experimenter goes on";
inline constexpr const char* kNotProved =
    "nothing is known of the rig any more: it is proved again";
inline constexpr const char* kProofComes =
    "the handle is proved before anybody feels a force: nobody may hold it now, weak pulses will "
    "move it";

/// What came of waiting for a device.
struct MendResult {
    Signal signal = Signal::go_on;  ///< go_on, abort or give_up
    std::size_t tries = 0;          ///< how often the device was asked to come back, in vain
};

/// Trust, and what has to be done with an event.
struct TrustPort {
    const RigTrust& trust;  ///< as events leave it
    /// Each event goes through it, to be kept and to change `trust`.
    std::function<void(const Event&)> happened;
};

/// After a faulted trial, or a proof that failed: asks the device to come back and proves what has
/// to be proved, at once and then every half second, and the observer whether to go on, until one
/// of both settles it. What comes of it is an event. A rig that may be another one asks for the
/// experimenter: the participant cannot go on. Who stops it meanwhile is an event too, and the
/// experimenter goes on then.
/// @param in_a_row  faulted trials since the last good one, this one too
/// @param trial     the attempt
[[nodiscard]] MendResult mend(Ports& ports,
                              const Fault& fault,
                              std::size_t in_a_row,
                              const TrustPort& rig,
                              std::optional<TrialId> trial = {});

/// If somebody stopped the force, keeps by what. @return the way; null: nobody did
const char* note_stop(Ports& ports, std::optional<TrialId> trial = {});

}  // namespace palpate::protocols
