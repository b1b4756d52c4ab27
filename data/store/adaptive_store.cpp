#include "data/store/adaptive_store.hpp"

#include <cmath>

#include <fmt/format.h>

#include "protocols/design/session_plan.hpp"
#include "protocols/file/protocol_file.hpp"
#include "data/store/row.hpp"

namespace palpate::data {

void write_adaptive_plan(Database& database,
                         std::int64_t session,
                         const protocols::Protocol& protocol,
                         const protocols::Plan& plan) {
    for (const protocols::PlannedTrial& planned : plan.trials) {
        if (planned.adaptive) {
            const protocols::AdaptiveTrial& adaptive = *planned.adaptive;
            Row("adaptive_plan")
                .set("session_id", session)
                .set("plan_position", planned.position)
                .set("run_number", adaptive.run)
                .set("run_name", protocol.runs.at(adaptive.run).name)
                .set("comparison_interval", adaptive.comparison)
                .set("standard_friction", protocol.frictions.at(adaptive.standard_friction).name)
                .insert(database);
        }
    }
}

std::string estimates_text(const std::vector<protocols::Estimate>& estimates) {
    const auto number = [](std::optional<double> value) {
        return value && std::isfinite(*value) ? fmt::format("{}", *value == 0.0 ? 0.0 : *value)
                                              : std::string("null");
    };
    std::string text;
    for (const protocols::Estimate& estimate : estimates) {
        text += fmt::format("{}\"{}\":{{\"mean\":{},\"mode\":{}}}", text.empty() ? "" : ",",
                            estimate.name, number(estimate.mean), number(estimate.mode));
    }
    return '{' + text + '}';
}

void write_step(Database& database, std::int64_t trial, const protocols::AdaptiveStep& step) {
    Row("adaptive_step")
        .set("trial_id", trial)
        .set("rule_outcome", step.answer.outcome)
        .set("estimate", step.estimates.empty() ? std::nullopt : step.estimates.front().mean)
        .set("estimates", estimates_text(step.estimates))
        .set("state_sha256", step.state_hash)
        .insert(database);
}

protocols::AdaptiveRuns runs_that_count(Database& database, std::int64_t session) {
    Statement row = database.prepare(
        "SELECT protocol_toml, protocol_sha256, coalesce(run_code, participant_code), "
        "coalesce(run_number, session_number), seed, secret "
        "FROM session JOIN study USING (study_id) JOIN participant USING (participant_id) WHERE "
        "session.session_id = ?1");
    row.bind(1, session).step();
    const protocols::Protocol protocol = protocols::stored_protocol(row.text(0));
    protocols::AdaptiveRuns runs(
        protocol,
        protocols::session_stream(
            row.text(1), {row.text(2), static_cast<std::size_t>(row.integer(3)), row.text(5)},
            std::stoull(row.text(4))));
    Statement step = database.prepare(
        "SELECT run_number, stimulus, rule_outcome FROM analysis_trial WHERE session_id = ?1"
        " AND counts AND run_trial_number IS NOT NULL ORDER BY trial_id");
    step.bind(1, session);
    while (step.step()) {
        runs.update({.run = static_cast<std::size_t>(step.integer(0)),
                     .stimulus = step.real(1),
                     .outcome = static_cast<std::size_t>(step.integer(2))});
    }
    return runs;
}

}  // namespace palpate::data
