#include "data/verify/trial_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "engine/safety/trip.hpp"
#include "protocols/design/session_plan.hpp"
#include "protocols/trial/presentation.hpp"
#include "data/schema/catalogue.hpp"
#include "data/store/people.hpp"
#include "data/verify/interval_check.hpp"
#include "data/verify/simulated_answer.hpp"
#include "data/verify/summary_check.hpp"

namespace palpate::data {
namespace {

using protocols::PlannedTrial;

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

/// Columns of a trial that was cut off: nothing of it was added up. All that may be NULL, but for what was there at
/// its begin, what is said of it later, and its seal.
std::vector<std::string_view> columns_of_an_end() {
    constexpr std::array<std::string_view, 4> kOther{"invalid_reason", "started_ns", "seal",
                                                     "seal_events"};
    std::vector<std::string_view> columns;
    for (const ColumnManual& column :
         std::ranges::find(catalogue(), "trial", &TableManual::name)->columns) {
        if (column.nullable && std::ranges::find(kOther, column.name) == kOther.end()) {
            columns.emplace_back(column.name);
        }
    }
    return columns;
}

protocols::RequeueRule rule_of(const SessionFrame& frame) {
    return {.key = session_stream(frame.protocol_hash, frame.key, frame.seed),
            .most = frame.protocol.invalid.requeue_most};
}

}  // namespace

TrialCheck::TrialCheck(Database& database,
                       std::int64_t session,
                       const SessionFrame& frame,
                       Findings& findings)
    : database_(database),
      frame_(frame),
      findings_(findings),
      pending_(frame.plan, rule_of(frame)),
      runs_(frame.protocol, rule_of(frame).key),
      redos_(redos_of(database, session)),
      period_ns_(
          static_cast<std::int64_t>(std::floor(1e9 / frame.protocol.apparatus.rate_hz + 0.5))) {}

void TrialCheck::check(const StoredRow& trial) {
    findings_.look_at(trial.integer("trial_id"));
    const auto responses =
        rows_of(database_, "SELECT * FROM response WHERE trial_id = ?1", trial.integer("trial_id"));
    heed_marks(trial);
    const std::size_t done = pending_.answered();
    check_attempt(trial, !responses.empty());
    const auto position = static_cast<std::size_t>(trial.integer("plan_position"));
    const PlannedTrial* planned =
        position < frame_.plan.trials.size() ? &frame_.plan.trials[position] : nullptr;
    if (planned == nullptr) {
        findings_.look_at({});
        return;  // said already
    }
    const bool answered = !responses.empty();
    const std::optional<double> stimulus = stimulus_of(*planned);
    if (planned->adaptive && !stimulus) {
        findings_.look_at({});
        return;
    }
    const auto expected = presentations_of(frame_.protocol, *planned, stimulus);
    const std::vector<CheckedInterval> intervals =
        check_intervals(database_, frame_, trial, expected, answered, period_ns_, findings_);
    for (const CheckedInterval& one : intervals) {
        replayed_ += static_cast<std::int64_t>(one.trace.ticks.size());
    }
    check_outcome(trial, intervals, answered);
    if (answered && check_response(frame_, responses.front(), *planned, expected, findings_)) {
        check_simulated_answer(frame_, responses.front(), intervals, done, findings_);
    }
    check_step(
        database_, frame_, trial, answered ? &responses.front() : nullptr, *planned, stimulus,
        !made_.empty() && made_.back().trial == trial.integer("trial_id") && made_.back().counted,
        runs_, findings_);
    if (responses.empty() && !trial.null("invalid_reason")) {
        findings_.differs("trial.invalid_reason", to_text(trial.at("invalid_reason")),
                          "NULL: there is no answer");
    }
    if (!never_ended(trial.text("outcome"))) {
        const bool by_numbers = responses.empty() || responses.front().text("input") == "simulated";
        check_summary(frame_, trial, intervals, by_numbers, findings_);
        if (!responses.empty()) {
            check_invalid(database_, frame_, trial, intervals, findings_);
        }
    }
    check_fault_ticks(database_, trial, intervals.empty() ? StoredTrace{} : intervals.back().trace,
                      findings_);
    findings_.look_at({});
}

/// A session that goes on after a mark, or begins a part again, orders what is left as if the answers had
/// never counted.
void TrialCheck::heed_marks(const StoredRow& trial) {
    const std::int64_t now = trial.integer("trial_id");
    bool changed = std::any_of(redos_.begin(), redos_.end(), [&](const Redo& redo) {
        return redo.after < now && redo.after >= last_;
    });
    last_ = now;
    for (Attempt& attempt : made_) {
        if (attempt.marked_after > 0 && attempt.marked_after < now) {
            attempt.counted = false;
            attempt.marked_after = 0;
            runs_.forget(attempt.trial);
            changed = true;
        }
    }
    if (!changed) {
        return;
    }
    pending_ = protocols::PendingTrials(frame_.plan, rule_of(frame_));
    auto redo = redos_.begin();
    const auto begin_again = [&](std::int64_t before) {
        for (; redo != redos_.end() && redo->after < before; ++redo) {
            pending_.begin_again(redo->part);
        }
    };
    for (const Attempt& attempt : made_) {
        begin_again(attempt.trial);
        pending_.note(attempt.position, attempt.outcome, attempt.counted);
    }
    begin_again(now);
}

void TrialCheck::check_attempt(const StoredRow& trial, bool answered) {
    const auto position = static_cast<std::size_t>(trial.integer("plan_position"));
    if (position != pending_.next()) {
        findings_.differs("trial.plan_position", fmt::format("{}", position),
                          fmt::format("{}: the next one to run", pending_.next()));
    }
    findings_.expect("trial", "attempt", trial, ++attempts_[position]);
    if (!answered && trial.text("outcome") != "faulted") {
        return;
    }
    const auto mark = find_mark(database_, trial.integer("trial_id"));
    const bool counted = trial.null("invalid_reason") || mark.has_value();
    const auto outcome = answered ? protocols::Outcome::complete : protocols::Outcome::faulted;
    made_.push_back(
        {trial.integer("trial_id"), position, outcome, counted, mark ? mark->after : 0});
    pending_.note(position, outcome, counted);
}

void TrialCheck::check_outcome(const StoredRow& trial,
                               std::span<const CheckedInterval> intervals,
                               bool answered) {
    const std::string outcome = trial.text("outcome");
    const auto wrong = [&](const std::string& why) {
        findings_.differs("trial.outcome", fmt::format("\"{}\"", outcome), why);
    };
    if ((outcome == "complete" || outcome == "timed_out") != answered) {
        wrong(answered ? "there is an answer" : "there is no answer");
    }
    if (never_ended(outcome)) {
        for (const std::string_view column : columns_of_an_end()) {
            findings_.expect("trial", column, trial, Value());
        }
        return;
    }
    if (trial.null("ended_utc")) {
        wrong("it has no end");
    }
    const double timeout = frame_.protocol.timing.explore_timeout;
    const bool waited = std::any_of(
        intervals.begin(), intervals.end(),
        [timeout](const CheckedInterval& one) { return one.row.real("done_s") >= timeout; });
    if (outcome == "timed_out" && !waited) {
        wrong(fmt::format("done before the time-out of {} s", timeout));
    }
    if (outcome != "faulted") {
        return;
    }
    if (!is_trip(trial.text("fault_cause"))) {
        findings_.differs("trial.fault_cause", to_text(trial.at("fault_cause")),
                          "a cause of faults");
    }
    const auto notes = rows_of(
        database_,
        "SELECT substr(text, length('position ' || plan_position || ': ') + 1) AS text FROM event "
        "JOIN trial USING (session_id) WHERE trial.trial_id = ?1 AND event.event_kind = 'fault' "
        "AND instr(text, 'position ' || plan_position || ': ') = 1",
        trial.integer("trial_id"));
    const bool noted = std::any_of(notes.begin(), notes.end(), [&](const StoredRow& note) {
        return note.text("text").starts_with(trial.text("fault_cause") + ":");
    });
    if (!notes.empty() && !noted && !trial.null("fault_cause")) {
        findings_.differs("trial.fault_cause", to_text(trial.at("fault_cause")),
                          fmt::format("the event says {}", notes.front().text("text")));
    }
}

/// What the rule chose for a trial that begins now.
std::optional<double> TrialCheck::stimulus_of(const PlannedTrial& planned) {
    const bool of_rule = planned.adaptive && planned.phase != protocols::Phase::practice;
    if (of_rule && runs_.of(planned.adaptive->run).finished()) {
        findings_.differs("trial", "one more of a run", "the run had ended");
        return std::nullopt;
    }
    return stimulus_for(frame_.protocol, planned, runs_);
}

}  // namespace palpate::data
