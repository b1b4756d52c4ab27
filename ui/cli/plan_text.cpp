#include "ui/cli/plan_text.hpp"

#include <array>
#include <map>
#include <set>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "engine/base/sha256.hpp"
#include "engine/deformation/soft_shape.hpp"
#include "protocols/design/adaptive_plan.hpp"
#include "protocols/design/counterbalance.hpp"
#include "protocols/design/object_outline.hpp"
#include "protocols/file/keys.hpp"
#include "protocols/trial/presentation.hpp"

namespace palpate::ui {
namespace {

using protocols::Condition;
using protocols::Phase;
using protocols::PlanSummary;
using protocols::Protocol;

std::string limit_text(std::size_t limit) {
    return limit == 0 ? "no limit" : fmt::format("limit {}", limit);
}

template <class Spec>
std::string steps_of(std::string_view factor,
                     const std::vector<Spec>& levels,
                     const std::map<std::size_t, std::map<std::size_t, std::size_t>>& steps) {
    std::string text = fmt::format(
        "from one main trial to the next, {} (down: from, across: to)\n{:<14}", factor, "");
    std::set<std::size_t> seen;
    for (const auto& [from, row] : steps) {
        seen.insert(from);
        for (const auto& [to, count] : row) {
            seen.insert(to);
        }
    }
    for (const std::size_t to : seen) {
        text += fmt::format(" {:>11}", levels.at(to).name);
    }
    text += '\n';
    for (const std::size_t from : seen) {
        text += fmt::format("{:<14}", levels.at(from).name);
        for (const std::size_t to : seen) {
            const auto row = steps.find(from);
            text += fmt::format(" {:>11}", row != steps.end() && row->second.count(to) != 0
                                               ? row->second.at(to)
                                               : 0);
        }
        text += '\n';
    }
    return text;
}

/// How few whole shuffles keep the limits.
std::string acceptance_text(const Protocol& protocol) {
    const auto trials = block_trials(protocol, 0);
    const protocols::RunLimits limits = block_limits(protocol.design);
    const auto all = acceptance_of(trials, limits);
    std::string text = fmt::format(
        "acceptance of whole shuffles{}: {:.3g} ({})\n",
        block_count(protocol) > 1 ? " of a block" : "", all.share,
        all.exact ? std::string("exact") : fmt::format("estimate, +- {:.1g} %", 100.0 * all.error));
    const auto object = acceptance_of_one(trials, &Condition::object, limits.object);
    const auto friction = acceptance_of_one(trials, &Condition::friction, limits.friction);
    if (object && friction) {
        text += fmt::format("  of the limits alone, exact: object {:.3g}, friction {:.3g}\n",
                            *object, *friction);
    }
    return text;
}

std::string soft_line(const Protocol& protocol,
                      const protocols::ObjectSpec& object,
                      std::string_view whose) {
    const double c = object.compliance;
    if (!(c > 0.0)) {
        return {};
    }
    const double k = protocol.apparatus.stiffness;
    const engine::SoftShape shape(outline_of(protocol, object), c,
                                  1.0 / protocol.apparatus.rate_hz);
    return fmt::format(
        "  soft: {} {} gives way by {:.3g} mm/N at its vertex, with the contact's {:.6g} N/m by "
        "{:.3g} mm/N\n    in all ({:.4g} N/m), and by {:.3g} mm at the most, from {:.3g} N on\n",
        object.name, whose, 1e3 * c, k, 1e3 * (c + 1.0 / k), 1.0 / (c + 1.0 / k),
        1e3 * shape.deepest(), shape.deepest() / c);
}

}  // namespace

std::string limits_text(const Protocol& protocol,
                        const protocols::Plan& plan,
                        const PlanSummary& summary) {
    const protocols::DesignSpec& design = protocol.design;
    if (design.order == protocols::OrderRule::first_order) {
        return fmt::format(
            "longest runs of main trials: object {}, friction {} (no limit applies)\n"
            "order: first-order balanced, every condition follows every condition once\n",
            summary.longest_object_run, summary.longest_friction_run);
    }
    std::string text = fmt::format(
        "longest runs of main trials: object {} ({}), friction {} ({})\n",
        summary.longest_object_run, limit_text(design.max_run_object), summary.longest_friction_run,
        in_friction_blocks(design) ? std::string("one a block")
                                   : limit_text(design.max_run_friction));
    if (in_friction_blocks(design)) {
        text += "frictions of the blocks:";
        for (const std::size_t friction : friction_of_blocks(design, first_round(protocol, plan))) {
            text += ' ' + protocol.frictions.at(friction).name;
        }
        text += '\n';
    }
    return text + acceptance_text(protocol) +
           fmt::format("order: {}uniform over all within the limits; {}, {} proposed\n",
                       block_count(protocol) > 1 ? "each block, after the one before, " : "",
                       to_string(plan.way), plan.attempts);
}

std::string breaks_text(const PlanSummary& summary) {
    std::string text = "breaks before trials:";
    for (const std::size_t position : summary.breaks) {
        text += fmt::format(" {}", position + 1);
    }
    return text + (summary.breaks.empty() ? " none\n" : "\n");
}

std::string counts_text(const Protocol& protocol, const PlanSummary& summary) {
    std::string text = fmt::format("trials of each condition\n{:<24}", "");
    for (const auto& [part, counts] : summary.counts) {
        text += fmt::format(" {:>9}",
                            part.phase == Phase::practice || block_count(protocol) == 1
                                ? std::string(to_string(part.phase))
                                : fmt::format("{} {}", to_string(part.phase), part.block + 1));
    }
    text += '\n';
    for (std::size_t object = 0; object < protocol.objects.size(); ++object) {
        for (std::size_t friction = 0; friction < protocol.frictions.size(); ++friction) {
            text += fmt::format("{:<24}", fmt::format("{} {}", protocol.objects[object].name,
                                                      protocol.frictions[friction].name));
            for (const auto& [part, counts] : summary.counts) {
                const auto found = counts.find({object, friction});
                text += fmt::format(" {:>9}", found == counts.end() ? 0 : found->second);
            }
            text += '\n';
        }
    }
    return text;
}

std::string steps_text(const Protocol& protocol, const PlanSummary& summary) {
    return steps_of("object", protocol.objects, summary.object_steps) + '\n' +
           steps_of("friction", protocol.frictions, summary.friction_steps);
}

std::string softness_text(const Protocol& protocol) {
    std::string text;
    const auto add = [&](const protocols::ObjectSpec& object, std::string_view whose) {
        text += soft_line(protocol, object, whose);
    };
    const bool varied =
        protocol.procedure && protocol.procedure->varies == protocols::Varies::compliance;
    for (const protocols::ObjectSpec& object : protocol.objects) {
        add(object, "as it stands");
        if (varied && object.name == protocol.procedure->object) {
            for (const double x : {protocol.procedure->lowest, protocol.procedure->highest}) {
                protocols::Presentation felt{.object = object};
                feel_stimulus(*protocol.procedure, x, felt);
                add(felt.object, x == protocol.procedure->lowest ? "at the rule's lowest"
                                                                 : "at the rule's highest");
            }
        }
    }
    if (!text.empty()) {
        text += fmt::format(
            "    Curve and contact give back no more than they took, whatever the compliance: the "
            "device has to\n    damp what {:.6g} N/m ask for, and no more.\n",
            protocol.apparatus.stiffness);
    }
    return text;
}

std::string rule_text(const Protocol& protocol, const protocols::Plan& plan) {
    const protocols::AdaptiveSpec& spec = *protocol.procedure;
    std::string text = fmt::format(
        "a rule chooses {}{} of {} from {} to {} by the answers; rule {}\n", word_of(spec.varies),
        spec.stimulus_as == protocols::StimulusAs::log10 ? " (its decadic logarithm)" : "",
        spec.object, spec.lowest, spec.highest, sha256_hex(spec.rule.text));
    std::map<std::pair<std::size_t, Phase>, std::array<std::size_t, 2>> counts;
    for (const protocols::PlannedTrial& trial : plan.trials) {
        ++counts[{trial.adaptive->run, trial.phase}].at(trial.adaptive->comparison - 1);
    }
    const bool two = protocols::intervals_of(protocol) == 2;
    text += fmt::format("trials of each run{}\n", two ? ", comparison in interval 1 + 2" : "");
    for (std::size_t run = 0; run < protocol.runs.size(); ++run) {
        const protocols::RunSpec& of = protocol.runs[run];
        const std::string& standard =
            of.standard_friction.empty() ? of.friction : of.standard_friction;
        text +=
            fmt::format("{:<24}", two ? fmt::format("{} ({}, {})", of.name, of.friction, standard)
                                      : fmt::format("{} ({})", of.name, of.friction));
        for (const Phase phase : {Phase::practice, Phase::main}) {
            const auto [first, second] = counts[{run, phase}];
            text +=
                fmt::format("  {} {}", to_string(phase),
                            two ? fmt::format("{} + {}", first, second) : fmt::format("{}", first));
        }
        text += '\n';
    }
    return text + fmt::format(
                      "order: uniform over all with at most {} of a run and {} comparisons "
                      "of an interval in a row (0: any); {}, {} proposed\n",
                      spec.max_run, spec.max_run_interval, to_string(plan.way), plan.attempts);
}

}  // namespace palpate::ui
