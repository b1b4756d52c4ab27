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
#include "data/page/html.hpp"
#include "data/trace/ticks.hpp"

/// The sections of a trial's page that are drawn from its ticks.
namespace palpate::data {

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
