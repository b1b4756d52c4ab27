#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "data/fit/fit_report.hpp"
#include "data/inference/audit.hpp"
#include "data/inference/stats_report.hpp"
#include "data/page/html.hpp"

/// The sections of the page, each with its figures.
namespace palpate::data {

/// What palpate stats, fit and audit say of the same sessions.
struct PageNumbers {
    std::optional<StatsReport>
        stats{};  ///< nothing: no answer of identification or yes-no without a rule
    std::optional<FitReport> fit{};  ///< nothing: no graded stimulus
    std::optional<Audit> audit{};    ///< nothing: fewer than two frictions
    AuditBounds bounds{};
    std::string stats_words{};  ///< the command that prints the same numbers
    std::string fit_words{};
    std::string audit_words{};
};

/// Each adds its section to the page, if the study has what it shows.
void add_facts(PageWriter& page, const Study& study, const PageNumbers& numbers);
void add_flow(PageWriter& page, const Study& study, const PageNumbers& numbers);
void add_answers(PageWriter& page, const Study& study, const PageNumbers& numbers);
void add_ratings(PageWriter& page, const Study& study);
void add_levels(PageWriter& page, const Study& study, const PageNumbers& numbers);
void add_times(PageWriter& page, const Study& study, const PageNumbers& numbers);
void add_exploration(PageWriter& page, const Study& study);
void add_audit(PageWriter& page, const Study& study, const PageNumbers& numbers);
void add_health(PageWriter& page, const Study& study);
void add_provenance(PageWriter& page, const Study& study);
void add_methods(PageWriter& page, const Study& study, const PageNumbers& numbers);

/// Every level of a rule as often, whatever is answered.
[[nodiscard]] bool constant_stimuli(const protocols::Protocol& protocol);

/// The command that prints what the page says of ratings.
[[nodiscard]] std::string summary_words(const Study& study);

/// The protocol's frictions, the least first, and behind them others that were planned.
[[nodiscard]] std::vector<std::string> frictions_of(const Study& study);

/// A number a person and friction, people as paired lines, the means with their intervals beside
/// them.
struct PairedPanel {
    std::string title{};
    std::string label{};
    std::string unit{};
    std::vector<std::string> frictions{};
    std::vector<std::vector<double>> people{};  ///< by friction; NaN: none
    std::vector<std::vector<double>> left_out{};
    std::vector<std::optional<PeopleMean>> means{};  ///< by friction; empty: none
    double height = 220.0;
};
/// Lines of people from friction to friction, and means with intervals beside them.
[[nodiscard]] Panel paired_panel(const PairedPanel& what);

/// What people's numbers are averaged on.
enum class Scale { numbers, logarithms };
/// A column of rows with person, left_out and friction as people, by friction, with their means.
/// @param felt  only rows with this in the column felt; empty: all
[[nodiscard]] PairedPanel pairs_of(const Rows& rows,
                                   std::string_view column,
                                   const std::vector<std::string>& frictions,
                                   Scale scale = Scale::numbers,
                                   std::string_view felt = "",
                                   double factor = 1.0);

/// A measure of people, by friction.
[[nodiscard]] PairedPanel pairs_of(const Measure& measure,
                                   const std::vector<std::string>& frictions);
/// The measure of a key; nothing if there is none.
[[nodiscard]] const Measure* find_measure(const StatsPart& part, std::string_view key);

}  // namespace palpate::data
