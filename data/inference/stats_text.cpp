#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "data/inference/stats_tables.hpp"

namespace palpate::data {
namespace {

std::string title_text(const StatsReport& report) {
    const TrialTable& table = report.table;
    std::string text = table.source;
    if (!table.study.empty()) {
        text += text == "study " + table.study ? "" : ": study " + table.study;
        text += fmt::format(", {} data", table.kind);
        text += table.kind == "simulated" ? ": participant and device are SIMULATED"
              : table.kind == "pilot"     ? ": PILOT, not for analysis"
                                          : "";
    }
    if (report.yes_no) {
        text += "\n  Answers are yes and no; ";
        text += report.right_known
                  ? fmt::format("yes is right for {}", fmt::join(report.options.signals, ", "))
                  : "none is right or wrong: --signal SHAPE says for which yes is right";
    } else {
        text += fmt::format("\n  Answers name one of {} shapes: chance is {:.3f}",
                            table.alternatives, 1.0 / static_cast<double>(table.alternatives));
    }
    return text + fmt::format(
                      ".\n  Intervals are of 95 %. Nothing here pools the trials of several "
                      "people: the person is the unit. Seed {}.\n",
                      report.options.seed);
}

std::string excluded_text(const StatsReport& report) {
    const auto& account = report.table.left_out;
    std::string text = account ? left_out_text(*account) : std::string();
    if (report.excluded.empty()) {
        return text +
               (account ? "  Rules and marks leave nothing out: with and without these it is the "
                          "same.\n"
                        : "  Nothing is excluded: with and without exclusions it is the same.\n");
    }
    text += "  Excluded, and below left out first, then left in:\n";
    for (const ExcludedTrials& one : report.excluded) {
        text += fmt::format("    {}  {}: {}\n", one.subject, counted(one.trials, "trial"), one.why);
    }
    return text;
}

std::string part_text(const StatsReport& report, const StatsPart& part, const std::string& title) {
    std::string text =
        fmt::format("\n{}: {}, {}\n", title, counted(part.people.size(), "person", "people"),
                    counted(part.trials, "answer"));
    for (const Table& table : stats_tables(report, part)) {
        text += table_text(table);
    }
    return text;
}

}  // namespace

std::string stats_text(const StatsReport& report) {
    std::string text = title_text(report) + excluded_text(report);
    text += part_text(report, report.applied,
                      report.not_applied ? "Exclusions applied" : "All answers");
    if (report.not_applied) {
        text += part_text(report, *report.not_applied, "Exclusions NOT applied");
    }
    const std::string versions = versions_text(report.table.versions);
    return versions.empty() ? text : text + '\n' + versions;
}

}  // namespace palpate::data
