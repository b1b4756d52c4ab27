#pragma once

#include <vector>

#include "data/inference/stats_parts.hpp"
#include "data/tables/table.hpp"

/// What palpate stats found, as tables: text, JSON and the report's page say these.
namespace palpate::data {

/// "on - off": a friction against the first.
[[nodiscard]] std::string comparison_text(const StatsReport& report, std::size_t friction);

/// A test of one number a person each: its name, people, mean, interval, t, df, p, dz, the p of
/// sign-flip and Wilcoxon, the Bayes factor. To these columns come `index` more in front.
[[nodiscard]] Table tests_table(std::string place, std::string title, std::vector<Column> index);
/// @param name  of the index
void add_test(Table& table, std::vector<Cell> name, const PeopleTest& test);

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

}  // namespace palpate::data
