#include "data/analysis/summary.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "engine/base/text.hpp"
#include "data/analysis/left_out.hpp"
#include "data/store/analysed.hpp"
#include "data/store/stored_progress.hpp"

namespace palpate::data {
namespace {

std::vector<Group> groups(Database& database) {
    Statement row = database.prepare(
        "SELECT study_name, session_kind FROM main.session AS one JOIN study USING (study_id) "
        "WHERE EXISTS (SELECT 1 FROM main.trial JOIN main.plan USING (session_id, plan_position) "
        "JOIN main.response USING (trial_id) WHERE trial.session_id = one.session_id AND phase = "
        "'main') GROUP BY study_name, session_kind ORDER BY session_kind, substr(study_name, 1, "
        "instr(study_name || '@', '@')), min(study_id)");
    return row.all([](const Statement& one) { return Group{one.text(0), one.text(1)}; });
}

std::string title(const Group& group) {
    std::string text = fmt::format("Study {}, {} data", plain(group.study), group.kind);
    if (group.kind == "simulated") {
        text += ": participant and device are SIMULATED";
    } else if (group.kind == "pilot") {
        text += ": PILOT, not for analysis";
    }
    return text + "\n";
}

/// How often what was felt was taken for what.
using Confusion = std::map<std::pair<std::string, std::string>, std::int64_t>;

Confusion confusion_of(Database& database, const Group& group) {
    Confusion counts;
    for (const Statement& row :
         database.prepare("SELECT planned_object, chosen_object, sum(n) FROM confusion WHERE "
                          "study_name = ?1 AND session_kind = ?2 GROUP BY 1, 2",
                          group.study, group.kind)) {
        counts[{row.text(0), row.text(1)}] = row.integer(2);
    }
    return counts;
}

/// Empty where the answers are no pictures.
std::vector<std::string> pictures(Database& database, const Group& group) {
    return texts(database.prepare(
        "SELECT DISTINCT picture_object FROM picture JOIN session USING (session_id) JOIN study "
        "USING (study_id) WHERE study_name = ?1 AND session_kind = ?2 ORDER BY 1",
        group.study, group.kind));
}

/// Nothing where the answers are no pictures.
std::string confusion_text(Database& database, const Group& group) {
    const std::vector<std::string> shown = pictures(database, group);
    if (shown.empty()) {
        return {};
    }
    // Everything felt in main trials, and everything that will be: from concave to convex.
    const std::vector<std::string> names =
        planned(database, group, "planned_object", "curvature_per_m");
    std::vector<std::string> answers = names;
    std::ranges::copy_if(shown, std::back_inserter(answers), [&](const std::string& picture) {
        return std::ranges::find(names, picture) == names.end();
    });
    Confusion counts = confusion_of(database, group);
    std::size_t width = std::string_view("felt").size();
    for (const std::string& name : answers) {
        width = std::max(width, name.size());
    }
    std::string text = fmt::format("\n  {:<{}}   chosen\n  {:<{}}", "", width, "felt", width);
    for (const std::string& name : answers) {
        text += fmt::format("  {:>{}}", name, width);
    }
    text += '\n';
    for (const std::string& felt : names) {
        text += fmt::format("  {:<{}}", felt, width);
        for (const std::string& chosen : answers) {
            const std::int64_t n = counts[{felt, chosen}];
            text += fmt::format("  {:>{}}", n == 0 ? std::string(".") : std::to_string(n), width);
        }
        text += '\n';
    }
    return text;
}

/// Whom the protocol's rules leave out, and the shares without them; nothing where there are no
/// rules.
std::string exclusions_text(Database& database,
                            const Group& group,
                            const RuleRuns& runs,
                            const LeftOut& account) {
    if (!account.rules) {
        return {};
    }
    const auto everybody = static_cast<std::size_t>(
        account.in_file.people - account.no_consent.people - account.withdrawn.people);
    std::set<std::string> left_out;
    std::string why;
    for (const LeftOut::Reason& one : account.broken) {
        left_out.insert(one.person);
        why += fmt::format("    {}  {}\n", one.person, one.why);
    }
    if (left_out.empty()) {
        return fmt::format(
            "\n  The rules of [exclusion] leave out none of {}: with and without them it is the "
            "same.\n",
            counted(everybody, "participant"));
    }
    return fmt::format(
               "\n  The above is of all participants. The rules of [exclusion] leave out {} of "
               "{}:\n{}  Without {}:\n",
               left_out.size(), everybody, why, left_out.size() == 1 ? "this one" : "these") +
           (left_out.size() == everybody
                ? std::string("\n  nobody is left\n")
                : answers_text(database, group, left_out) + runs_text(runs, left_out));
}

/// What stands beside the answers that count; nothing is said of none.
struct Counts {
    std::int64_t faulted = 0;  ///< trials that a fault cut short
    std::int64_t invalid = 0;  ///< answers that do not count
    std::int64_t no_correct = 0;
    std::int64_t answers = 0;  ///< of main trials, that count
};

Counts counts_of(Database& database, const Group& group) {
    Statement row = database.first(
        "SELECT (SELECT count(*) FROM trial JOIN session USING (session_id) JOIN study USING "
        "(study_id) WHERE study_name = ?1 AND session_kind = ?2 AND outcome = 'faulted'), count(*) "
        "FILTER (WHERE invalid_reason IS NOT NULL), count(*) FILTER (WHERE counts AND phase = "
        "'main' AND correct IS NULL), count(*) FILTER (WHERE counts AND phase = 'main') FROM "
        "analysis_trial WHERE study_name = ?1 AND session_kind = ?2",
        group.study, group.kind);
    return {row.integer(0), row.integer(1), row.integer(2), row.integer(3)};
}

/// For a POSIX shell.
std::string quoted(const std::string& word) {
    std::string text = "'";
    for (const char c : word) {
        text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    }
    return text + "'";
}

/// The command that lists them, for a POSIX shell.
std::string invalid_query(const std::string& file, const Group& group) {
    std::string sql;
    for (const char c : fmt::format("SELECT * FROM analysis_trial WHERE invalid_reason IS NOT NULL "
                                    "AND study_name = {} AND session_kind = {}",
                                    quoted_text(group.study), quoted_text(group.kind))) {
        sql += std::string_view("\\\"$`").find(c) == std::string_view::npos ? "" : "\\";
        sql += c;
    }
    const bool apart = group.study.find('@') != std::string::npos;
    return fmt::format("palpate sql {} --versions {} -c \"{}\"", quoted(file),
                       apart ? "apart" : "together", sql);
}

std::string counts_text(const Counts& counts, const std::string& query) {
    std::string text;
    if (counts.no_correct > 0) {
        text += fmt::format("\n  {} of {} have no correct (NULL): neither right nor wrong\n",
                            counts.no_correct, counted(counts.answers, "answer"));
    }
    if (counts.faulted > 0) {
        text += fmt::format("\n  {} ended by a fault and not counted: SELECT * FROM fault\n",
                            counted(counts.faulted, "trial"));
    }
    if (counts.invalid > 0) {
        text += fmt::format("\n  {} invalid and left out:\n    {}\n",
                            counted(counts.invalid, "answered trial is", "answered trials are"),
                            plain(query));
    }
    return text;
}

/// Sessions that were felt on more than one device.
Table devices_table(Database& database, const Group& group) {
    Statement row = database.prepare(
        "SELECT participant_code, session_number, device, coalesce(calibration_sha256, ''), "
        "count(*), count(*) OVER (PARTITION BY session_id) FROM analysis_trial WHERE study_name = "
        "?1 AND session_kind = ?2 GROUP BY session_id, device, calibration_sha256 ORDER BY "
        "participant_code, session_number, min(trial_id)",
        group.study, group.kind);
    Table table{.place = "devices/-",
                .title = "  CAUTION: felt on more than one device or calibration",
                .columns = heads({"person", "session", "attempts", "device|on"}),
                .index = 2};
    while (row.step()) {
        if (row.integer(5) > 1) {
            table.rows.push_back({row.text(0), row.integer(1), row.integer(4),
                                  device_text({.name = row.text(2), .calibration = row.text(3)})});
        }
    }
    return table;
}

}  // namespace

std::string summary_text(Database& database) {
    const Snapshot now(database);
    std::string text;
    for (const Group& group : groups(database)) {
        const LeftOut account = left_out_of(database, group.study, group.kind, true);
        const RuleRuns runs = rule_runs(database, group);
        text += title(group) + confusion_text(database, group) + answers_text(database, group) +
                runs_text(runs) + exclusions_text(database, group, runs, account) +
                counts_text(counts_of(database, group), invalid_query(database.file(), group)) +
                '\n' + left_out_text(account) + table_text(devices_table(database, group)) + '\n';
    }
    if (text.empty()) {
        text = "No main trial has been answered yet.\n\n";
    }
    const std::string versions = versions_text(versions_of(database));
    text += versions.empty() ? "" : versions + '\n';
    return text + fmt::format("Data: {}\n", database.file());
}

std::string summary_json(Database& database) {
    const Snapshot now(database);
    Json all = {{"file", database.file()},
                {"versions", versions_json(versions_of(database))},
                {"studies", Json::array()}};
    for (const Group& group : groups(database)) {
        const LeftOut account = left_out_of(database, group.study, group.kind, true);
        const Counts counts = counts_of(database, group);
        const RuleRuns runs = rule_runs(database, group);
        Json one = {{"study", group.study},
                    {"kind", group.kind},
                    {"left_out", left_out_json(account)},
                    {"faulted_trials", counts.faulted},
                    {"invalid_answers", counts.invalid},
                    {"no_correct", counts.no_correct},
                    {"answers", counts.answers},
                    {"devices", Json::array()},
                    {"runs", Json::array()},
                    {"estimates", Json::array()},
                    {"shares", Json::array()},
                    {"confusion", Json::array()},
                    {"applied", Json::array()},
                    {"not_applied", Json::array()}};
        for (const auto& [pair, n] : confusion_of(database, group)) {
            one["confusion"].push_back({{"felt", pair.first}, {"chosen", pair.second}, {"n", n}});
        }
        for (const Table& table :
             {devices_table(database, group), runs.runs, runs.estimates, runs.shares}) {
            put_table(one, table);
        }
        std::set<std::string> excluded;
        for (const LeftOut::Reason& reason : account.broken) {
            excluded.insert(reason.person);
        }
        for (const auto& tables : {answers_tables(database, group), runs.means}) {
            for (const PeopleTable& table : tables) {
                one["applied"].push_back(people_json(without(table, excluded)));
                one["not_applied"].push_back(people_json(table));
            }
        }
        all["studies"].push_back(std::move(one));
    }
    return json_text(all) + '\n';
}

std::string example_queries(const std::string& file) {
    const std::string name = quoted(file);
    return fmt::format(
        "Two queries to try:\n  sqlite3 -box {0} \"SELECT planned_object, friction, chosen_object, "
        "correct, done_s, reaction_s FROM analysis_trial WHERE counts\"\n  sqlite3 -box {0} "
        "\"SELECT session_kind, friction, count(*) AS people, avg(share) AS mean_share, "
        "avg(force_n) AS normal_force_n FROM (SELECT session_kind, friction, participant_code, "
        "avg(correct) AS share, avg(mean_normal_force_n) AS force_n FROM analysis_trial WHERE "
        "counts AND phase = 'main' GROUP BY 1, 2, 3) GROUP BY 1, 2\"\n",
        name);
}

}  // namespace palpate::data
