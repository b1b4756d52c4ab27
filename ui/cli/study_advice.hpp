#pragma once

#include <string>
#include <vector>

#include "protocols/design/plan.hpp"
#include "protocols/protocol/protocol.hpp"

namespace palpate::ui {

/// What may be meant otherwise in a protocol that is right, a sentence each: long stretches without
/// a break, no practice, no catch trials, friction that can be heard, laws of friction that creep,
/// chatter or are not passive, instructions that the chosen language lacks or that the screen
/// cannot show, noise so loud that its peaks are cut.
/// @param font  of the subject's screen; empty: it is not asked
/// @param motors  of the device, which can be heard
[[nodiscard]] std::vector<std::string> advice_on(const protocols::Protocol& protocol,
                                                 const protocols::Plan& plan,
                                                 const std::string& font = {},
                                                 bool motors = true);

/// Trials between two breaks, the most of them, and how long they take, s, each felt until the
/// prompt.
struct Stretch {
    std::size_t first = 0;  ///< position of its first trial
    std::size_t trials = 0;
    double seconds = 0.0;
};
/// Of several as long the first one.
[[nodiscard]] Stretch longest_stretch(const protocols::Protocol& protocol,
                                      const protocols::Plan& plan);

}  // namespace palpate::ui
