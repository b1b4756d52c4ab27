#include "protocols/design/duration.hpp"

#include <algorithm>

#include "protocols/design/adaptive_plan.hpp"

namespace palpate::protocols {

Duration duration_of(const Plan& plan, const Protocol& protocol) {
    const TimingSpec& timing = protocol.timing;
    const auto trials = static_cast<double>(plan.trials.size());
    const auto breaks = static_cast<double>(
        std::count_if(plan.trials.begin(), plan.trials.end(),
                      [](const PlannedTrial& trial) { return trial.break_before; }));
    const auto intervals = static_cast<double>(intervals_of(protocol));
    const double around = intervals * (2.0 * protocol.apparatus.force_ramp + timing.gap);
    const double person = intervals * kReadySeconds + kChoiceSeconds;
    const double pause = breaks * timing.break_min;
    return {.shortest = trials * (intervals * timing.explore_min + around) + pause,
            .prompted = trials * (intervals * timing.explore_prompt + around + person) + pause,
            .longest = trials * (intervals * timing.explore_timeout + around + person) + pause};
}

}  // namespace palpate::protocols
