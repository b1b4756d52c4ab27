#pragma once

#include <functional>
#include <vector>

#include "data/inference/stats_report.hpp"
#include "data/tables/table.hpp"

/// What palpate stats found, as tables: text, JSON and the report's page say these.
namespace palpate::data {

/// "on - off": a friction against the first.
[[nodiscard]] std::string comparison_text(const StatsReport& report, std::size_t friction);

/// The test that the protocol's `primary` names, a row a friction but the first: what text, JSON
/// and page say of it. Without rows where no protocol says which (a CSV's trials).
[[nodiscard]] Table primary_table(const StatsReport& report, const StatsPart& part);
/// Its name, with what its estimate is in.
[[nodiscard]] std::string primary_title(const StatsReport& report);
/// Of the mixed model by Laplace, without the effect and with it: chi-square of 1 df.
[[nodiscard]] double no_effect_p(const MixedStats& mixed);

/// Means over people, a row a measure and friction.
[[nodiscard]] Table means_table(const StatsReport& report, const StatsPart& part);
/// What friction changes within person, a row a measure and friction but the first.
[[nodiscard]] Table effects_table(const StatsReport& report, const StatsPart& part);
/// The mixed model of a friction, a row a method.
[[nodiscard]] Table mixed_table(const StatsReport& report, const MixedStats& mixed);
/// Confidence, time and rest within person, a row a number.
[[nodiscard]] Table within_table(const StatsReport& report, const StatsPart& part);

/// All of one choice of trials, in the order in which text says them.
[[nodiscard]] std::vector<Table> stats_tables(const StatsReport& report, const StatsPart& part);

// -------------------------------------------------------------------------------------------------
// How a report is made of its trials.

/// All statistics of the trials that `takes`. A person's permutations are drawn with a stream of
/// their own, which no other choice of trials changes.
[[nodiscard]] StatsPart part_of(const StatsReport& report,
                                const std::function<bool(const Trial&)>& takes);

/// Whether the answer is right; of yes/no without signals: whether it is yes.
[[nodiscard]] bool hit(const StatsReport& report, const Trial& trial);

/// Measures, and the tests of one number a person, from part.people.
void add_measures(const StatsReport& report, StatsPart& part);
void add_tests(const StatsReport& report, StatsPart& part);

/// A text over the tables, for all outputs: "share correct", "share of yes".
[[nodiscard]] std::string share_title(const StatsReport& report);

/// Who has no number of a measure under a friction, or under the first.
[[nodiscard]] std::vector<std::string> without_both(const StatsPart& part,
                                                    const Measure& measure,
                                                    std::size_t friction);

/// What a reader should know before a mixed model's numbers are believed.
[[nodiscard]] std::vector<std::string> warnings_of(const MixedStats& mixed);

}  // namespace palpate::data
