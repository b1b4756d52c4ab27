#include "protocols/design/plan_summary.hpp"

#include <algorithm>

#include "protocols/design/adaptive_plan.hpp"

namespace palpate::protocols {
namespace {

std::size_t longest_run(const std::vector<Condition>& order, std::size_t Condition::*factor) {
    std::size_t longest = 0;
    std::size_t run = 0;
    for (std::size_t i = 0; i < order.size(); ++i) {
        run = i > 0 && order[i].*factor == order[i - 1].*factor ? run + 1 : 1;
        longest = std::max(longest, run);
    }
    return longest;
}

}  // namespace

PlanSummary summarise(const Plan& plan) {
    PlanSummary summary;
    std::map<std::size_t, std::vector<Condition>> blocks;
    const Condition* last = nullptr;
    for (const PlannedTrial& trial : plan.trials) {
        ++summary.counts[{trial.phase, trial.block}][trial.condition];
        if (trial.break_before) {
            summary.breaks.push_back(trial.position);
        }
        if (trial.phase != Phase::main) {
            continue;
        }
        blocks[trial.block].push_back(trial.condition);
        if (last != nullptr) {
            ++summary.object_steps[last->object][trial.condition.object];
            ++summary.friction_steps[last->friction][trial.condition.friction];
        }
        last = &trial.condition;
    }
    for (const auto& [block, order] : blocks) {
        summary.longest_object_run =
            std::max(summary.longest_object_run, longest_run(order, &Condition::object));
        summary.longest_friction_run =
            std::max(summary.longest_friction_run, longest_run(order, &Condition::friction));
    }
    return summary;
}

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
