#include "protocols/design/plan_summary.hpp"

#include <algorithm>
#include <cmath>

#include "protocols/design/adaptive_plan.hpp"
#include "protocols/order/order_counter.hpp"
#include "protocols/order/order_sampler.hpp"

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

double practice_trials(const Plan& plan) {
    return static_cast<double>(
        std::ranges::count(plan.trials, Phase::practice, &PlannedTrial::phase));
}

/// Of the proposals of one way, how many keep the limits; and what that makes of all shuffles.
Acceptance estimate(OrderSampler& sampler, std::span<const Condition> trials) {
    constexpr std::uint64_t kProposals = 100'000;
    const OrderWay way = sampler.first_way();
    const auto counted = [&](std::size_t Condition::*factor) {
        return share_of(sampler.counter_of(factor)->total(),
                        multinomial(counts_of(trials, factor)));
    };
    double known = 1.0;
    if (way == OrderWay::friction_counted || way == OrderWay::apart) {
        known *= counted(&Condition::friction);
    }
    if (way == OrderWay::object_counted || way == OrderWay::apart) {
        known *= counted(&Condition::object);
    }
    if (way == OrderWay::apart) {  // its pairs have any table of conditions, shuffles the right one
        const Natural pairs = multinomial(counts_of(trials, &Condition::object)) *
                              multinomial(counts_of(trials, &Condition::friction));
        known /= share_of(orders_of(trials), pairs);
    }
    Pcg32 random(0, 0);
    std::uint64_t kept = 0;
    for (std::uint64_t i = 0; i < kProposals; ++i) {
        kept += sampler.propose(way, random) ? 1U : 0U;
    }
    const double share = static_cast<double>(kept) / static_cast<double>(kProposals);
    return {.share = known * share,
            .exact = kept == kProposals,
            .error = kept > 0 ? std::sqrt((1.0 - share) / static_cast<double>(kept)) : 1.0,
            .draws = kProposals};
}

}  // namespace

PlanSummary summarise(const Plan& plan) {
    PlanSummary summary;
    std::vector<Condition> main;
    for (const PlannedTrial& trial : plan.trials) {
        ++summary.counts[{trial.phase, trial.block}][trial.condition];
        if (trial.break_before) {
            summary.breaks.push_back(trial.position);
        }
        if (trial.phase != Phase::main) {
            continue;
        }
        if (!main.empty()) {
            ++summary.object_steps[main.back().object][trial.condition.object];
            ++summary.friction_steps[main.back().friction][trial.condition.friction];
        }
        main.push_back(trial.condition);
    }
    summary.longest_object_run = longest_run(main, &Condition::object);
    summary.longest_friction_run = longest_run(main, &Condition::friction);
    return summary;
}

double choice_seconds(const Protocol& protocol) noexcept {
    return kChoiceSeconds * (protocol.response.confidence ? 2.0 : 1.0);
}

Duration duration_of(const Plan& plan, const Protocol& protocol) {
    const TimingSpec& timing = protocol.timing;
    const auto trials = static_cast<double>(plan.trials.size());
    const auto breaks = static_cast<double>(std::ranges::count_if(
        plan.trials, [](const PlannedTrial& trial) { return trial.break_before; }));
    const auto intervals = static_cast<double>(intervals_of(protocol));
    const double with_feedback = protocol.response.feedback == Feedback::all ? trials
                               : protocol.response.feedback == Feedback::practice
                                   ? practice_trials(plan)
                                   : 0.0;
    const double ramps = 2.0 * protocol.apparatus.force_ramp;
    const double person = intervals * kReadySeconds + choice_seconds(protocol);
    const double between = breaks * timing.break_min + with_feedback * kFeedbackSeconds +
                           std::max(trials * intervals - 1.0 - breaks, 0.0) * timing.gap;
    const auto felt_for = [&](double seconds) {
        return trials * intervals * (seconds + ramps) + between;
    };
    return {.shortest = felt_for(timing.explore_min),
            .prompted = felt_for(timing.explore_prompt) + trials * person,
            .longest = felt_for(timing.explore_timeout) + trials * person};
}

std::optional<double> acceptance_of_one(std::span<const Condition> trials,
                                        std::size_t Condition::*factor,
                                        std::size_t limit) {
    const auto counts = counts_of(trials, factor);
    if (!binds(counts, limit)) {
        return 1.0;
    }
    if (trials.size() > kMaxCounted) {
        return std::nullopt;
    }
    return share_of(count_orders(counts, limit), multinomial(counts));
}

Acceptance acceptance_of(std::span<const Condition> trials, const RunLimits& limits) {
    OrderSampler sampler({trials.begin(), trials.end()}, limits);
    const auto object = acceptance_of_one(trials, &Condition::object, limits.object);
    const auto friction = acceptance_of_one(trials, &Condition::friction, limits.friction);
    if (object && friction && (*object == 1.0 || *friction == 1.0)) {
        return {.share = *object * *friction};
    }
    if (sampler.first_way() == OrderWay::together) {
        return {.share = share_of(sampler.counter_of_both()->total(), orders_of(trials))};
    }
    return estimate(sampler, trials);
}

}  // namespace palpate::protocols
