#include "data/store/presentation.hpp"

#include <algorithm>
#include <iterator>
#include <optional>
#include <string>

#include "protocols/design/object_outline.hpp"
#include "data/store/row.hpp"

namespace palpate::data {
namespace {

/// What nobody felt who held a device without force.
constexpr std::string_view kOfForce[] = {
    "normal_force_p10_n", "normal_force_p50_n", "normal_force_p90_n", "mean_normal_force_n",
    "max_normal_force_n", "energy_j",           "worst_episode_j"};

}  // namespace

void write_presentation(Database& database,
                        std::int64_t trial,
                        const protocols::Presentation& felt,
                        const protocols::SceneConstants& scene) {
    Row("presentation")
        .set("trial_id", trial)
        .set("interval", felt.interval)
        .set("stimulus", felt.stimulus)
        .set("felt_object", felt.object.name)
        .set("curvature_per_m", protocols::curvature_of(felt.object))
        .set("friction", felt.friction.name)
        .set("mu_s", felt.friction.mu_s)
        .set("mu_d", felt.friction.mu_d)
        .set("slip_decay", scene.slip_decay)
        .set("heal_decay", scene.heal_decay)
        .insert(database);
}

std::vector<SummaryValue> summary_values(const protocols::TrialSummary& sum, bool force) {
    std::vector<SummaryValue> values{
        {"ticks", sum.ticks},
        {"contact_ticks", sum.contact_ticks},
        {"slip_ticks", sum.slip_ticks},
        {"late_ticks", sum.late_ticks},
        {"saturated_ticks", sum.saturated_ticks},
        {"force_slew_ticks", sum.slewed_ticks},
        {"stale_ticks", sum.stale_ticks},
        {"skipped_ticks", sum.skipped_ticks},
        {"before_vertex_ticks", sum.before_vertex_ticks},
        {"after_vertex_ticks", sum.after_vertex_ticks},
        {"path_length_m", sum.path_length_m},
        {"start_x_m", sum.start.x},
        {"start_y_m", sum.start.y},
        {"strokes", sum.strokes},
        {"strokes_before_vertex", sum.strokes_before_vertex},
        {"strokes_after_vertex", sum.strokes_after_vertex},
        {"reversals", sum.reversals},
        {"vertex_ticks", sum.vertex_ticks},
        {"stick_events", std::monostate()},
        {"speed_p10_m_per_s", sum.speed.p10},
        {"speed_p50_m_per_s", sum.speed.p50},
        {"speed_p90_m_per_s", sum.speed.p90},
        {"normal_force_p10_n", sum.normal_force.p10},
        {"normal_force_p50_n", sum.normal_force.p50},
        {"normal_force_p90_n", sum.normal_force.p90},
        {"covered_share", sum.covered_share},
        {"mean_speed_m_per_s", sum.mean_speed_m_per_s},
        {"mean_normal_force_n", sum.mean_normal_force_n},
        {"max_normal_force_n", sum.max_normal_force_n},
        {"energy_j", sum.energy_j},
        {"contact_episodes", sum.contact_episodes},
        {"worst_episode_j", sum.worst_episode_j},
        {"first_contact_s", std::monostate()},
    };
    if (sum.first_contact_s) {
        values.back().value = *sum.first_contact_s;
    }
    for (SummaryValue& one : values) {
        if (sum.sticks && one.column == "stick_events") {
            one.value = sum.stick_events;
        }
        if (!force && std::ranges::find(kOfForce, one.column) != std::end(kOfForce)) {
            one.value = std::monostate();
        }
    }
    return values;
}

void set_summary(Row& row, const protocols::TrialSummary& sum, bool force) {
    for (const auto& [column, value] : summary_values(sum, force)) {
        if (row.has(column)) {
            row.set(column, value);
        }
    }
}

void write_interval_result(Database& database,
                           std::int64_t trial,
                           std::int64_t interval,
                           const protocols::IntervalResult& result,
                           bool force) {
    Row row("presentation");
    row.set("trial_id", trial)
        .set("interval", interval)
        .set("done_s", result.done_s)
        .set("done_uncertainty_s", result.done_uncertainty_s);
    set_summary(row, result.summary, force);
    row.update(database, {"trial_id", "interval"});
}

void set_confirmation(Row& row,
                      const std::string& of,
                      const std::optional<protocols::Confirmation>& confirmation) {
    if (confirmation) {
        row.set(of + "first_choice_s", confirmation->first_choice_s)
            .set(of + "confirmed_s", confirmation->confirmed_s)
            .set(of + "changes", confirmation->changes);
    }
}

void write_response(Database& database,
                    std::int64_t trial,
                    const protocols::Protocol& protocol,
                    const protocols::Response& response) {
    Row row("response");
    row.set("trial_id", trial)
        .set("answer_code", response.place)
        .set("correct", response.correct)
        .set("reaction_s", response.reaction_s)
        .set("reaction_uncertainty_s", response.uncertainty_s)
        .set("input", to_string(response.input))
        .set("early_presses", response.early_presses);
    if (response.object) {
        row.set("chosen_place", response.place)
            .set("chosen_object", protocol.objects.at(*response.object).name);
    }
    if (response.confidence) {
        row.set("confidence", *response.confidence)
            .set("confidence_reaction_s", response.confidence_reaction_s);
    }
    set_confirmation(row, "", response.confirmation);
    set_confirmation(row, "confidence_", response.confidence_confirmation);
    row.insert(database);
}

}  // namespace palpate::data
