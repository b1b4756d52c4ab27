#include "data/store/stored_progress.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "protocols/design/adaptive_plan.hpp"
#include "protocols/design/session_plan.hpp"
#include "protocols/file/protocol_file.hpp"
#include "protocols/session/trust.hpp"
#include "data/csv/csv_text.hpp"
#include "data/store/chain.hpp"

namespace palpate::data {
namespace {

using protocols::Event;
using protocols::EventKind;
using protocols::Outcome;
using protocols::SessionProgress;

std::string part_name(std::size_t part) {
    return part == 0 ? std::string("the practice") : fmt::format("block {}", part);
}

std::optional<std::size_t> index(const Statement& row, int column) {
    return row.null(column) ? std::nullopt
                            : std::optional(static_cast<std::size_t>(row.integer(column)));
}

/// Takes in an attempt whose answer a rule took in, and compares the rule with what was stored.
SessionProgress replayed(const Database& database,
                         SessionProgress progress,
                         const StoredAttempt& stored) {
    const protocols::RuleAnswer& answer = *stored.attempt.answer;
    const auto refuse = [&](const std::string& what) {
        throw StoreError(
            fmt::format("{}: {} in trial {}: what was stored is not what the rule of this protocol "
                        "gives, and nothing was run; palpate verify says more",
                        database.file(), what, stored.attempt.trial));
    };
    if (answer.run >= progress.runs().size() || progress.runs().of(answer.run).finished()) {
        refuse(fmt::format("run {} has no trial left", answer.run));
    }
    if (const double next = progress.runs().next(answer.run); next != answer.stimulus) {
        refuse(fmt::format("the stimulus {} stands for {}", answer.stimulus, next));
    }
    if (const auto track = progress.runs().of(answer.run).track(); track != answer.track) {
        refuse(fmt::format("staircase \"{}\" stands for \"{}\"", answer.track, track));
    }
    try {
        progress = apply(std::move(progress), stored.attempt);
    } catch (const std::invalid_argument& error) {
        refuse(error.what());
    }
    if (progress.runs().of(answer.run).state_hash() != stored.state_hash) {
        refuse("the state of the rule differs");
    }
    return progress;
}

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
    std::string text = "stimulus,response,staircase\n";
    Statement step = database.prepare(
        "SELECT presentation.stimulus, rule_outcome, coalesce(staircase, '') FROM adaptive_step "
        "JOIN trial "
        "USING (trial_id) JOIN presentation ON presentation.trial_id = trial.trial_id AND "
        "presentation.stimulus IS NOT NULL JOIN adaptive_plan USING (session_id, plan_position) "
        "WHERE trial.session_id = ?1 AND adaptive_plan.run_number = ?2 AND trial.invalid_reason IS "
        "NULL ORDER BY trial.trial_id",
        session, run);
    while (step.step()) {
        text += fmt::format("{},{},{}\n", step.real(0), step.integer(1), csv_field(step.text(2)));
    }
    return text;
}

}  // namespace

std::vector<StoredEvent> stored_events(Database& database, std::int64_t session) {
    Statement row = database.prepare(
        "SELECT trials_begun, event_kind, text, trial_id, plan_position, part, count, duration_s, "
        "coalesce(key, ''), coalesce(value, '') FROM event WHERE session_id = ?1 ORDER BY event_id",
        session);
    return row.all([](const Statement& one) {
        return StoredEvent{one.integer(0),
                           {.kind = protocols::event_kind(one.text(1)),
                            .text = one.text(2),
                            .trial = one.integer_or_none(3),
                            .position = index(one, 4),
                            .part = index(one, 5),
                            .count = one.integer_or_none(6),
                            .duration_s = one.real_or_none(7),
                            .key = one.text(8),
                            .value = one.text(9)}};
    });
}

std::vector<StoredAttempt> stored_attempts(Database& database, std::int64_t session) {
    // An answer is a row of its own: it decides.
    Statement row = database.prepare(
        "SELECT trial_id, plan_position, outcome, reaction_s IS NOT NULL, invalid_reason IS NULL OR"
        " EXISTS (SELECT 1 FROM event WHERE event.trial_id = trial.trial_id AND event_kind ="
        " 'mark'), run_number, (SELECT stimulus FROM presentation WHERE presentation.trial_id = "
        "trial.trial_id AND stimulus IS NOT NULL), rule_outcome, coalesce(staircase, ''), "
        "state_sha256 FROM trial LEFT JOIN "
        "response USING (trial_id) LEFT JOIN adaptive_step USING (trial_id) LEFT JOIN "
        "adaptive_plan USING (session_id, plan_position) WHERE session_id = ?1 ORDER BY trial_id",
        session);
    std::vector<StoredAttempt> attempts;
    while (row.step()) {
        const bool answered = row.integer(3) != 0;
        StoredAttempt& stored = attempts.emplace_back();
        stored.attempt = {
            .trial = row.integer(0),
            .position = static_cast<std::size_t>(row.integer(1)),
            .outcome = answered ? Outcome::complete : protocols::without_answer(row.text(2)),
            .counts = answered && row.integer(4) != 0};
        if (!row.null(7)) {
            stored.attempt.answer = {.run = static_cast<std::size_t>(row.integer(5)),
                                     .stimulus = row.real(6),
                                     .outcome = static_cast<std::size_t>(row.integer(7)),
                                     .track = row.text(8)};
            stored.state_hash = row.text(9);
        }
    }
    return attempts;
}

SessionProgress stored_progress(Database& database, std::int64_t session, SessionProgress begun) {
    SessionProgress progress = std::move(begun);
    const std::vector<StoredEvent> events = stored_events(database, session);
    auto event = events.begin();
    std::int64_t trials = 0;
    const auto take_events = [&] {
        for (; event != events.end() && event->trials_begun <= trials; ++event) {
            progress = apply(std::move(progress), event->event);
        }
    };
    take_events();
    for (const StoredAttempt& stored : stored_attempts(database, session)) {
        progress = stored.attempt.answer ? replayed(database, std::move(progress), stored)
                                         : apply(std::move(progress), stored.attempt);
        ++trials;
        take_events();
    }
    return progress;
}

SessionProgress begin_again(Database& database,
                            std::int64_t session,
                            Resume how,
                            SessionProgress progress) {
    if (how == Resume::go_on || progress.pending().empty()) {
        return progress;
    }
    const std::size_t part =
        how == Resume::redo_practice ? 0 : progress.pending().part_of(progress.pending().next());
    const std::vector<protocols::TrialId> trials = progress.counting(part);
    if (trials.empty()) {
        return progress;
    }
    const Event redo{
        .kind = EventKind::redo,
        .text = fmt::format("{} is run again from its first trial, {} not count", part_name(part),
                            counted(trials.size(), "answer does", "answers do")),
        .part = part,
        .count = static_cast<std::int64_t>(trials.size())};
    add_event(database, session, redo);
    for (const protocols::TrialId trial : trials) {
        add_mark(database, session, trial, {fmt::format("{} was run again", part_name(part))});
    }
    return apply(std::move(progress), redo);
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

protocols::AdaptiveRuns runs_that_count(Database& database, std::int64_t session) {
    const Begun rules = begun(database, session).value();
    protocols::AdaptiveRuns runs(rules.protocol, rules.key);
    for (const Statement& step :
         database.prepare("SELECT run_number, stimulus, rule_outcome, coalesce(staircase, '') FROM "
                          "analysis_trial WHERE session_id = ?1 "
                          "AND counts AND run_trial_number IS NOT NULL ORDER BY trial_id",
                          session)) {
        runs.update({.run = static_cast<std::size_t>(step.integer(0)),
                     .stimulus = step.real(1),
                     .outcome = static_cast<std::size_t>(step.integer(2)),
                     .track = step.text(3)});
    }
    return runs;
}

ExportedRun exported_run(Database& database, std::int64_t session, std::int64_t run) {
    const Begun rules = begun(database, session).value_or(Begun{});
    const protocols::Protocol& protocol = rules.protocol;
    refuse_if<StoreError>(
        !protocol.procedure || run < 0 || run >= static_cast<std::int64_t>(protocol.runs.size()),
        "{}: there is no run {} of a rule in session {}", database.file(), run, session);
    return {
        .procedure = protocol.procedure->rule.text +
                     fmt::format("\n[stream]\norigin = \"{}\"\n",
                                 stream_origin(run_key(rules.key, static_cast<std::size_t>(run)))),
        .responses = responses_of(database, session, run)};
}

DeviceProgress apply(DeviceProgress device, const protocols::Event& event) {
    if (event.kind == protocols::EventKind::device) {
        device.now.name = event.value;
    } else if (event.kind == protocols::EventKind::provenance && event.key == kCalibrationHashKey) {
        device.now.calibration = event.value;
    } else if (event.kind == protocols::EventKind::planned_again) {
        device.now = device.begun;
    }
    return device;
}

DeviceProgress first_device(Database& database, std::int64_t session) {
    Statement row = database.first(
        "SELECT device, coalesce((SELECT value FROM session_provenance AS made WHERE "
        "made.session_id = session.session_id AND key = ?2), '') FROM session WHERE session_id = "
        "?1",
        session, kCalibrationHashKey);
    return {.begun = {.name = row.text(0), .calibration = row.text(1)}};
}

TrialDevice next_device(Database& database, std::int64_t session) {
    DeviceProgress device = first_device(database, session);
    for (const StoredEvent& stored : stored_events(database, session)) {
        device = apply(std::move(device), stored.event);
    }
    return device.now;
}

std::optional<TrialDevice> last_device(Database& database, std::int64_t session) {
    Statement row = database.prepare(
        "SELECT device, coalesce(calibration_sha256, '') FROM trial WHERE session_id = ?1 ORDER BY "
        "trial_id DESC LIMIT 1",
        session);
    return row.step() ? std::optional(TrialDevice{row.text(0), row.text(1)}) : std::nullopt;
}

std::string last_board(Database& database, std::int64_t session) {
    const std::int64_t trials =
        database.first("SELECT count(*) FROM trial WHERE session_id = ?1", session).integer(0);
    return next_provenance(database, session, trials)[std::string(protocols::kBoard)];
}

bool same_rig(const TrialDevice& a, const TrialDevice& b) {
    const auto kind = [](const TrialDevice& one) {
        return one.name.substr(0, one.name.find(" at "));
    };
    return kind(a) == kind(b) && a.calibration == b.calibration;
}

Provenance first_provenance(Database& database, std::int64_t session) {
    Provenance begun;
    Statement row = database.prepare(
        "SELECT key, value FROM session_provenance WHERE session_id = ?1", session);
    while (row.step()) {
        begun.emplace(row.text(0), row.text(1));
    }
    return begun;
}

Provenance next_provenance(Database& database, std::int64_t session, std::int64_t trials) {
    const Provenance begun = first_provenance(database, session);
    Provenance now = begun;
    for (const auto& [before, event] : stored_events(database, session)) {
        if (before >= trials) {
            break;
        }
        if (event.kind == EventKind::planned_again) {
            now = begun;
        } else if (event.kind == EventKind::provenance && event.key != protocols::kStartPose &&
                   event.key != protocols::kRigCheck) {
            now[event.key] = event.value;
        }
    }
    std::erase_if(now, [](const auto& one) { return one.second.empty(); });
    return now;
}

std::string device_text(const TrialDevice& device) {
    return device.calibration.empty()
             ? device.name
             : device.name + " (calibration " + device.calibration.substr(0, 8) + ")";
}

}  // namespace palpate::data
