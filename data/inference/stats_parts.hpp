#pragma once

#include <functional>

#include "data/inference/stats_report.hpp"

/// How a report is made of its trials.
namespace palpate::data {

/// All statistics of the trials that `takes`. A person's permutations are drawn with a stream of
/// their own, which no other choice of trials changes.
[[nodiscard]] StatsPart part_of(const StatsReport& report,
                                const std::function<bool(const Trial&)>& takes);

/// Whether the answer is right; of yes/no without signals: whether it is yes.
[[nodiscard]] bool hit(const StatsReport& report, const Trial& trial);

/// Measures, the mixed model of each friction and the first, and the tests of one number a person,
/// from part.people.
void add_measures(const StatsReport& report, StatsPart& part);
void add_mixed(const StatsReport& report, StatsPart& part);
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
