#include "data/analysis/summary.hpp"

#include <algorithm>
#include <map>
#include <vector>

#include <fmt/format.h>

#include "data/analysis/wilson.hpp"

namespace palpate::data {
namespace {

struct Group {
    std::string study;
    std::string kind;
};

std::vector<Group> groups(Database& database) {
    std::vector<Group> all;
    Statement row =
        database.prepare("SELECT DISTINCT study, kind FROM confusion ORDER BY kind, study");
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

/// Objects in the order of their curvature, from concave to convex.
std::vector<std::string> objects(Database& database, const Group& group) {
    std::vector<std::string> names;
    Statement row = database.prepare(
        "SELECT object FROM trial_result WHERE study = ?1 AND kind = ?2 AND phase = 'main'"
        " GROUP BY object ORDER BY min(curvature_per_m)");
    row.bind(1, group.study).bind(2, group.kind);
    while (row.step()) {
        names.push_back(row.text(0));
    }
    return names;
}

std::string confusion_text(Database& database, const Group& group) {
    const std::vector<std::string> names = objects(database, group);
    std::map<std::pair<std::string, std::string>, std::int64_t> counts;
    Statement row = database.prepare(
        "SELECT object, choice, sum(n) FROM confusion WHERE study = ?1 AND kind = ?2 GROUP BY 1, "
        "2");
    row.bind(1, group.study).bind(2, group.kind);
    while (row.step()) {
        counts[{row.text(0), row.text(1)}] = row.integer(2);
    }
    std::size_t width = 4;
    for (const std::string& name : names) {
        width = std::max(width, name.size());
    }
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

std::string shares_text(Database& database, const Group& group) {
    std::string text = "\n";
    Statement row = database.prepare(
        "SELECT friction, sum(correct), count(*) FROM trial_result WHERE study = ?1 AND kind = ?2 "
        "AND phase = 'main'"
        " GROUP BY friction ORDER BY friction");
    row.bind(1, group.study).bind(2, group.kind);
    while (row.step()) {
        const Interval ci = wilson(row.integer(1), row.integer(2));
        text += fmt::format(
            "  friction {:<4} {:>3} of {:>3} correct = {:.2f}   95 % interval {:.2f} to {:.2f} "
            "(Wilson)\n",
            row.text(0), row.integer(1), row.integer(2),
            static_cast<double>(row.integer(1)) / static_cast<double>(row.integer(2)), ci.low,
            ci.high);
    }
    return text;
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
    std::string text;
    for (const Group& group : groups(database)) {
        text +=
            title(group) + confusion_text(database, group) + shares_text(database, group) + '\n';
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
        "  sqlite3 -box {0} \"SELECT friction, avg(correct), avg(mean_normal_force_n), "
        "avg(slip_share) FROM trial_result "
        "GROUP BY friction\"\n",
        name);
}

}  // namespace palpate::data
