#include "data/store/adaptive_store.hpp"

#include <cmath>

#include <fmt/format.h>

#include "protocols/design/session_plan.hpp"
#include "protocols/file/protocol_file.hpp"
#include "data/store/people.hpp"
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
        .set("rule_outcome", step.outcome)
        .set("estimate", step.estimates.empty() ? std::nullopt : step.estimates.front().mean)
        .set("estimates", estimates_text(step.estimates))
        .set("state_sha256", step.state_hash)
        .insert(database);
}

protocols::AdaptiveRuns rebuilt_runs(Database& database,
                                     std::int64_t session,
                                     const protocols::Protocol& protocol,
                                     const protocols::StreamKey& stream) {
    protocols::AdaptiveRuns runs(protocol, stream);
    if (runs.size() == 0) {
        return runs;
    }
    std::vector<std::pair<std::int64_t, std::int64_t>> marks;  // trial, marked after which
    const auto forget_before = [&](std::optional<std::int64_t> trial) {
        std::erase_if(marks, [&](const auto& mark) {
            const bool due = !trial || mark.second < *trial;
            if (due) {
                runs.forget(mark.first);
            }
            return due;
        });
    };
    Statement row = database.prepare(
        "SELECT trial.trial_id, adaptive_plan.run_number, presentation.stimulus, "
        "adaptive_step.rule_outcome, state_sha256 FROM adaptive_step JOIN trial USING (trial_id) "
        "JOIN adaptive_plan USING (session_id, plan_position) JOIN presentation ON "
        "presentation.trial_id = trial.trial_id AND stimulus IS NOT NULL WHERE trial.session_id = "
        "?1 ORDER BY trial.trial_id");
    row.bind(1, session);
    while (row.step()) {
        const std::int64_t trial = row.integer(0);
        const auto run = static_cast<std::size_t>(row.integer(1));
        const double stimulus = row.real(2);
        forget_before(trial);
        const auto refuse = [&](const std::string& what) {
            throw StoreError(fmt::format(
                "{}: {} in trial {}: what was stored is not what the rule of this protocol gives, "
                "and nothing was run; palpate verify says more",
                database.file(), what, trial));
        };
        if (run >= runs.size() || runs.of(run).finished()) {
            refuse(fmt::format("run {} has no trial left", run));
        }
        if (const double next = runs.next(run); next != stimulus) {
            refuse(fmt::format("the stimulus {} stands for {}", stimulus, next));
        }
        std::string state;
        try {
            state = runs.update(run, stimulus, static_cast<std::size_t>(row.integer(3)), trial)
                        .state_hash;
        } catch (const std::invalid_argument& error) {
            refuse(error.what());
        }
        if (state != row.text(4)) {
            refuse("the state of the rule differs");
        }
        if (const auto mark = find_mark(database, trial)) {
            marks.emplace_back(trial, mark->after);
        }
    }
    forget_before(std::nullopt);
    return runs;
}

protocols::AdaptiveRuns runs_that_count(Database& database, std::int64_t session) {
    Statement row = database.prepare(
        "SELECT protocol_toml, protocol_sha256, participant_code, session_number, seed, secret "
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
        "SELECT run_number, stimulus, rule_outcome, trial_id FROM analysis_trial WHERE session_id "
        "= ?1"
        " AND counts AND run_trial_number IS NOT NULL ORDER BY trial_id");
    step.bind(1, session);
    while (step.step()) {
        runs.update(static_cast<std::size_t>(step.integer(0)), step.real(1),
                    static_cast<std::size_t>(step.integer(2)), step.integer(3));
    }
    return runs;
}

}  // namespace palpate::data
