#include "data/store/adaptive_store.hpp"

#include <cmath>

#include <fmt/format.h>

#include "protocols/design/adaptive_plan.hpp"
#include "protocols/design/session_plan.hpp"
#include "protocols/file/protocol_file.hpp"

namespace palpate::data {

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

namespace {

/// What the rules of a session were begun with.
struct Begun {
    protocols::Protocol protocol{};
    protocols::StreamKey key{};
};

std::optional<Begun> begun(Database& database, std::int64_t session) {
    Statement row = database.prepare(
        "SELECT protocol_toml, protocol_sha256, coalesce(run_code, participant_code), "
        "coalesce(run_number, session_number), seed, secret FROM session JOIN study USING "
        "(study_id) JOIN participant USING (participant_id) WHERE session.session_id = ?1",
        session);
    if (!row.step()) {
        return std::nullopt;
    }
    return Begun{
        protocols::stored_protocol(row.text(0)),
        protocols::session_stream(
            row.text(1), {row.text(2), static_cast<std::size_t>(row.integer(3)), row.text(5)},
            std::stoull(row.text(4)))};
}

std::string responses_of(Database& database, std::int64_t session, std::int64_t run) {
    std::string text = "stimulus,response\n";
    Statement step = database.prepare(
        "SELECT presentation.stimulus, adaptive_step.rule_outcome FROM adaptive_step JOIN trial "
        "USING (trial_id) JOIN presentation ON presentation.trial_id = trial.trial_id AND "
        "presentation.stimulus IS NOT NULL JOIN adaptive_plan USING (session_id, plan_position) "
        "WHERE trial.session_id = ?1 AND adaptive_plan.run_number = ?2 AND trial.invalid_reason IS "
        "NULL ORDER BY trial.trial_id",
        session, run);
    while (step.step()) {
        text += fmt::format("{},{}\n", step.real(0), step.integer(1));
    }
    return text;
}

}  // namespace

protocols::AdaptiveRuns runs_that_count(Database& database, std::int64_t session) {
    const Begun rules = begun(database, session).value();
    protocols::AdaptiveRuns runs(rules.protocol, rules.key);
    for (const Statement& step : database.prepare(
             "SELECT run_number, stimulus, rule_outcome FROM analysis_trial WHERE session_id = ?1 "
             "AND counts AND run_trial_number IS NOT NULL ORDER BY trial_id",
             session)) {
        runs.update({.run = static_cast<std::size_t>(step.integer(0)),
                     .stimulus = step.real(1),
                     .outcome = static_cast<std::size_t>(step.integer(2))});
    }
    return runs;
}

ExportedRun exported_run(Database& database, std::int64_t session, std::int64_t run) {
    const Begun rules = begun(database, session).value_or(Begun{});
    const protocols::Protocol& protocol = rules.protocol;
    if (!protocol.procedure || run < 0 || run >= static_cast<std::int64_t>(protocol.runs.size())) {
        throw StoreError(fmt::format("{}: there is no run {} of a rule in session {}",
                                     database.file(), run, session));
    }
    return {
        .procedure = protocol.procedure->rule.text +
                     fmt::format("\n[stream]\norigin = \"{}\"\n",
                                 stream_origin(run_key(rules.key, static_cast<std::size_t>(run)))),
        .responses = responses_of(database, session, run)};
}

}  // namespace palpate::data
