#include "data/verify/trial_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "engine/safety/trip.hpp"
#include "protocols/running/trial_scene.hpp"
#include "data/store/people.hpp"
#include "data/verify/replay_check.hpp"
#include "data/verify/simulated_answer.hpp"
#include "data/verify/summary_check.hpp"

namespace palpate::data {
namespace {

using protocols::PlannedTrial;

/// How far apart exp() of two C libraries may be.
constexpr double kExpError = 4e-16;

bool never_ended(const std::string& outcome) {
    return outcome == "running" || outcome == "interrupted";
}

bool is_trip(const std::string& name) {
    for (int i = 1; i <= static_cast<int>(engine::Trip::stopped); ++i) {
        if (name == to_string(static_cast<engine::Trip>(i))) {
            return true;
        }
    }
    return false;
}

/// Columns of a trial that was cut off: nothing of it was added up.
constexpr std::array kOfAnEnd{
    "done_s",        "done_uncertainty_s",  "first_contact_s",    "ticks",
    "contact_ticks", "slip_ticks",          "late_ticks",         "saturated_ticks",
    "path_length_m", "mean_normal_force_n", "max_normal_force_n", "energy_j",
    "ended_utc",     "contact_episodes",    "worst_episode_j",    "skipped_ticks",
    "fault",         "slewed_ticks",        "stale_ticks"};

protocols::RequeueRule rule_of(const SessionFrame& frame) {
    return {.key = {.protocol_hash = frame.protocol_hash,
                    .participant = frame.key.participant,
                    .session = frame.key.session,
                    .purpose = {},
                    .seed = frame.seed},
            .most = frame.protocol.invalid.requeue_most};
}

}  // namespace

TrialCheck::TrialCheck(Database& database, const SessionFrame& frame, Findings& findings)
    : database_(database),
      frame_(frame),
      findings_(findings),
      pending_(frame.plan, rule_of(frame)),
      period_ns_(
          static_cast<std::int64_t>(std::floor(1e9 / frame.protocol.apparatus.rate_hz + 0.5))) {}

void TrialCheck::check(const StoredRow& trial) {
    findings_.look_at(trial.integer("id"));
    const auto responses =
        rows_of(database_, "SELECT * FROM response WHERE trial = ?1", trial.integer("id"));
    const std::size_t number = pending_.answered() + 1;
    check_attempt(trial, !responses.empty());
    const auto position = static_cast<std::size_t>(trial.integer("position"));
    const PlannedTrial* planned =
        position < frame_.plan.trials.size() ? &frame_.plan.trials[position] : nullptr;
    const auto scene = planned != nullptr ? scene_of(trial, *planned) : nullptr;
    const StoredTrace trace = load_trace(database_, trial.integer("id"), scene.get(),
                                         frame_.machine, period_ns_, findings_);
    check_outcome(trial, !responses.empty());
    if (planned != nullptr) {
        check_replay(*scene, trace, findings_);
        replayed_ += static_cast<std::int64_t>(trace.ticks.size());
        if (!responses.empty()) {
            check_response(responses.front(), *planned);
            check_simulated_answer(frame_, trial, responses.front(), trace, number, findings_);
        }
    }
    check_times(trace, period_ns_, findings_);
    if (responses.empty() && !trial.null("invalid")) {
        findings_.differs("trial.invalid", to_text(trial.at("invalid")),
                          "NULL: there is no answer");
    }
    if (!never_ended(trial.text("outcome"))) {
        const bool by_numbers = responses.empty() || responses.front().text("input") == "simulated";
        check_summary(frame_, trial, trace, by_numbers, findings_);
        if (!responses.empty()) {
            check_invalid(database_, frame_, trial, trace, findings_);
        }
    }
    if (!frame_.old ||
        !rows_of(database_, "SELECT name FROM sqlite_schema WHERE name = 'fault_tick'").empty()) {
        check_fault_ticks(database_, frame_, trial, trace, findings_);
    }
    findings_.look_at({});
}

/// A session that goes on after a mark orders what is left as if the answer had never counted.
void TrialCheck::heed_marks(const StoredRow& trial) {
    bool marked = false;
    for (Attempt& attempt : made_) {
        if (attempt.marked_after > 0 && attempt.marked_after < trial.integer("id")) {
            attempt.counted = false;
            attempt.marked_after = 0;
            marked = true;
        }
    }
    if (!marked) {
        return;
    }
    pending_ = protocols::PendingTrials(frame_.plan, rule_of(frame_));
    for (const Attempt& attempt : made_) {
        pending_.note(attempt.position, attempt.outcome, attempt.counted);
    }
}

void TrialCheck::check_attempt(const StoredRow& trial, bool answered) {
    heed_marks(trial);
    const auto position = static_cast<std::size_t>(trial.integer("position"));
    if (position != pending_.next()) {
        findings_.differs("trial.position", fmt::format("{}", position),
                          fmt::format("{}: the next one to run", pending_.next()));
    }
    findings_.expect("trial", "attempt", trial, ++attempts_[position]);
    if (!answered && trial.text("outcome") != "faulted") {
        return;
    }
    const auto mark = find_mark(database_, trial.integer("id"));
    const bool counted = trial.null("invalid") || mark.has_value();
    const auto outcome = answered ? protocols::Outcome::complete : protocols::Outcome::faulted;
    made_.push_back({position, outcome, counted, mark ? mark->after : 0});
    pending_.note(position, outcome, counted);
}

void TrialCheck::check_outcome(const StoredRow& trial, bool answered) {
    const std::string outcome = trial.text("outcome");
    const auto wrong = [&](const std::string& why) {
        findings_.differs("trial.outcome", fmt::format("\"{}\"", outcome), why);
    };
    if ((outcome == "complete" || outcome == "timed_out") != answered) {
        wrong(answered ? "there is an answer" : "there is no answer");
    }
    if (never_ended(outcome)) {
        for (const char* column : kOfAnEnd) {
            findings_.expect("trial", column, trial, Value());
        }
        return;
    }
    if (trial.null("ended_utc")) {
        wrong("it has no end");
    }
    const double timeout = frame_.protocol.timing.explore_timeout;
    if (outcome == "timed_out" && trial.real("done_s") < timeout) {
        wrong(fmt::format("done before the time-out of {} s", timeout));
    }
    if (outcome != "faulted") {
        return;
    }
    if (trial.null("fault") && frame_.old) {
        findings_.missing("trial.fault", "an older palpate did not store causes");
    } else if (!is_trip(trial.text("fault"))) {
        findings_.differs("trial.fault", to_text(trial.at("fault")), "a cause of faults");
    }
    const auto notes = rows_of(
        database_,
        "SELECT substr(text, length('position ' || position || ': ') + 1) AS text FROM event"
        " JOIN trial USING (session) WHERE trial.id = ?1 AND event.kind = 'fault' AND"
        " instr(text, 'position ' || position || ': ') = 1",
        trial.integer("id"));
    const bool noted = std::any_of(notes.begin(), notes.end(), [&](const StoredRow& note) {
        return note.text("text").starts_with(trial.text("fault") + ":");
    });
    if (!notes.empty() && !noted && !trial.null("fault")) {
        findings_.differs("trial.fault", to_text(trial.at("fault")),
                          fmt::format("the event says {}", notes.front().text("text")));
    }
}

void TrialCheck::check_response(const StoredRow& response, const PlannedTrial& planned) {
    const std::int64_t place = response.integer("place");
    if (place < 0 || place >= static_cast<std::int64_t>(frame_.pictures.size())) {
        findings_.differs("response.place", fmt::format("{}", place),
                          fmt::format("one of {} pictures", frame_.pictures.size()));
        return;
    }
    const std::string& chosen = frame_.pictures[static_cast<std::size_t>(place)];
    const std::string& felt = frame_.protocol.objects.at(planned.condition.object).name;
    findings_.expect("response", "object", response, chosen);
    findings_.expect("response", "correct", response, std::int64_t{chosen == felt ? 1 : 0});
    if (response.text("input") == "simulated" && !frame_.simulated) {
        findings_.differs("response.input", "\"simulated\"", "a person's: the session is real");
    }
}

/// With the decays that were recorded.
std::unique_ptr<engine::Scene> TrialCheck::scene_of(const StoredRow& trial,
                                                    const PlannedTrial& planned) {
    std::unique_ptr<engine::Scene> scene(
        new engine::Scene(make_scene(frame_.protocol, planned.condition)));
    const auto check_decay = [&](std::string_view column, double here) {
        const double stored = trial.real(column);
        if (!(std::fabs(stored - here) <= kExpError * here)) {
            findings_.expect("trial", column, trial, here);
        } else if (stored != here) {
            findings_.missing(
                fmt::format("trial.{}", column),
                fmt::format("{} by exp() of this machine, {} stored and used", here, stored));
        }
    };
    check_decay("slip_decay", scene->decay().slip);
    check_decay("heal_decay", scene->decay().heal);
    scene->restore_decay({.slip = trial.real("slip_decay"), .heal = trial.real("heal_decay")});
    return scene;
}

}  // namespace palpate::data
