#include <algorithm>
#include <cmath>
#include <exception>
#include <optional>

#include <fmt/format.h>

#include "protocols/file/protocol_file.hpp"
#include "data/analysis/summary.hpp"
#include "data/statistics/distributions.hpp"
#include "data/store/stored_progress.hpp"

namespace palpate::data {
namespace {

using protocols::Estimate;
using protocols::Protocol;
using protocols::ResponseKind;

constexpr const char* kVerify = "unknown; palpate verify says more";

/// A run of a session that has at least one answer.
struct Run {
    std::string person;
    std::int64_t number = 0;   ///< of the session
    std::int64_t session = 0;  ///< session.id
    std::int64_t run = 0;
    std::string name;
    std::int64_t answers = 0;
    std::int64_t marked = 0;  ///< of these
    std::int64_t no_correct = 0;
};

std::vector<Run> runs_of(Database& database, const Group& group) {
    Statement row = database.prepare(
        "SELECT participant_code, session_number, session_id, run_number, run_name, count(*), "
        "sum(NOT counts), sum(correct IS NULL) FROM analysis_trial WHERE study_name = ?1 AND "
        "session_kind = ?2 AND run_trial_number IS NOT NULL GROUP BY session_id, run_number ORDER "
        "BY participant_code, session_number, run_number",
        group.study, group.kind);
    return row.all([](const Statement& one) {
        return Run{one.text(0), one.integer(1), one.integer(2), one.integer(3),
                   one.text(4), one.integer(5), one.integer(6), one.integer(7)};
    });
}

std::optional<Protocol> protocol_of(Database& database, std::int64_t session) {
    Statement row = database.prepare(
        "SELECT protocol_toml FROM session JOIN study USING (study_id) WHERE session.session_id = "
        "?1");
    try {
        return row.bind(1, session).step() ? std::optional(protocols::stored_protocol(row.text(0)))
                                           : std::nullopt;
    } catch (const protocols::ProtocolError&) {
        return std::nullopt;  // palpate verify says it
    }
}

bool of_a_share(std::string_view name) {
    return name == "lapse" || name == "guess";
}

/// Of a session, a run of its rule: the first cells of a row, and more.
void add_row(Table& table, const Run& run, const std::vector<Cell>& more) {
    auto& row = table.rows.emplace_back(std::vector<Cell>{run.person, run.number, run.name});
    row.insert(row.end(), more.begin(), more.end());
}

/// A row for each run, with more columns.
Table of_runs(std::string place, std::vector<Column> more) {
    Table table{
        .place = std::move(place), .columns = heads({"person", "session", "run"}), .index = 3};
    table.columns.insert(table.columns.end(), more.begin(), more.end());
    return table;
}

RuleRuns nothing_found() {
    RuleRuns found{
        .runs = of_runs("runs/-", heads({"answers", "planned|of", "marked|marked, left out",
                                         "no_correct|without correct"})),
        .estimates =
            of_runs("estimates/-", heads({"estimate", "mean|mean|s", "sd|sd|s",
                                          "interval_95|interval|s", "reversals", "remark| "})),
        .shares = of_runs("shares/-", heads({"stimulus|at|s", "k", "n|of n", "share|share|2",
                                             "interval_95|interval|2"}))};
    found.estimates.index = 4;
    return found;
}

void add_estimate(RuleRuns& found, const Run& run, const Estimate& one) {
    const bool interval = one.low && one.high;
    const bool further = interval && one.cut && !of_a_share(one.name);
    add_row(found.estimates, run,
            {one.name, cell_of(one.mean, "unknown: it has no reversal yet"), cell_of(one.sd),
             interval ? Cell(Interval{*one.low, *one.high}) : Cell(Nothing{}),
             interval ? Cell(Nothing{}) : cell_of(one.reversals),
             further ? Cell("to the end of the protocol's grid: it may be further out")
                     : Cell(Nothing{})});
}

/// How often each stimulus of a rule that estimates nothing was answered with 1.
void add_shares(RuleRuns& found, Database& database, const Run& run, ResponseKind kind) {
    if (kind != ResponseKind::two_interval && kind != ResponseKind::yes_no) {
        add_row(found.shares, run,
                {Nothing{"more than two answers: SELECT stimulus, rule_outcome FROM "
                         "analysis_trial WHERE run_trial_number IS NOT NULL"},
                 Nothing{}, Nothing{}, Nothing{}, Nothing{}});
        return;
    }
    Statement row = database.prepare(
        "SELECT stimulus, sum(rule_outcome), count(*) FROM analysis_trial WHERE "
        "session_id = ?1 AND run_number = ?2 AND run_trial_number IS NOT NULL AND counts "
        "GROUP BY stimulus ORDER BY stimulus",
        run.session, run.run);
    while (row.step()) {
        const std::int64_t k = row.integer(1);
        const std::int64_t n = row.integer(2);
        add_row(found.shares, run,
                {row.real(0), k, n, static_cast<double>(k) / static_cast<double>(n), wilson(k, n)});
    }
}

/// Tables by the name of an estimate, in their order; a person's mean is that over their sessions.
void add(std::vector<PeopleTable>& means,
         const std::string& estimate,
         const Run& run,
         double mean) {
    auto table = std::ranges::find(means, estimate, &PeopleTable::what);
    if (table == means.end()) {
        means.push_back({.what = estimate, .factor = "run", .share = false});
        table = means.end() - 1;
    }
    if (std::ranges::find(table->conditions, run.name) == table->conditions.end()) {
        table->conditions.push_back(run.name);
    }
    Own& own = table->people[run.person][run.name];
    ++own.n;
    own.mean += (mean - own.mean) / static_cast<double>(own.n);
}

void add_run(RuleRuns& found, Database& database, const Run& run, const Protocol& protocol) {
    add_row(found.runs, run,
            {run.answers, cell_of(protocol.procedure->trials), run.marked, run.no_correct});
    try {
        const auto runs = runs_that_count(database, run.session);
        const protocols::Procedure& procedure = runs.of(static_cast<std::size_t>(run.run));
        std::vector<Estimate> all = procedure.estimates();
        if (all.empty()) {
            add_shares(found, database, run, protocol.response.kind);
            return;
        }
        const std::optional<Estimate> jnd = procedure.jnd();
        if (jnd) {
            all.insert(all.begin() + 1, *jnd);
        }
        for (const Estimate& one : all) {
            add_estimate(found, run, one);
            const bool of_people = !jnd || one.name == "threshold" || one.name == "JND";
            if (one.mean && procedure.trials() > 0 && of_people && !of_a_share(one.name)) {
                add(found.means, one.name, run, *one.mean);
            }
        }
    } catch (const std::exception&) {  // what was stored is not what the rule takes
        found.runs.rows.back()[3] = Nothing{kVerify};
    }
}

std::string percent(double share) {
    return fmt::format("{:.3g} %", 100.0 * share);
}

/// Where on its curve a threshold stands.
struct Meaning {
    bool two_intervals = false;

    std::string one() const {
        return two_intervals ? "the rule's interval is named" : "the answer is 1 (yes)";
    }
    std::string operator()(const protocols::ConstantStimuliSpec& /*spec*/) const {
        return fmt::format(
            "  The rule estimates nothing. Shares: how often {}, Wilson interval of 95 %.\n",
            one());
    }
    std::string operator()(const std::vector<protocols::StaircaseSpec>& specs) const {
        std::string text = fmt::format(
            "  Mean and sd of each staircase's last reversals; these are not independent: no "
            "interval. No slope: no JND.\n  A staircase stands still where {} in",
            one());
        for (const auto& spec : specs) {
            const double at = target(spec);
            text += fmt::format("{} {} ({})", &spec == specs.data() ? "" : ",",
                                std::isfinite(at) ? percent(at) : "50 %", spec.name);
        }
        return text + ".\n";
    }
    std::string operator()(const protocols::QuestSpec& spec) const {
        return fmt::format(
            "  threshold: where {} in {}; of the posterior mean, sd, 95 % credible interval. The "
            "slope is\n  assumed (beta {:g}), so no JND is estimated.\n",
            one(), percent(spec.p_threshold), spec.beta);
    }
    std::string operator()(const protocols::QuestPlusSpec& spec) const {
        std::string text = "  Of the posterior: mean, sd, 95 % credible interval (on its grid).";
        if (!spec.model.shape) {
            return text + '\n';
        }
        const auto& [family, form, slope_as] = *spec.model.shape;
        const double at = core(family, 1.0, 1.0, 1.0);
        text +=
            two_intervals && form == protocols::LapseForm::two_sided && at == 0.5
                ? fmt::format(
                      " threshold: the point of equality (PSE), where {}\n  as often as the "
                      "standard.",
                      one())
                : fmt::format(" threshold: {} of the way from guesses to\n  lapses.", percent(at));
        return text +
               " JND: half the distance between the stimuli at 25 % and 75 % of that way, from the "
               "slope\n  (normal: 0.674 sd; logistic: 1.0986 / slope).\n";
    }
};

std::string standard_text(const Protocol& protocol) {
    using protocols::Varies;
    const protocols::AdaptiveSpec& rule = *protocol.procedure;
    std::string text = fmt::format("  Stimuli: {}.", stimulus_text(protocol));
    if (protocol.response.kind != protocols::ResponseKind::two_interval) {
        return text + '\n';
    }
    const auto object =
        std::ranges::find(protocol.objects, rule.object, &protocols::ObjectSpec::name);
    for (const protocols::RunSpec& run : protocol.runs) {
        const auto friction =
            std::ranges::find(protocol.frictions,
                              run.standard_friction.empty() ? run.friction : run.standard_friction,
                              &protocols::FrictionSpec::name);
        text += fmt::format("{}{}: standard {:g}", &run == protocol.runs.data() ? " Run " : ", ",
                            run.name,
                            rule.varies == Varies::curvature    ? object->curvature
                            : rule.varies == Varies::compliance ? 1e3 * object->compliance
                                                                : friction->mu_s);
    }
    return text + ".\n";
}

std::string legend(const Protocol& protocol) {
    const protocols::ProcedureSpec& spec = *protocol.procedure->rule.spec;
    std::string text =
        standard_text(protocol) +
        std::visit(Meaning{protocol.response.kind == protocols::ResponseKind::two_interval}, spec);
    text.pop_back();  // the line's end
    return text;
}

}  // namespace

std::string stimulus_text(const Protocol& protocol) {
    const auto& rule = protocol.procedure;
    const auto varies = rule ? rule->varies : protocols::Varies::curvature;
    const bool log = rule && rule->stimulus_as == protocols::StimulusAs::log10;
    return fmt::format("{}{}", log ? "log10 of " : "",
                       varies == protocols::Varies::curvature    ? "curvature in 1/m"
                       : varies == protocols::Varies::compliance ? "compliance in mm/N"
                                                                 : "static friction coefficient");
}

RuleRuns rule_runs(Database& database, const Group& group) {
    RuleRuns found = nothing_found();
    const std::vector<Run> runs = runs_of(database, group);
    std::optional<Protocol> protocol;  // of the last
    for (const Run& run : runs) {
        protocol = protocol_of(database, run.session);
        if (protocol && protocol->procedure) {
            add_run(found, database, run, *protocol);
        } else {
            add_row(found.runs, run, {Nothing{kVerify}, Nothing{}, Nothing{}, Nothing{}});
        }
    }
    // Whoever came first: the first run is what others are less.
    for (PeopleTable& table : found.means) {
        std::ranges::stable_sort(table.conditions, {}, [&](const std::string& name) {
            return std::ranges::min(
                       runs, {},
                       [&](const Run& run) { return std::pair(run.name != name, run.run); })
                .run;
        });
    }
    found.runs.title = "  what the rule estimates, run by run";
    if (protocol && protocol->procedure) {
        found.runs.title += '\n' + legend(*protocol);
    }
    return found;
}

std::string runs_text(const RuleRuns& found, const std::set<std::string>& left_out) {
    std::string text;
    if (left_out.empty()) {
        text = table_text(found.runs) + table_text(found.estimates) + table_text(found.shares);
    }
    for (const PeopleTable& table : found.means) {
        text += people_text(without(table, left_out));
    }
    return text;
}

}  // namespace palpate::data
