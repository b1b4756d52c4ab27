#include "protocols/procedure/rule_facts.hpp"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

namespace palpate::protocols {
namespace {

RuleFacts facts(const ConstantStimuliSpec& spec) {
    const auto [least, most] = std::minmax_element(spec.values.begin(), spec.values.end());
    return {.trials = spec.values.size() * spec.repetitions,
            .lowest = *least,
            .highest = *most,
            .outcomes = spec.outcomes};
}

RuleFacts facts(const std::vector<StaircaseSpec>& specs) {
    RuleFacts all{.trials = 0, .lowest = specs.front().lowest, .highest = specs.front().highest};
    for (const StaircaseSpec& spec : specs) {
        if (spec.trials == 0 || spec.reversals != 0) {
            throw std::invalid_argument(
                fmt::format("the staircase {} ends {}: a session's plan is complete before its "
                            "first trial; give "
                            "trials and no reversals",
                            spec.name, spec.reversals != 0 ? "by reversals" : "never"));
        }
        all.trials += spec.trials;
        all.lowest = std::min(all.lowest, spec.lowest);
        all.highest = std::max(all.highest, spec.highest);
    }
    return all;
}

RuleFacts facts(const QuestSpec& spec) {
    return {.trials = spec.trials, .lowest = spec.lowest, .highest = spec.highest, .outcomes = 2};
}

RuleFacts facts(const QuestPlusSpec& spec) {
    if (spec.entropy_bits != 0.0) {
        throw std::invalid_argument(fmt::format(
            "entropy_bits is {}: a session's plan is complete before its first trial; leave it out "
            "and give trials",
            spec.entropy_bits));
    }
    if (spec.stimuli.dimensions() != 1) {
        throw std::invalid_argument(
            fmt::format("the rule chooses {} numbers a trial: a session varies one; give a model "
                        "with one stimulus",
                        spec.stimuli.dimensions()));
    }
    const std::vector<double>& values = spec.stimuli.axis(0).values;
    return {.trials = spec.trials,
            .lowest = values.front(),
            .highest = values.back(),
            .outcomes = spec.model.outcomes};
}

RuleFacts facts(const PsiSpec& spec) {
    return facts(quest_plus_spec(spec));
}

}  // namespace

RuleFacts facts_of(const ProcedureSpec& spec) {
    return std::visit([](const auto& s) { return facts(s); }, spec);
}

}  // namespace palpate::protocols
