#include "protocols/design/adaptive_plan.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "engine/base/sha256.hpp"
#include "protocols/order/order_sampler.hpp"
#include "protocols/psychometric/exact_math.hpp"

namespace palpate::protocols {
namespace {

template <class Spec>
std::size_t index_of(const std::vector<Spec>& specs, std::string_view what, std::string_view name) {
    const auto found = std::ranges::find(specs, name, &Spec::name);
    refuse_if(found == specs.end(), "there is no {} \"{}\"", what, name);
    return static_cast<std::size_t>(found - specs.begin());
}

/// Runs as objects and intervals as frictions, for the sampler of orders.
std::vector<Condition> run_intervals(const Protocol& protocol, Pcg32& random) {
    const std::size_t intervals = intervals_of(protocol);
    std::vector<Condition> trials;
    for (std::size_t run = 0; run < protocol.runs.size(); ++run) {
        const std::size_t extra = random.bounded(2);
        for (std::size_t i = 0; i < protocol.procedure->trials; ++i) {
            trials.push_back({run, intervals == 1 ? 0 : (i + extra) % 2});
        }
    }
    return trials;
}

/// The interval of each practice trial's comparison, from 0.
std::vector<std::size_t> practice_intervals(const Protocol& protocol, Pcg32& random) {
    const AdaptiveSpec& spec = *protocol.procedure;
    std::vector<std::size_t> intervals(spec.practice_trials, 0);
    if (intervals_of(protocol) == 1) {
        return intervals;
    }
    if (!spec.practice_balanced) {
        for (std::size_t& interval : intervals) {
            interval = random.bounded(2);
        }
        return intervals;
    }
    const std::size_t runs = protocol.runs.size();
    for (std::size_t run = 0; run < runs; ++run) {
        std::vector<std::size_t> own;  // of an odd number, which has one more is drawn
        const std::size_t extra = random.bounded(2);
        for (std::size_t i = run; i < intervals.size(); i += runs) {
            own.push_back((own.size() + extra) % 2);
        }
        shuffle(std::span(own), random);
        for (std::size_t i = 0; i < own.size(); ++i) {
            intervals[run + i * runs] = own[i];
        }
    }
    return intervals;
}

/// @param interval  of the comparison, from 0
PlannedTrial trial_of(const Protocol& protocol,
                      Phase phase,
                      std::size_t run,
                      std::size_t interval) {
    const RunSpec& of = protocol.runs.at(run);
    const auto friction = [&](const std::string& name) {
        return index_of(protocol.frictions, "friction", name);
    };
    return {.phase = phase,
            .condition = {index_of(protocol.objects, "object", protocol.procedure->object),
                          friction(of.friction)},
            .adaptive = AdaptiveTrial{
                .run = run,
                .comparison = interval + 1,
                .standard_friction =
                    friction(of.standard_friction.empty() ? of.friction : of.standard_friction)}};
}

}  // namespace

std::size_t answers_of(const Protocol& protocol) {
    switch (protocol.response.kind) {
        case ResponseKind::identification:
            return objects_of(protocol, true).size();
        case ResponseKind::two_interval:
        case ResponseKind::yes_no:
            return 2;
        case ResponseKind::rating:
            return protocol.response.levels;
    }
    return 0;
}

double felt_value(const AdaptiveSpec& spec, double stimulus) {
    constexpr double kLnOf10 = 2.302585092994046;
    return spec.stimulus_as == StimulusAs::log10 ? exponential(kLnOf10 * stimulus) : stimulus;
}

std::vector<ObjectSpec> extreme_objects(const Protocol& protocol) {
    std::vector<ObjectSpec> objects;
    if (!protocol.procedure || protocol.procedure->varies != Varies::curvature) {
        return objects;
    }
    const AdaptiveSpec& spec = *protocol.procedure;
    const auto base = std::ranges::find(protocol.objects, spec.object, &ObjectSpec::name);
    if (base != protocol.objects.end()) {
        for (const double x : {spec.lowest, spec.highest}) {
            objects.push_back(*base);
            objects.back().curvature = felt_value(spec, x);
        }
    }
    return objects;
}

void add_adaptive_trials(const Protocol& protocol, const StreamKey& key, Plan& plan) {
    const AdaptiveSpec& spec = *protocol.procedure;
    Pcg32 practice = stream(key, purpose::practice_order);
    const std::vector<std::size_t> practised = practice_intervals(protocol, practice);
    for (std::size_t i = 0; i < spec.practice_trials; ++i) {
        plan.trials.push_back(
            trial_of(protocol, Phase::practice, i % protocol.runs.size(), practised[i]));
    }
    Pcg32 extra = stream(key, purpose::main_order, 1);
    OrderSampler sampler(
        run_intervals(protocol, extra),
        {.object = spec.max_run, .friction = spec.max_run_interval, .words = {"run", "interval"}});
    Pcg32 random = stream(key, purpose::main_order);
    const ConstrainedOrder drawn = sampler.draw(random);
    plan.attempts = drawn.attempts;
    plan.way = drawn.way;
    for (const Condition& one : drawn.order) {
        plan.trials.push_back(trial_of(protocol, Phase::main, one.object, one.friction));
    }
    place(plan.trials, spec.practice_trials, protocol.design.break_every);
}

StreamKey run_key(StreamKey key, std::size_t run) {
    key.purpose = purpose::procedure;
    key.block = run;
    return key;
}

std::string rule_lines(const Protocol& protocol, const StreamKey& key) {
    std::string text = fmt::format("rule={}\n", sha256_hex(protocol.procedure->rule.text));
    for (std::size_t run = 0; run < protocol.runs.size(); ++run) {
        text += fmt::format("run={} {}\n", run, sha256_hex(canonical_text(run_key(key, run))));
    }
    return text;
}

}  // namespace palpate::protocols
