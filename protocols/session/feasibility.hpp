#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/device/device.hpp"
#include "protocols/protocol/protocol.hpp"

/// Before the first trial: can this device render this protocol?
namespace palpate::protocols {

/// What a finding means for the session.
enum class Verdict : std::uint8_t {
    warn,    ///< it can be run, and this should be known
    refuse,  ///< nobody should hold that handle
};

/// One thing that stands against device and protocol.
struct Finding {
    Verdict verdict = Verdict::warn;
    std::string text;  ///< a sentence with numbers and the remedy, without a full stop
};

/// What stands against it, in this order; empty when nothing does, and for devices that give no
/// force.
///
/// Passivity: b >= K T (1/2 + d) + |B| (engine/safety/passivity.hpp) of the device's least damping
/// b and delay of d ticks, and of the contact's damper B. Less is refused with the stiffness and
/// the rate that would do; an unknown b is a warning with the b that is needed.
///
/// Workspace: every outline, sampled every 1/64 of a side, and the start pose must be within reach,
/// or it is refused with the first point that is not.
///
/// Force: where the device gives less in its weakest direction than force_limit_n somewhere on an
/// outline, a warning says how deep one can press there before it clips.
[[nodiscard]] std::vector<Finding> check_feasibility(const Protocol& protocol,
                                                     const engine::Device& device);

/// What check_feasibility compares, for people to see how close it is.
struct Margins {
    double needed_damping = 0.0;      ///< K T (1/2 + d), N s/m
    std::optional<double> damping{};  ///< b, N s/m; none: not known
    std::optional<double>
        weakest_force{};  ///< least on any outline within reach, N; none: not known
    std::optional<double>
        reading_error{};            ///< largest on any outline within reach, m; none: not known
    double resting_friction = 0.0;  ///< N, dry friction of the device that promises rest
    double creep = 0.0;             ///< m/s rms, the most without it; infinity: no bound is known
};
/// By the same places as check_feasibility.
[[nodiscard]] Margins margins_of(const Protocol& protocol, const engine::Device& device);

/// When a contact comes to rest (engine/safety/passivity.hpp), as a sentence without a full stop;
/// empty where it is not known how finely the device reads.
[[nodiscard]] std::string rest_text(const Margins& margins);

}  // namespace palpate::protocols
