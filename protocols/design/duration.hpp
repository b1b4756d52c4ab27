#pragma once

#include "protocols/design/plan.hpp"
#include "protocols/protocol/protocol.hpp"

namespace palpate::protocols {

/// What a protocol cannot say of a trial: how quick a person is. Guesses, to be named with the
/// result.
inline constexpr double kReadySeconds = 2.0;   ///< to bring the handle to the start pose
inline constexpr double kChoiceSeconds = 3.0;  ///< to choose among the pictures

/// How long a session takes, s, without instructions and without trials that are run again.
struct Duration {
    double shortest = 0.0;  ///< every trial felt for explore_min, no time for ready and choice
    double prompted =
        0.0;               ///< every trial felt until explore_prompt, kReadySeconds, kChoiceSeconds
    double longest = 0.0;  ///< every trial felt until explore_timeout, else as prompted
};

/// A trial is ready + force in + explore + force out + choice + gap; a break is break_min.
[[nodiscard]] Duration duration_of(const Plan& plan, const Protocol& protocol);

}  // namespace palpate::protocols
