#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "protocols/design/adaptive_plan.hpp"
#include "protocols/design/counterbalance.hpp"
#include "protocols/design/object_outline.hpp"
#include "protocols/design/plan_summary.hpp"
#include "protocols/design/session_plan.hpp"
#include "protocols/file/keys.hpp"
#include "protocols/session/progress.hpp"
#include "data/store/people.hpp"
#include "data/store/session_store.hpp"
#include "ui/cli/plan_text.hpp"
#include "ui/command/command.hpp"
#include "ui/rig/control_line.hpp"
#include "ui/rig/say.hpp"
#include "ui/session/session_choice.hpp"

namespace palpate::ui {
namespace {

struct SequenceOptions {
    std::string protocol;  ///< a file, or the name of a shipped protocol
    std::string participant;
    std::string database;  ///< empty: an example
    std::string kind = "real";
    std::optional<std::size_t> session;
    std::optional<std::uint64_t> seed;
    bool csv = false;
};

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
    protocols::RowHistory frictions;
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
    warn_of_unblinding(options.database);
    data::Database database(options.database, data::Access::read);
    if (const auto other = data::similar_participant(database, options.participant)) {
        warn("{}: nobody is called {}, and {} is there", options.database, options.participant,
             *other);
    }
    const SessionChoice choice =
        choose_session(database, made.study, options.participant, options.session, options.seed);
    made.key = choice.there.run_as;
    made.seed = choice.seed;
    const auto rows = rows_taken(database, made.study.protocol, choice.key, options.kind);
    made.history = rows.pictures;
    made.frictions = rows.frictions;
    made.plan = make_plan(made.study.protocol, made.study.hash, made.key, made.seed, made.history,
                          made.frictions);
    refuse_if(choice.there.begun && made.plan.hash != choice.there.plan_hash,
              "{}: session {} of {} was begun with another version of {}, or another seed: give "
              "those; the plan that it has is in the table plan",
              options.database, choice.key.session, choice.key.participant, made.study.protocol.id);
    return made;
}

void print_csv(const Sequence& sequence) {
    const Protocol& protocol = sequence.study.protocol;
    if (protocol.procedure) {
        say("position,phase,block,run,comparison,object,friction,standard_friction,break_before\n");
        for (const PlannedTrial& trial : sequence.plan.trials) {
            say("{},{},{},{},{},{},{},{},{}\n", trial.position, to_string(trial.phase), trial.block,
                protocol.runs.at(trial.adaptive->run).name, trial.adaptive->comparison,
                protocol.objects.at(trial.condition.object).name,
                protocol.frictions.at(trial.condition.friction).name,
                protocol.frictions.at(trial.adaptive->standard_friction).name,
                trial.break_before ? 1 : 0);
        }
        return;
    }
    say("position,phase,block,object,curvature_per_m,friction,mu_s,mu_d,break_before\n");
    for (const PlannedTrial& trial : sequence.plan.trials) {
        const auto& object = protocol.objects.at(trial.condition.object);
        const auto& friction = protocol.frictions.at(trial.condition.friction);
        const auto curvature = curvature_of(object);
        say("{},{},{},{},{},{},{},{},{}\n", trial.position, to_string(trial.phase), trial.block,
            object.name, curvature ? fmt::format("{}", *curvature) : std::string(), friction.name,
            friction.mu_s, friction.mu_d, trial.break_before ? 1 : 0);
    }
}

/// Which row of a Williams design an order is, and who used which.
void print_row(std::string_view what,
               const std::vector<std::vector<std::size_t>>& rows,
               const std::vector<std::size_t>& order,
               const protocols::RowHistory& history) {
    const auto row = static_cast<std::size_t>(
        std::distance(rows.begin(), std::find(rows.begin(), rows.end(), order)));
    say("  {}: row {} of {} of the Williams design", what, row + 1, rows.size());
    if (history.own) {
        say(", as in this participant's earlier sessions");
    } else if (row < history.uses.size()) {
        say(", used by {}; used so far:", counted(history.uses[row], "other participant"));
        for (const std::size_t uses : history.uses) {
            say(" {}", uses);
        }
    }
    say("\n");
}

void print_pictures(const Sequence& sequence) {
    const Protocol& protocol = sequence.study.protocol;
    const auto rows = picture_rows(protocol);
    say("pictures, left to right:");
    for (const std::size_t object : sequence.plan.picture_order) {
        say(" {}", protocol.objects.at(object).name);
    }
    say("\n");
    print_row("pictures", rows, sequence.plan.picture_order, sequence.history);
    if (in_friction_blocks(protocol.design)) {
        print_row("friction blocks", friction_rows(protocol), first_round(protocol, sequence.plan),
                  sequence.frictions);
    }
}

/// What is known of a rule's stimuli before anybody answers: what it shows once all answers were of
/// the first kind, and once all were of the last.
class KnownStimuli {
public:
    explicit KnownStimuli(const Sequence& sequence)
        : protocol_(sequence.study.protocol),
          alike_(2, {protocol_, session_stream(sequence.study.hash, sequence.key, sequence.seed)}) {
    }
    /// Of the next trial: "mu 0.9", or "mu 0.45 to 1.2" where it hangs on the answers.
    std::string next(const PlannedTrial& trial) {
        const protocols::AdaptiveSpec& rule = *protocol_.procedure;
        std::vector<double> felt;
        for (protocols::AdaptiveRuns& runs : alike_) {
            const std::size_t run = trial.adaptive->run;
            const double shown = *stimulus_for(protocol_, trial, runs);
            felt.push_back(felt_value(rule, shown));
            if (trial.phase != protocols::Phase::practice) {
                const bool last = felt.size() > 1;
                runs.update({.run = run,
                             .stimulus = shown,
                             .outcome = last ? runs.of(run).outcomes() - 1 : 0});
            }
        }
        std::ranges::sort(felt);
        return fmt::format("{} {:.4g}", word_of(rule.varies), felt.front()) +
               (felt.front() == felt.back() ? "" : fmt::format(" to {:.4g}", felt.back()));
    }

private:
    const Protocol& protocol_;
    std::vector<protocols::AdaptiveRuns> alike_;
};

void print_rule_trials(const Sequence& sequence) {
    say("\nWhere two numbers stand, answers that are all alike lead to one of them.\n");
    KnownStimuli known(sequence);
    for (const PlannedTrial& trial : sequence.plan.trials) {
        say("trial {:>3}  {:<8}  {:<11} comparison in interval {}, {}{}\n", trial.position + 1,
            to_string(trial.phase), sequence.study.protocol.runs.at(trial.adaptive->run).name,
            trial.adaptive->comparison, known.next(trial),
            trial.break_before ? "  (after a break)" : "");
    }
}

void print_trials(const Sequence& sequence) {
    const Protocol& protocol = sequence.study.protocol;
    say("\n");
    for (const PlannedTrial& trial : sequence.plan.trials) {
        say("trial {:>3}  {:<8}  {:<11} friction {}{}\n", trial.position + 1,
            to_string(trial.phase), protocol.objects.at(trial.condition.object).name,
            protocol.frictions.at(trial.condition.friction).name,
            trial.break_before ? "  (after a break)" : "");
    }
}

void print_text(const Sequence& sequence) {
    const Protocol& protocol = sequence.study.protocol;
    const PlanSummary summary = summarise(sequence.plan);
    if (sequence.key.secret.empty()) {
        say("An example: each file draws its own orders, and --db FILE shows them.\n");
    }
    say("{}: drawn for participant {}, session {}, seed {}, {}, code {}\n", protocol.id,
        sequence.key.participant, sequence.key.session, sequence.seed,
        counted(sequence.plan.trials.size(), "trial"), session_code(sequence.plan));
    say("plan {}\nprotocol {}\n", sequence.plan.hash, sequence.study.hash);
    if (!sequence.plan.picture_order.empty()) {
        print_pictures(sequence);
    }
    if (protocol.procedure) {
        say("{}{}", rule_text(protocol, sequence.plan), breaks_text(summary));
        print_rule_trials(sequence);
        return;
    }
    say("{}", limits_text(protocol, sequence.plan, summary));
    say("{}\n{}\n{}", breaks_text(summary), counts_text(protocol, summary),
        steps_text(protocol, summary));
    print_trials(sequence);
}

void declare(CommandWords& words, SequenceOptions& options) {
    words.add("PROTOCOL", options.protocol, "A protocol file, or the name of a shipped one")
        .required();
    words.add("--participant", options.participant, "Pseudonymous id: letters, digits, - and _")
        .required();
    words.add("--db", options.database,
              "The study's database: who already ran decides the order of the pictures");
    words.add("--session", options.session, "Session number; without it the last one, or the first")
        .above_zero();
    words.add("--kind", options.kind, "What a session that has not begun will be recorded as")
        .among({"real", "pilot", "simulated"});
    words.add("--seed", options.seed, "Study seed instead of the protocol's");
    words.add("--csv", options.csv, "The trials alone, as CSV");
}

int run(const SequenceOptions& options) {
    const Sequence sequence = make_sequence(options);
    if (options.csv) {
        if (sequence.key.secret.empty()) {
            warn("this is an example: each file draws its own orders, and --db FILE shows them");
        }
        print_csv(sequence);
    } else {
        print_text(sequence);
    }
    return 0;
}

}  // namespace

Command sequence_command() {
    return make_command<SequenceOptions>(
        "sequence", "Print the plan that run would carry out, without running it", declare, run);
}

}  // namespace palpate::ui
