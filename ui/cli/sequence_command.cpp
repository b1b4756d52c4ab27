#include <map>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "protocols/design/acceptance.hpp"
#include "protocols/design/plan_summary.hpp"
#include "protocols/design/session_plan.hpp"
#include "data/store/counterbalance_query.hpp"
#include "ui/cli/commands.hpp"
#include "ui/cli/session_choice.hpp"

namespace palpate::ui {
namespace {

using protocols::Condition;
using protocols::Phase;
using protocols::Plan;
using protocols::PlannedTrial;
using protocols::PlanSummary;
using protocols::Protocol;

/// A plan with what it was made from.
struct Sequence {
    Study study;
    protocols::SessionKey key;
    std::uint64_t seed = 0;
    protocols::RowHistory history;
    Plan plan;
};

Sequence make_sequence(const SequenceOptions& options) {
    check_participant(options.participant);
    Sequence made;
    made.study = load_study(options.protocol);
    if (options.database.empty()) {
        made.key = {options.participant, options.session.value_or(1)};
        made.seed = options.seed.value_or(made.study.protocol.seed);
        made.plan = make_plan(made.study.protocol, made.study.hash, made.key, made.seed);
        return made;
    }
    data::Database database(options.database, data::Access::read);
    const SessionChoice choice =
        choose_session(database, made.study, options.participant, options.session, options.seed);
    made.key = choice.key;
    made.seed = choice.seed;
    const auto seen = data::picture_orders(database, made.study.protocol.id, made.key);
    made.history = picture_history(made.study.protocol, seen.others, seen.own);
    made.plan = plan_session(database, made.study, made.key, made.seed);
    return made;
}

void print_csv(const Sequence& sequence) {
    const Protocol& protocol = sequence.study.protocol;
    fmt::print("position,phase,block,object,curvature_per_m,friction,mu_s,mu_d,break_before\n");
    for (const PlannedTrial& trial : sequence.plan.trials) {
        const auto& object = protocol.objects.at(trial.condition.object);
        const auto& friction = protocol.frictions.at(trial.condition.friction);
        fmt::print("{},{},{},{},{},{},{},{},{}\n", trial.position, to_string(trial.phase),
                   trial.block, object.name, object.curvature, friction.name, friction.mu_s,
                   friction.mu_d, trial.break_before ? 1 : 0);
    }
}

void print_pictures(const Sequence& sequence) {
    const Protocol& protocol = sequence.study.protocol;
    const auto rows = picture_rows(protocol);
    fmt::print("pictures, left to right:");
    for (const std::size_t object : sequence.plan.picture_order) {
        fmt::print(" {}", protocol.objects.at(object).name);
    }
    std::size_t row = 0;
    while (rows[row] != sequence.plan.picture_order) {
        ++row;
    }
    fmt::print("\n  row {} of {} of the Williams design", row + 1, rows.size());
    if (sequence.history.own) {
        fmt::print(", as in this participant's earlier sessions");
    } else if (!sequence.history.uses.empty()) {
        fmt::print(", used by {} other participants; used so far:", sequence.history.uses[row]);
        for (const std::size_t uses : sequence.history.uses) {
            fmt::print(" {}", uses);
        }
    }
    fmt::print("\n");
}

std::string limit_text(std::size_t limit) {
    return limit == 0 ? "no limit" : fmt::format("limit {}", limit);
}

/// How the limits were kept, and how few shuffles would.
void print_limits(const Sequence& sequence, const PlanSummary& summary) {
    const protocols::DesignSpec& design = sequence.study.protocol.design;
    fmt::print("longest runs of main trials: object {} ({}), friction {} ({})\n",
               summary.longest_object_run, limit_text(design.max_run_object),
               summary.longest_friction_run, limit_text(design.max_run_friction));
    if (design.order == protocols::OrderRule::first_order) {
        fmt::print("order: first-order balanced, every condition follows every condition once\n");
        return;
    }
    const auto trials = factorial(sequence.study.protocol, design.repetitions / design.blocks);
    const protocols::RunLimits limits{design.max_run_object, design.max_run_friction};
    const auto all = acceptance_of(trials, limits);
    fmt::print(
        "acceptance of whole shuffles: {:.3g} ({})\n", all.share,
        all.exact ? std::string("exact") : fmt::format("estimate, +- {:.1g} %", 100.0 * all.error));
    const auto object = acceptance_of_one(trials, &Condition::object, limits.object);
    const auto friction = acceptance_of_one(trials, &Condition::friction, limits.friction);
    if (object && friction) {
        fmt::print("  of the limits alone, exact: object {:.3g}, friction {:.3g}\n", *object,
                   *friction);
    }
    fmt::print("order: uniform over all within the limits; {}, {} proposed\n",
               to_string(sequence.plan.way), sequence.plan.attempts);
}

void print_counts(const Protocol& protocol, const PlanSummary& summary) {
    fmt::print("\ntrials of each condition\n{:<24}", "");
    for (const auto& [part, counts] : summary.counts) {
        fmt::print(" {:>9}", part.phase == Phase::practice || protocol.design.blocks == 1
                                 ? std::string(to_string(part.phase))
                                 : fmt::format("{} {}", to_string(part.phase), part.block + 1));
    }
    fmt::print("\n");
    for (std::size_t object = 0; object < protocol.objects.size(); ++object) {
        for (std::size_t friction = 0; friction < protocol.frictions.size(); ++friction) {
            fmt::print("{:<24}", fmt::format("{} {}", protocol.objects[object].name,
                                             protocol.frictions[friction].name));
            for (const auto& [part, counts] : summary.counts) {
                const auto found = counts.find({object, friction});
                fmt::print(" {:>9}", found == counts.end() ? 0 : found->second);
            }
            fmt::print("\n");
        }
    }
}

template <class Spec>
void print_steps(std::string_view factor,
                 const std::vector<Spec>& levels,
                 const std::map<std::size_t, std::map<std::size_t, std::size_t>>& steps) {
    fmt::print("\nfrom one main trial to the next, {} (down: from, across: to)\n{:<14}", factor,
               "");
    std::set<std::size_t> seen;
    for (const auto& [from, row] : steps) {
        seen.insert(from);
        for (const auto& [to, count] : row) {
            seen.insert(to);
        }
    }
    for (const std::size_t to : seen) {
        fmt::print(" {:>11}", levels.at(to).name);
    }
    fmt::print("\n");
    for (const std::size_t from : seen) {
        fmt::print("{:<14}", levels.at(from).name);
        for (const std::size_t to : seen) {
            const auto row = steps.find(from);
            fmt::print(" {:>11}",
                       row != steps.end() && row->second.count(to) != 0 ? row->second.at(to) : 0);
        }
        fmt::print("\n");
    }
}

void print_trials(const Sequence& sequence) {
    const Protocol& protocol = sequence.study.protocol;
    fmt::print("\n");
    for (const PlannedTrial& trial : sequence.plan.trials) {
        fmt::print("trial {:>3}  {:<8}  {:<11} friction {}{}\n", trial.position + 1,
                   to_string(trial.phase), protocol.objects.at(trial.condition.object).name,
                   protocol.frictions.at(trial.condition.friction).name,
                   trial.break_before ? "  (after a break)" : "");
    }
}

void print_text(const Sequence& sequence) {
    const Protocol& protocol = sequence.study.protocol;
    const PlanSummary summary = summarise(sequence.plan);
    fmt::print("{}: participant {}, session {}, seed {}, {} trials, code {}\n", protocol.id,
               sequence.key.participant, sequence.key.session, sequence.seed,
               sequence.plan.trials.size(), session_code(sequence.plan));
    fmt::print("plan {}\nprotocol {}\n", sequence.plan.hash, sequence.study.hash);
    print_pictures(sequence);
    print_limits(sequence, summary);
    fmt::print("breaks before trials:");
    for (const std::size_t position : summary.breaks) {
        fmt::print(" {}", position + 1);
    }
    fmt::print("{}\n", summary.breaks.empty() ? " none" : "");
    print_counts(protocol, summary);
    print_steps("object", protocol.objects, summary.object_steps);
    print_steps("friction", protocol.frictions, summary.friction_steps);
    print_trials(sequence);
}

}  // namespace

int sequence_command(const SequenceOptions& options) {
    const Sequence sequence = make_sequence(options);
    if (options.csv) {
        print_csv(sequence);
    } else {
        print_text(sequence);
    }
    return 0;
}

}  // namespace palpate::ui
