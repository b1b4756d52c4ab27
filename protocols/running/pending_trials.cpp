#include "protocols/running/pending_trials.hpp"

#include <algorithm>

namespace palpate::protocols {

PendingTrials::PendingTrials(const Plan& plan) {
    for (const PlannedTrial& planned : plan.trials) {
        order_.push_back(planned.position);
        practice_.push_back(planned.phase == Phase::practice);
    }
}

void PendingTrials::note(std::size_t position, Outcome outcome) {
    const auto found = std::find(order_.begin(), order_.end(), position);
    const bool set_back = outcome == Outcome::faulted;
    if (found == order_.end() || !(is_answered(outcome) || set_back)) {
        return;
    }
    order_.erase(found);
    if (set_back) {
        const bool practice = practice_[position];
        const auto after = std::find_if(order_.rbegin(), order_.rend(), [&](std::size_t other) {
            return practice_[other] == practice;
        });
        order_.insert(after.base(), position);
    }
}

}  // namespace palpate::protocols
