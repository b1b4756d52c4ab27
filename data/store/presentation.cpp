#include "data/store/presentation.hpp"

#include <optional>
#include <string>

#include "protocols/design/object_outline.hpp"
#include "protocols/session/trial_meter.hpp"
#include "data/store/row.hpp"

namespace palpate::data {
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
    std::vector<SummaryValue> values;
    for (const protocols::Measure& one : protocols::measures()) {
        values.push_back({one.column, measured(one, sum, force)});
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
