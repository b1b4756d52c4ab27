#include "data/store/adaptive_store.hpp"

#include <cmath>

#include <fmt/format.h>

#include "protocols/file/protocol_file.hpp"

namespace palpate::data {

const char* const kAdaptive = R"sql(
CREATE TABLE adaptive_plan (
    -- Of trials whose stimulus a rule chooses, beside their rows of plan: these have the standard object and
    -- the friction of the comparison.
    session_id        INTEGER NOT NULL,             -- session.session_id
    plan_position     INTEGER NOT NULL,             -- plan.plan_position
    run_number        INTEGER NOT NULL CHECK (run_number >= 0),  -- from 0; a run is one rule with its own answers
    run_name          TEXT NOT NULL,                -- its name in the protocol
    comparison_interval INTEGER NOT NULL CHECK (comparison_interval IN (1, 2)),  -- the interval with the rule's stimulus
    standard_friction TEXT NOT NULL,                -- of the other interval
    PRIMARY KEY (session_id, plan_position),
    FOREIGN KEY (session_id, plan_position) REFERENCES plan (session_id, plan_position)
) STRICT;

CREATE TABLE adaptive_step (
    -- Answers that a rule took in. Stimulus: presentation.stimulus of the trial.
    trial_id     INTEGER PRIMARY KEY REFERENCES trial,  -- trial.trial_id
    rule_outcome INTEGER NOT NULL CHECK (rule_outcome >= 0),  -- two intervals: 1 if the comparison was named
    estimate     REAL,                              -- mean of the first estimate with this answer; NULL: none
    estimates    TEXT NOT NULL,                     -- all of them, as JSON: {"name": {"mean": x, "mode": x}, ...}
    state_sha256 TEXT NOT NULL CHECK (length(state_sha256) = 64)  -- of the rule with this answer
) STRICT;
)sql";

const char* const kAdaptiveViews = R"sql(
CREATE VIEW adaptive_trial AS
-- One row per answer that a rule took in, in the order of its run; counts = 0: it was marked later.
SELECT trial.trial_id AS trial_id,  -- trial.trial_id
       study.study_name AS study_name,  -- study.study_name
       participant.participant_code AS participant_code,  -- pseudonym
       session.session_number AS session_number,  -- number of the participant's session
       session.session_kind AS session_kind,  -- real, pilot, simulated
       adaptive_plan.run_number AS run_number,  -- from 0
       adaptive_plan.run_name AS run_name,  -- its name in the protocol
       row_number() OVER (PARTITION BY trial.session_id, adaptive_plan.run_number ORDER BY trial.trial_id) AS run_trial_number,  -- of the run, from 1
       trial.plan_position AS plan_position,  -- in the plan, from 0
       adaptive_plan.comparison_interval AS comparison_interval,  -- the interval with the rule's stimulus
       presentation.stimulus AS stimulus,  -- what the rule chose, as it counts
       presentation.curvature_per_m AS curvature_per_m,  -- as felt
       presentation.mu_s AS mu_s,  -- as felt
       response.answer_code AS answer_code,  -- picture from the left; interval - 1; 0 no, 1 yes; level
       adaptive_step.rule_outcome AS rule_outcome,  -- as the rule counts
       response.correct AS correct,  -- 1: right; NULL: neither right nor wrong
       adaptive_step.estimate AS estimate,  -- mean of the first estimate with this answer
       adaptive_step.estimates AS estimates,  -- all of them, as JSON
       adaptive_step.state_sha256 AS state_sha256,  -- of the rule with this answer
       trial.invalid_reason IS NULL AS counts  -- 0: marked later
FROM adaptive_step
JOIN trial USING (trial_id)
JOIN response USING (trial_id)
JOIN presentation ON presentation.trial_id = trial.trial_id AND presentation.stimulus IS NOT NULL
JOIN adaptive_plan USING (session_id, plan_position)
JOIN session USING (session_id)
JOIN participant USING (participant_id)
JOIN study USING (study_id);
)sql";

void write_adaptive_plan(Database& database,
                         std::int64_t session,
                         const protocols::Protocol& protocol,
                         const protocols::Plan& plan) {
    Statement row = database.prepare("INSERT INTO adaptive_plan VALUES (?1, ?2, ?3, ?4, ?5, ?6)");
    for (const protocols::PlannedTrial& planned : plan.trials) {
        if (planned.adaptive) {
            const protocols::AdaptiveTrial& adaptive = *planned.adaptive;
            row.bind(1, session)
                .bind(2, static_cast<std::int64_t>(planned.position))
                .bind(3, static_cast<std::int64_t>(adaptive.run))
                .bind(4, protocol.runs.at(adaptive.run).name)
                .bind(5, static_cast<std::int64_t>(adaptive.comparison))
                .bind(6, protocol.frictions.at(adaptive.standard_friction).name)
                .run();
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
    database.prepare("INSERT INTO adaptive_step VALUES (?1, ?2, ?3, ?4, ?5)")
        .bind(1, trial)
        .bind(2, static_cast<std::int64_t>(step.answer.outcome))
        .bind(3, step.estimates.empty() ? std::nullopt : step.estimates.front().mean)
        .bind(4, estimates_text(step.estimates))
        .bind(5, step.state_hash)
        .run();
}

protocols::AdaptiveRuns runs_that_count(Database& database, std::int64_t session) {
    Statement row = database.prepare(
        "SELECT protocol_toml, protocol_sha256, participant_code, session_number, seed, secret "
        "FROM session JOIN study USING (study_id) JOIN participant USING (participant_id) WHERE "
        "session.session_id = ?1");
    row.bind(1, session).step();
    SessionSpec spec;
    spec.protocol = protocols::stored_protocol(row.text(0));
    spec.protocol_hash = row.text(1);
    spec.key = {row.text(2), static_cast<std::size_t>(row.integer(3)), row.text(5)};
    spec.seed = std::stoull(row.text(4));
    protocols::AdaptiveRuns runs(spec.protocol, session_stream(spec));
    Statement step = database.prepare(
        "SELECT run_number, stimulus, adaptive_trial.rule_outcome FROM "
        "adaptive_trial JOIN trial USING (trial_id) WHERE trial.session_id = ?1 AND counts ORDER "
        "BY trial.trial_id");
    step.bind(1, session);
    while (step.step()) {
        runs.update({.run = static_cast<std::size_t>(step.integer(0)),
                     .stimulus = step.real(1),
                     .outcome = static_cast<std::size_t>(step.integer(2))});
    }
    return runs;
}

}  // namespace palpate::data
