#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/realtime/scene_view.hpp"
#include "engine/realtime/tick_record.hpp"
#include "data/fit/fit_report.hpp"
#include "data/inference/audit.hpp"
#include "data/inference/stats_report.hpp"
#include "data/page/html.hpp"
#include "data/trace/ticks.hpp"

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

// -------------------------------------------------------------------------------------------------
// The sections of a trial's page that are drawn from its ticks.

/// An interval of a trial, as it was felt.
struct TrialTrace {
    std::int64_t trial = 0;
    std::int64_t interval = 1;
    std::string place{};  ///< behind ids: "", "-2"
    std::string title{};  ///< behind titles: "", ", interval 2"
    std::shared_ptr<const engine::FeltScene> scene{};
    Ticks ticks{};  ///< without closest points
    std::optional<std::int64_t>
        felt{};                 ///< ticks to done: presentation.ticks; none: it was cut off
    std::string fault_cause{};  ///< why the force went off in it; empty: it did not

    /// The rows of `sample` that are of it, to done: "trial_id = 3 AND interval = 1 AND tick <
    /// 9120".
    [[nodiscard]] std::string rows() const;
    /// Of the last of these, s: of a fault the instant. None: it was cut off.
    [[nodiscard]] std::optional<double> done_s() const;
    /// Ticks to done.
    [[nodiscard]] std::span<const engine::TickRecord> felt_ticks() const;
};

/// Times that a sliding god-object stuck again, as presentation.stick_events counts them.
[[nodiscard]] std::vector<engine::TickRecord> stick_events(const TrialTrace& trace);
/// Something may stick: a tick in contact had friction.
[[nodiscard]] bool has_friction(const TrialTrace& trace);

/// Points of what is felt, seen from above, m; the last is joined to the first.
[[nodiscard]] std::vector<engine::Vec2> border_of(const TrialTrace& trace);

/// Where hand and god-object went on the object.
void add_path(PageWriter& page, const Study& study, const TrialTrace& trace);
/// Every tick, and a table of every second.
void add_strips(PageWriter& page, const Study& study, const TrialTrace& trace);

/// What stands in the page beside its numbers, as it lies in uplot/ and trial_*.
[[nodiscard]] std::string_view uplot_script();   ///< defines uPlot
[[nodiscard]] std::string_view uplot_style();    ///< its style sheet
[[nodiscard]] std::string_view uplot_licence();  ///< MIT: goes with every copy
[[nodiscard]] std::string_view trial_style();    ///< of that page alone, after page_style()
[[nodiscard]] std::string_view trial_script();   ///< draws the page's ticks with it

}  // namespace palpate::data
