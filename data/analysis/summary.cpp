#include "data/analysis/summary.hpp"

#include <algorithm>
#include <exception>
#include <map>
#include <set>
#include <vector>

#include <fmt/format.h>

#include "protocols/design/counted.hpp"
#include "protocols/format/protocol_file.hpp"
#include "data/analysis/exclusion.hpp"
#include "data/analysis/wilson.hpp"
#include "data/store/adaptive_store.hpp"

namespace palpate::data {
namespace {

struct Group {
    std::string study;
    std::string kind;
};

/// Files of schema 3 and before have no view invalid_trial, those before 5 no view adaptive_trial.
bool knows(Database& database, std::string_view view) {
    return database.prepare("SELECT 1 FROM sqlite_schema WHERE name = ?1").bind(1, view).step();
}

std::vector<Group> groups(Database& database) {
    std::string sql = "SELECT study, kind FROM trial_result WHERE phase = 'main'";
    if (knows(database, "invalid_trial")) {
        sql += " UNION SELECT study, kind FROM invalid_trial WHERE phase = 'main'";
    }
    std::vector<Group> all;
    Statement row = database.prepare("SELECT DISTINCT * FROM (" + sql + ") ORDER BY kind, study");
    while (row.step()) {
        all.push_back({row.text(0), row.text(1)});
    }
    return all;
}

std::string title(const Group& group) {
    std::string text = fmt::format("Study {}, {} data", group.study, group.kind);
    if (group.kind == "simulated") {
        text += ": participant and device are SIMULATED";
    } else if (group.kind == "pilot") {
        text += ": PILOT, not for analysis";
    }
    return text + "\n";
}

/// Everything felt or chosen in main trials, and everything that will be: from concave to convex.
std::vector<std::string> objects(Database& database, const Group& group) {
    std::vector<std::string> names;
    Statement row = database.prepare(
        "SELECT object FROM plan JOIN session ON session.id = plan.session"
        " JOIN study ON study.id = session.study WHERE name = ?1 AND kind = ?2 AND phase = 'main'"
        " GROUP BY object ORDER BY min(curvature_per_m), object");
    row.bind(1, group.study).bind(2, group.kind);
    while (row.step()) {
        names.push_back(row.text(0));
    }
    return names;
}

/// The longest of the texts, at least `least`.
std::size_t width_of(const std::vector<std::string>& texts, std::size_t least) {
    for (const std::string& text : texts) {
        least = std::max(least, text.size());
    }
    return least;
}

/// Nothing where the answers are no pictures.
std::string confusion_text(Database& database, const Group& group) {
    Statement pictures = database.prepare(
        "SELECT 1 FROM picture JOIN session ON session.id = picture.session"
        " JOIN study ON study.id = session.study WHERE name = ?1 AND kind = ?2");
    pictures.bind(1, group.study).bind(2, group.kind);
    if (!pictures.step()) {
        return {};
    }
    const std::vector<std::string> names = objects(database, group);
    std::map<std::pair<std::string, std::string>, std::int64_t> counts;
    Statement row = database.prepare(
        "SELECT object, choice, sum(n) FROM confusion WHERE study = ?1 AND kind = ?2 GROUP BY 1, "
        "2");
    row.bind(1, group.study).bind(2, group.kind);
    while (row.step()) {
        counts[{row.text(0), row.text(1)}] = row.integer(2);
    }
    const std::size_t width = width_of(names, 4);
    std::string text = fmt::format("\n  {:<{}}   chosen\n  {:<{}}", "", width, "felt", width);
    for (const std::string& name : names) {
        text += fmt::format("  {:>{}}", name, width);
    }
    text += '\n';
    for (const std::string& felt : names) {
        text += fmt::format("  {:<{}}", felt, width);
        for (const std::string& chosen : names) {
            const std::int64_t n = counts[{felt, chosen}];
            text += fmt::format("  {:>{}}", n == 0 ? std::string(".") : std::to_string(n), width);
        }
        text += '\n';
    }
    return text;
}

/// A rule chose what was felt: its runs are the conditions.
bool has_runs(Database& database, const Group& group) {
    return knows(database, "adaptive_trial") &&
           database.prepare("SELECT 1 FROM adaptive_trial WHERE study = ?1 AND kind = ?2")
               .bind(1, group.study)
               .bind(2, group.kind)
               .step();
}

/// What a run of a rule comes to by the answers that count: what is stored beside an answer took in those
/// that were marked after it.
std::string estimates_that_count(Database& database, std::int64_t session, std::int64_t run) {
    Statement row = database.prepare(
        "SELECT protocol_toml, protocol_sha256, code, number, seed, secret FROM session"
        " JOIN study ON study.id = study JOIN participant ON participant.id = participant"
        " WHERE session.id = ?1");
    row.bind(1, session).step();
    try {
        SessionSpec spec;
        spec.protocol = protocols::stored_protocol(row.text(0));
        spec.protocol_hash = row.text(1);
        spec.key = {row.text(2), static_cast<std::size_t>(row.integer(3)), row.text(5)};
        spec.seed = std::stoull(row.text(4));
        const auto runs = rebuilt_runs(database, session, spec);
        std::string text;
        for (const auto& one : runs.of(static_cast<std::size_t>(run)).estimates()) {
            text += fmt::format("{}{} {}", text.empty() ? "" : ", ", one.name,
                                one.mean ? fmt::format("{:.4g}", *one.mean) : "unknown");
        }
        return text.empty() ? "nothing yet" : text;
    } catch (const std::exception&) {  // what was stored is not what the rule gives
        return "unknown; palpate verify says more";
    }
}

/// What each run of a rule has come to, a line each; nothing where there is no rule.
std::string estimates_text(Database& database, const Group& group) {
    if (!has_runs(database, group)) {
        return {};
    }
    Statement row = database.prepare(
        "SELECT participant, session, run_name, n, (SELECT group_concat(printf('%s %s', key,"
        " ifnull(printf('%.4g', json_extract(value, '$.mean')), 'unknown')), ', ')"
        " FROM json_each(estimates)), (SELECT count(*) FROM adaptive_trial WHERE NOT counts AND"
        " study = last.study AND kind = last.kind AND participant = last.participant"
        " AND session = last.session AND run = last.run), (SELECT session FROM trial WHERE id = "
        "last.trial), run FROM adaptive_trial AS last WHERE study = ?1 AND kind = ?2"
        " AND n = (SELECT max(n) FROM adaptive_trial WHERE study = last.study AND kind = last.kind"
        " AND participant = last.participant AND session = last.session AND run = last.run)"
        " ORDER BY participant, session, run");
    row.bind(1, group.study).bind(2, group.kind);
    std::string text = "\n  what the rule estimates, run by run:\n";
    while (row.step()) {
        const std::string marked =
            row.integer(5) == 0
                ? ""
                : fmt::format(", {} of them marked later and left out", row.integer(5));
        text += fmt::format("    {} session {}  {}, {}{}: {}\n", row.text(0), row.integer(1),
                            row.text(2), protocols::counted(row.integer(3), "answer"), marked,
                            row.integer(5) > 0
                                ? estimates_that_count(database, row.integer(6), row.integer(7))
                            : row.null(4) ? "nothing yet"
                                          : row.text(4));
    }
    return text;
}

/// @param left_out  participants whose trials are not counted
std::string shares_text(Database& database,
                        const Group& group,
                        const std::set<std::string>& left_out = {}) {
    struct Share {
        std::int64_t correct, trials;
    };
    std::map<std::string, Share> shares;
    std::size_t width = 4;
    const bool runs = has_runs(database, group);
    Statement row = database.prepare(
        std::string("SELECT ") +
        (runs ? "(SELECT run_name FROM adaptive_trial WHERE trial = trial_result.trial)"
              : "friction") +
        ", participant, sum(correct), count(correct) FROM trial_result WHERE study = ?1 AND kind = "
        "?2 AND phase = 'main' AND correct IS NOT NULL GROUP BY 1, participant");
    row.bind(1, group.study).bind(2, group.kind);
    while (row.step()) {
        width = std::max(width, row.text(0).size());
        if (!left_out.contains(row.text(1))) {
            Share& share = shares[row.text(0)];
            share.correct += row.integer(2);
            share.trials += row.integer(3);
        }
    }
    std::string text = shares.empty() ? "" : "\n";
    for (const auto& [name, share] : shares) {
        const auto [correct, trials] = share;
        const Interval ci = wilson(correct, trials);
        text += fmt::format(
            "  {} {:<{}} {:>3} of {:>3} correct = {:.2f}   95 % interval {:.2f} to {:.2f} "
            "(Wilson)\n",
            runs ? "run" : "friction", name, width, correct, trials,
            static_cast<double>(correct) / static_cast<double>(trials), ci.low, ci.high);
    }
    return text;
}

/// Whom the protocol's rules leave out, and the shares without them; nothing where there are no rules.
std::string exclusions_text(Database& database, const Group& group) {
    const Exclusions exclusions = judge(database, group.study, group.kind);
    if (!exclusions.rules) {
        return {};
    }
    std::set<std::string> everybody;
    std::set<std::string> left_out;
    std::string why;
    for (const Judged& one : exclusions.all) {
        everybody.insert(one.participant);
        for (const std::string& rule : one.broken) {
            left_out.insert(one.participant);
            why += fmt::format("    {}  {}\n", one.participant, rule);
        }
    }
    if (left_out.empty()) {
        return fmt::format(
            "\n  The rules of [exclusion] leave out none of {}: with and without them it is the "
            "same.\n",
            protocols::counted(everybody.size(), "participant"));
    }
    return fmt::format(
               "\n  The above is of all participants. The rules of [exclusion] leave out {} of "
               "{}:\n{}  Without {}:\n",
               left_out.size(), everybody.size(), why,
               left_out.size() == 1 ? "this one" : "these") +
           (left_out.size() == everybody.size() ? std::string("\n  nobody is left\n")
                                                : shares_text(database, group, left_out));
}

/// Trials that a fault cut short; nothing as long as there are none.
std::string faults_text(Database& database, const Group& group) {
    Statement row = database.prepare(
        "SELECT count(*) FROM trial JOIN session ON session.id = trial.session"
        " JOIN study ON study.id = session.study"
        " WHERE name = ?1 AND kind = ?2 AND outcome = 'faulted'");
    row.bind(1, group.study).bind(2, group.kind).step();
    const std::int64_t n = row.integer(0);
    return n == 0 ? std::string()
                  : fmt::format("\n  {} ended by a fault and not counted: SELECT * FROM fault\n",
                                protocols::counted(n, "trial"));
}

/// Answers that do not count; nothing as long as there are none.
std::string invalid_text(Database& database, const Group& group) {
    Statement row =
        database.prepare("SELECT count(*) FROM invalid_trial WHERE study = ?1 AND kind = ?2");
    row.bind(1, group.study).bind(2, group.kind).step();
    const std::int64_t n = row.integer(0);
    return n == 0 ? std::string()
                  : fmt::format("\n  {} invalid and left out: SELECT * FROM invalid_trial\n",
                                protocols::counted(n, "answered trial is", "answered trials are"));
}

/// For a POSIX shell.
std::string quoted(const std::string& word) {
    std::string text = "'";
    for (const char c : word) {
        text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    }
    return text + "'";
}

}  // namespace

std::string summary_text(Database& database) {
    const Snapshot now(database);
    std::string text;
    for (const Group& group : groups(database)) {
        text += title(group) + confusion_text(database, group) + shares_text(database, group) +
                estimates_text(database, group) + exclusions_text(database, group) +
                faults_text(database, group) + invalid_text(database, group) + '\n';
    }
    if (text.empty()) {
        text = "No main trial has been answered yet.\n\n";
    }
    return text + fmt::format("Data: {}\n", database.file());
}

std::string example_queries(const std::string& file) {
    const std::string name = quoted(file);
    return fmt::format(
        "Two queries to try:\n"
        "  sqlite3 -box {0} \"SELECT object, friction, choice, correct, done_s, reaction_s FROM "
        "trial_result\"\n"
        "  sqlite3 -box {0} \"SELECT kind, friction, avg(correct), avg(mean_normal_force_n), "
        "avg(slip_share) FROM trial_result WHERE phase = 'main' GROUP BY kind, friction\"\n",
        name);
}

}  // namespace palpate::data
