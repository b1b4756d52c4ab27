#include <algorithm>
#include <cmath>
#include <exception>
#include <optional>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "protocols/file/protocol_file.hpp"
#include "data/analysis/people_text.hpp"
#include "data/statistics/wilson.hpp"
#include "data/store/adaptive_store.hpp"

namespace palpate::data {
namespace {

using protocols::Estimate;
using protocols::Protocol;

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
        "SELECT participant_code, session_number, session_id, run_number, run_name, count(*),"
        " sum(NOT counts), sum(correct IS NULL) FROM analysis_trial WHERE study_name = ?1 AND"
        " session_kind = ?2 AND run_trial_number IS NOT NULL GROUP BY session_id, run_number"
        " ORDER BY participant_code, session_number, run_number");
    row.bind(1, group.study).bind(2, group.kind);
    std::vector<Run> all;
    while (row.step()) {
        all.push_back({row.text(0), row.integer(1), row.integer(2), row.integer(3), row.text(4),
                       row.integer(5), row.integer(6), row.integer(7)});
    }
    return all;
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

std::string estimate_line(const Estimate& one, std::size_t width) {
    std::string text = fmt::format("      {:<{}}  ", one.name, width);
    if (!one.mean) {
        return text + "unknown: it has no reversal yet\n";
    }
    text += fmt::format("{:<8.4g}  sd {:<8}", *one.mean,
                        one.sd ? fmt::format("{:.4g}", *one.sd) : "unknown");
    if (one.low && one.high) {
        text += fmt::format("  {:.4g} to {:.4g}", *one.low, *one.high);
        text += one.cut && !of_a_share(one.name)
                  ? "   (to the end of the protocol's grid: it may be further out)"
                  : "";
    } else {
        text += fmt::format("  {}", counted(one.reversals, "reversal"));
    }
    return text + '\n';
}

/// How often each stimulus of a rule that estimates nothing was answered with 1.
std::string constant_lines(Database& database, const Run& run) {
    Statement row = database.prepare(
        "SELECT stimulus, sum(rule_outcome), count(*), max(rule_outcome) FROM analysis_trial WHERE"
        " session_id = ?1 AND run_number = ?2 AND counts GROUP BY stimulus ORDER BY stimulus");
    row.bind(1, run.session).bind(2, run.run);
    std::string text;
    while (row.step()) {
        if (row.integer(3) > 1) {
            return "      more than two answers: SELECT stimulus, rule_outcome FROM analysis_trial "
                   "WHERE run_trial_number IS NOT NULL\n";
        }
        const Interval ci = wilson(row.integer(1), row.integer(2));
        text +=
            fmt::format("      at {:<8.4g}  {:>3} of {:>3} = {:.2f} ({:.2f} to {:.2f})\n",
                        row.real(0), row.integer(1), row.integer(2),
                        static_cast<double>(row.integer(1)) / static_cast<double>(row.integer(2)),
                        ci.low, ci.high);
    }
    return text;
}

std::string head_line(const Run& run, const Protocol& protocol) {
    std::string text =
        fmt::format("    {} session {}, run {}: {} of {}", run.person, run.number, run.name,
                    run.answers, counted(protocol.procedure->trials, "answer"));
    if (run.marked > 0) {
        text += fmt::format(", {} of them marked later and left out", run.marked);
    }
    return text + fmt::format("; {} without correct\n", run.no_correct);
}

/// By the name of an estimate, in their order; a person's mean is that over their sessions.
using Means = std::vector<PeopleTable>;

void add(Means& means, const std::string& estimate, const Run& run, double mean) {
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

std::string run_text(Database& database, const Run& run, const Protocol& protocol, Means& means) {
    std::string text = head_line(run, protocol);
    try {
        const auto runs = runs_that_count(database, run.session);
        const protocols::Procedure& procedure = runs.of(static_cast<std::size_t>(run.run));
        std::vector<Estimate> all = procedure.estimates();
        if (all.empty()) {
            return text + constant_lines(database, run);
        }
        const std::optional<Estimate> jnd = procedure.jnd();
        if (jnd) {
            all.insert(all.begin() + 1, *jnd);
        }
        std::size_t width = 0;
        for (const Estimate& one : all) {
            width = std::max(width, one.name.size());
        }
        for (const Estimate& one : all) {
            text += estimate_line(one, width);
            const bool of_people = !jnd || one.name == "threshold" || one.name == "JND";
            if (one.mean && procedure.trials() > 0 && of_people && !of_a_share(one.name)) {
                add(means, one.name, run, *one.mean);
            }
        }
        return text;
    } catch (const std::exception&) {  // what was stored is not what the rule takes
        return text + "      unknown; palpate verify says more\n";
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
    std::string operator()(const protocols::PsiSpec& spec) const {
        return (*this)(quest_plus_spec(spec));
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
                      " threshold: the point of equality (PSE), where {}\n  as often as "
                      "the standard.",
                      one())
                : fmt::format(" threshold: {} of the way from guesses to\n  lapses.", percent(at));
        return text +
               " JND: half the distance between the stimuli at 25 % and 75 % of that way, from the "
               "slope\n  (normal: 0.674 sd; logistic: 1.0986 / slope).\n";
    }
};

std::string standard_text(const Protocol& protocol) {
    const protocols::AdaptiveSpec& rule = *protocol.procedure;
    const bool curvature = rule.varies == protocols::Varies::curvature;
    const bool soft = rule.varies == protocols::Varies::compliance;
    std::string text = fmt::format(
        "  Stimuli: {}{}.", rule.stimulus_as == protocols::StimulusAs::log10 ? "log10 of " : "",
        curvature ? "curvature in 1/m"
        : soft    ? "compliance in mm/N"
                  : "static friction coefficient");
    if (protocol.response.kind != protocols::ResponseKind::two_interval) {
        return text + '\n';
    }
    for (const protocols::RunSpec& run : protocol.runs) {
        double standard = 0.0;
        for (const auto& object : protocol.objects) {
            if (object.name == rule.object) {
                standard = curvature ? object.curvature : soft ? 1e3 * object.compliance : standard;
            }
        }
        for (const auto& friction : protocol.frictions) {
            const std::string& name =
                run.standard_friction.empty() ? run.friction : run.standard_friction;
            standard = !curvature && !soft && friction.name == name ? friction.mu_s : standard;
        }
        text += fmt::format("{}{}: standard {:g}", &run == protocol.runs.data() ? " Run " : ", ",
                            run.name, standard);
    }
    return text + ".\n";
}

std::string legend(const Protocol& protocol) {
    const protocols::ProcedureSpec& spec = *protocol.procedure->rule.spec;
    return standard_text(protocol) +
           std::visit(Meaning{protocol.response.kind == protocols::ResponseKind::two_interval},
                      spec);
}

/// Runs, what is said of each, and the means of each estimate.
struct RunsRead {
    std::vector<Run> runs;
    std::string text;
    Means means;
    std::optional<Protocol> protocol;  ///< of the last
};

RunsRead read_runs(Database& database, const Group& group) {
    RunsRead read{.runs = runs_of(database, group), .text = {}, .means = {}, .protocol = {}};
    for (const Run& run : read.runs) {
        read.protocol = protocol_of(database, run.session);
        if (!read.protocol || !read.protocol->procedure) {
            read.text += fmt::format("    {} session {}: unknown; palpate verify says more\n",
                                     run.person, run.number);
            continue;
        }
        read.text += run_text(database, run, *read.protocol, read.means);
    }
    // Whoever came first: the first run is what others are less.
    for (PeopleTable& table : read.means) {
        std::ranges::stable_sort(table.conditions, {}, [&](const std::string& name) {
            return std::ranges::min(
                       read.runs, {},
                       [&](const Run& run) { return std::pair(run.name != name, run.run); })
                .run;
        });
    }
    return read;
}

}  // namespace

std::vector<PeopleTable> runs_tables(Database& database, const Group& group) {
    return read_runs(database, group).means;
}

std::string runs_text(Database& database,
                      const Group& group,
                      const std::set<std::string>& left_out) {
    const RunsRead read = read_runs(database, group);
    if (read.runs.empty()) {
        return {};
    }
    std::string text;
    if (left_out.empty()) {
        text = "\n  what the rule estimates, run by run\n";
        text += read.protocol && read.protocol->procedure ? legend(*read.protocol) : std::string();
        text += read.text;
    }
    for (const PeopleTable& table : read.means) {
        text += people_text(table, left_out);
    }
    return text;
}

}  // namespace palpate::data
