#pragma once

#include <span>
#include <string>

#include "engine/commissioning/pulse_fit.hpp"
#include "engine/commissioning/pulses.hpp"
#include "engine/commissioning/rig_record.hpp"

/// Does a free handle move as it did when the rig was commissioned?
namespace palpate::engine {

/// How the joints turned, against how they should have. Joints and not the handle: near a singular
/// pose, where a machine may well be at home, a count is a large step of the handle. Of straight
/// axes their ways.
struct PulseMatch {
    double share = 0.0;   ///< size of the turn of all, by the predicted one
    double angle = 0.0;   ///< rad between them, in the plane of both turns
    double counts = 0.0;  ///< the most that one of them is off
};

/// A push that hardly overcomes friction moves by a count or none, and its share and angle say
/// nothing: start and end are whole counts.
inline constexpr double kMaxRounding = 1.5;
/// The turn until the force was reversed, measured and predicted by the plant.
/// @param record  whose dynamics are those of the handle
/// @param delay   s from a tick's reading to the force of that tick
[[nodiscard]] PulseMatch match(const Machine& machine,
                               const Pulse& pulse,
                               const RigRecord& record,
                               double delay);

/// What speaks at once against a rig whose handle should move as `record` says, be its friction
/// what it may: a sentence without a full stop, empty if nothing does.
[[nodiscard]] std::string wrong_with(const Machine& machine,
                                     const Pulse& pulse,
                                     const RigRecord& record,
                                     double delay);

/// The first pulse whose motion the numbers that were found from all do not explain, as above.
[[nodiscard]] std::string unexplained_by(const RigRecord& record,
                                         const Machine& machine,
                                         std::span<const Pulse> pulses,
                                         double delay);
}  // namespace palpate::engine
