#include "protocols/session/pending_trials.hpp"

#include <algorithm>

namespace palpate::protocols {

PendingTrials::PendingTrials(const Plan& plan, RequeueRule rule) : rule_(std::move(rule)) {
    for (const PlannedTrial& planned : plan.trials) {
        order_.push_back(planned.position);
        part_.push_back(planned.phase == Phase::practice ? 0 : 1 + planned.block);
    }
}

bool PendingTrials::has(std::size_t position) const noexcept {
    return std::find(order_.begin(), order_.end(), position) != order_.end();
}

std::size_t PendingTrials::left(bool practice) const noexcept {
    return static_cast<std::size_t>(
        std::count_if(order_.begin(), order_.end(),
                      [&](std::size_t position) { return (part_[position] == 0) == practice; }));
}

TrialNumber PendingTrials::number() const noexcept {
    const bool practice = !order_.empty() && part_[order_.front()] == 0;
    const auto total = static_cast<std::size_t>(std::count_if(
        part_.begin(), part_.end(), [&](std::size_t part) { return (part == 0) == practice; }));
    return {practice, std::min(total - left(practice) + 1, total), total};
}

void PendingTrials::note(std::size_t position, Outcome outcome, bool counts) {
    const bool answered = is_answered(outcome);
    const auto found = std::find(order_.begin(), order_.end(), position);
    if (found == order_.end() || !(answered || is_lost(outcome))) {
        return;
    }
    order_.erase(found);
    if (!(answered && counts)) {
        set_back(position);
    }
}

void PendingTrials::begin_again(std::size_t part) {
    std::erase_if(order_, [&](std::size_t position) { return part_[position] == part; });
    std::erase_if(again_, [&](const auto& again) { return part_[again.first] == part; });
    auto at = std::find_if(order_.begin(), order_.end(),
                           [&](std::size_t position) { return part_[position] > part; });
    for (std::size_t position = 0; position < part_.size(); ++position) {
        if (part_[position] == part) {
            at = order_.insert(at, position) + 1;
        }
    }
}

void PendingTrials::set_back(std::size_t position) {
    StreamKey key = rule_.key;
    key.block = position;
    key.purpose = purpose::requeue;
    Again& again = again_.try_emplace(position, Again{.random = stream(key)}).first->second;
    if (again.times++ == rule_.max) {
        return;
    }
    const auto part = part_[position];  // parts follow each other in the plan, and so they do here
    const auto first = std::find_if(order_.begin(), order_.end(),
                                    [&](std::size_t other) { return part_[other] >= part; });
    const auto last =
        std::find_if(first, order_.end(), [&](std::size_t other) { return part_[other] > part; });
    const auto others = static_cast<std::uint32_t>(last - first);
    order_.insert(others == 0 ? first : first + 1 + again.random.bounded(others), position);
}

}  // namespace palpate::protocols
