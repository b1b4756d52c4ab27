#include "data/verify/trial_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <exception>
#include <iterator>
#include <span>

#include <fmt/format.h>

#include "engine/realtime/tick_record.hpp"
#include "engine/safety/trip.hpp"
#include "protocols/design/session_plan.hpp"
#include "protocols/observer/simulated_observer.hpp"
#include "protocols/trial/presentation.hpp"
#include "protocols/trial/trial_scene.hpp"
#include "data/schema/catalogue.hpp"
#include "data/store/chain.hpp"
#include "data/store/written_rows.hpp"

namespace palpate::data {
namespace {

/// exp() and log() of two C libraries differ in the last bits, and reaction times with them.
constexpr double kSameTime = 1e-12;

void compare_choice(const StoredRow& response,
                    const protocols::Choice& choice,
                    Findings& findings) {
    Row made("response");
    made.set("answer_code", choice.place).set("confidence", choice.confidence);
    const auto set_time = [&](std::string_view column, double seconds) {
        if (!(std::fabs(response.real(column) - seconds) <= kSameTime)) {
            made.set(column, seconds);
        }
    };
    if (choice.confidence) {
        set_time("confidence_reaction_s", choice.confidence_reaction_s);
    }
    set_time("reaction_s", choice.reaction_s);
    made.set("reaction_uncertainty_s", choice.uncertainty_s).set("early_presses", 0);
    findings.expect(made, response);
}

/// What the simulated observer answers to these ticks, and how fast, follows from protocol,
/// participant, session and seed. @param done  trials of the session before this attempt
void check_simulated_answer(const SessionFrame& frame,
                            const StoredRow& response,
                            std::span<const CheckedInterval> intervals,
                            const protocols::Question& question,
                            std::size_t done,
                            Findings& findings) {
    const auto usable = [](const CheckedInterval& one) {
        const std::int64_t felt = one.row.integer("ticks");
        return one.trace.whole && felt >= 0 &&
               felt <= static_cast<std::int64_t>(one.trace.ticks.size());
    };
    if (!frame.simulated || response.text("input") != "simulated" ||
        !std::all_of(intervals.begin(), intervals.end(), usable)) {
        return;
    }
    protocols::SimulatedObserver observer(
        frame.protocol, session_stream(frame.protocol_hash, frame.key, frame.seed),
        frame.plan.picture_order, [] { return true; }, frame.person);
    for (std::size_t i = 0; i < intervals.size(); ++i) {
        static_cast<void>(observer.ready({.interval = i + 1}));
        observer.feel(std::span(intervals[i].trace.ticks)
                          .first(static_cast<std::size_t>(intervals[i].row.integer("ticks"))));
    }
    compare_choice(response, observer.choose({.done = done}, question), findings);
}

using protocols::PlannedTrial;

/// So many trials wait for their ticks to be checked: their chunks are in memory.
constexpr std::size_t kAhead = 4;

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

/// Columns of a trial that was cut off: nothing of it was added up. All that may be NULL, but for
/// what was there at its begin, what is said of it later, and its seal.
std::vector<std::string_view> columns_of_an_end() {
    constexpr std::array<std::string_view, 5> kOther{"calibration_sha256", "invalid_reason",
                                                     "started_ns", "seal", "seal_events"};
    std::vector<std::string_view> columns;
    for (const ColumnManual& column : find_table("trial")->columns) {
        if (column.nullable && std::ranges::find(kOther, column.name) == kOther.end()) {
            columns.emplace_back(column.name);
        }
    }
    return columns;
}

}  // namespace

TrialCheck::TrialCheck(Database& database,
                       std::int64_t session,
                       const SessionFrame& frame,
                       SessionReport& report,
                       TickRooms& rooms)
    : database_(database),
      frame_(frame),
      report_(report),
      rooms_(rooms),
      question_(question_of(frame.protocol,
                            protocols::make_pictures(frame.protocol, frame.plan.picture_order))),
      progress_(
          frame.protocol, frame.plan, session_stream(frame.protocol_hash, frame.key, frame.seed)),
      events_(stored_events(database, session)),
      device_(first_device(database, session)),
      period_ns_(engine::tick_period_ns(frame.protocol.apparatus.rate_hz)) {}

void TrialCheck::check(const StoredRow& trial) {
    TrialRows& pending = pending_.emplace_back(TrialRows{.trial = trial});
    Findings findings(pending.found);
    findings.look_at(trial.integer("trial_id"));
    try {
        check_rows(pending, findings);
    } catch (...) {
        finish();
        throw;
    }
    if (pending_.size() > kAhead) {
        finish_first();
    }
}

void TrialCheck::finish() {
    std::exception_ptr error;
    while (!pending_.empty()) {
        try {
            finish_first();
        } catch (...) {
            error = error ? error : std::current_exception();
        }
    }
    if (error) {
        std::rethrow_exception(error);
    }
}

void TrialCheck::finish_first() {
    TrialRows& first = pending_.front();  // its task refers to it
    const auto take_down = [&] {
        report_.replayed += first.replayed;
        std::ranges::move(first.found, std::back_inserter(report_.findings));
        pending_.pop_front();
    };
    try {
        if (first.ticks) {
            work_.wait_for(*first.ticks);
        }
    } catch (...) {
        take_down();
        throw;
    }
    take_down();
}

void TrialCheck::check_rows(TrialRows& pending, Findings& findings) {
    const StoredRow& trial = pending.trial;
    take_events();
    ++checked_;
    check_place(trial, findings);
    pending.force = device_.now.gives_force();
    const auto position = static_cast<std::size_t>(trial.integer("plan_position"));
    if (position < frame_.plan.trials.size()) {  // else it was said already
        const auto responses = rows_of(database_, "SELECT * FROM response WHERE trial_id = ?1",
                                       trial.integer("trial_id"));
        if (!responses.empty()) {
            pending.response = responses.front();
        }
        check_planned(pending, frame_.plan.trials[position], findings);
    }
}

/// What was noted before the next trial began.
void TrialCheck::take_events() {
    for (; taken_ < events_.size() && events_[taken_].trials_begun <= checked_; ++taken_) {
        progress_ = apply(std::move(progress_), events_[taken_].event);
        device_ = apply(std::move(device_), events_[taken_].event);
    }
}

/// Its turn, and what session and events say of where it was felt.
void TrialCheck::check_place(const StoredRow& trial, Findings& findings) {
    const auto position = static_cast<std::size_t>(trial.integer("plan_position"));
    if (const std::size_t next = progress_.pending().next(); position != next) {
        findings.differs("trial.plan_position", fmt::format("{}", position),
                         fmt::format("{}: the next one to run", next));
    }
    const auto before = progress_.attempts().find(position);
    const auto attempt =
        static_cast<std::int64_t>(before == progress_.attempts().end() ? 1 : before->second + 1);
    findings.expect(attempt_row(position, attempt, device_.now), trial);
}

void TrialCheck::check_planned(TrialRows& pending,
                               const PlannedTrial& planned,
                               Findings& findings) {
    const StoredRow& trial = pending.trial;
    const bool answered = pending.response.has_value();
    pending.done = progress_.pending().answered();
    const std::optional<double> stimulus = stimulus_of(planned, findings);
    if (planned.adaptive && !stimulus) {
        take(trial, answered, {}, findings);
        return;
    }
    const auto expected = presentations_of(frame_.protocol, planned, stimulus);
    pending.intervals =
        check_intervals(database_, frame_, trial, expected, answered, known_, findings);
    pending.fault_ticks =
        rows_of(database_, "SELECT * FROM fault_tick WHERE trial_id = ?1 ORDER BY tick",
                trial.integer("trial_id"));
    pending.mark = mark_reason(database_, trial.integer("trial_id"));
    check_outcome(pending, findings);
    pending.is_answer =
        answered && check_response(frame_, *pending.response, planned, expected, findings);
    const bool of_rule = planned.adaptive && planned.phase != protocols::Phase::practice;
    take(trial, answered,
         answered && of_rule && counted(trial)
             ? std::optional(
                   rule_answer(frame_, *pending.response, planned, *stimulus, progress_.runs()))
             : std::nullopt,
         findings);
    if (!answered && !trial.null("invalid_reason")) {
        findings.differs("trial.invalid_reason", to_text(trial.at("invalid_reason")),
                         "NULL: there is no answer");
    }
    pending.ticks = work_.add([this, &pending] { check_ticks_of(pending); });
}

/// Asks no database: while the rows of later trials are looked at.
void TrialCheck::check_ticks_of(TrialRows& pending) const {
    const StoredRow& trial = pending.trial;
    const std::span<const CheckedInterval> intervals = pending.intervals;
    Findings findings(pending.found);
    findings.look_at(trial.integer("trial_id"));
    for (CheckedInterval& one : pending.intervals) {
        one.trace.ticks = rooms_.take();
    }
    check_ticks(frame_, pending.intervals, period_ns_, findings);
    if (pending.is_answer) {
        check_simulated_answer(frame_, *pending.response, intervals, question_, pending.done,
                               findings);
    }
    if (!never_ended(trial.text("outcome"))) {
        // Whoever broke off before an answer may have pressed the key that ended the exploration.
        const std::string outcome = trial.text("outcome");
        const bool by_numbers = pending.response ? pending.response->text("input") == "simulated"
                                                 : outcome != "aborted" && outcome != "unanswered";
        const auto felt =
            check_summary(frame_, trial, intervals, by_numbers, pending.force, findings);
        if (pending.response && felt.size() == intervals.size()) {
            check_invalid(frame_, trial, pending.mark, felt, findings);
        }
    }
    const StoredTrace none;
    check_fault_ticks(pending.fault_ticks, trial, intervals.empty() ? none : intervals.back().trace,
                      findings);
    for (CheckedInterval& one : pending.intervals) {
        one.scene.reset();
        pending.replayed += static_cast<std::int64_t>(one.trace.ticks.size());
        rooms_.give(std::move(one.trace.ticks));
    }
}

/// Its answer did when it ended.
bool TrialCheck::counted(const StoredRow& trial) const {
    return trial.null("invalid_reason") || mark_reason(database_, trial.integer("trial_id"));
}

/// The session goes on after an attempt, which ended as it is stored.
/// @param answer  what the rule takes in
void TrialCheck::take(const StoredRow& trial,
                      bool answered,
                      const std::optional<protocols::RuleAnswer>& answer,
                      Findings& findings) {
    protocols::Attempt attempt{.trial = trial.integer("trial_id"),
                               .position = static_cast<std::size_t>(trial.integer("plan_position")),
                               .outcome = answered
                                            ? protocols::Outcome::complete
                                            : protocols::without_answer(trial.text("outcome")),
                               .counts = answered && counted(trial),
                               .answer = answer};
    try {
        progress_ = apply(progress_, attempt);
    } catch (const std::exception& error) {
        findings.differs("adaptive_step", error.what(), "an answer that the rule can take in");
        attempt.answer.reset();
        progress_ = apply(std::move(progress_), attempt);
        return;
    }
    check_step(database_, trial.integer("trial_id"), answer, progress_.runs(), findings);
}

void TrialCheck::check_outcome(const TrialRows& pending, Findings& findings) const {
    const StoredRow& trial = pending.trial;
    const bool answered = pending.response.has_value();
    const std::string outcome = trial.text("outcome");
    const auto wrong = [&](const std::string& why) {
        findings.differs("trial.outcome", fmt::format("\"{}\"", outcome), why);
    };
    if ((outcome == "complete" || outcome == "timed_out") != answered) {
        wrong(answered ? "there is an answer" : "there is no answer");
    }
    if (never_ended(outcome)) {
        for (const std::string_view column : columns_of_an_end()) {
            findings.expect("trial", column, trial, Value());
        }
        return;
    }
    if (trial.null("ended_utc")) {
        wrong("it has no end");
    }
    const double timeout = frame_.protocol.timing.explore_timeout;
    const bool waited = std::any_of(
        pending.intervals.begin(), pending.intervals.end(),
        [timeout](const CheckedInterval& one) { return one.row.real("done_s") >= timeout; });
    if (outcome == "timed_out" && !waited) {
        wrong(fmt::format("done before the time-out of {} s", timeout));
    }
    if (outcome == "unanswered" && frame_.protocol.timing.answer_timeout == 0.0) {
        wrong("the protocol waits for every answer");
    }
    if (outcome == "faulted") {
        check_cause(trial, findings);
    }
}

void TrialCheck::check_cause(const StoredRow& trial, Findings& findings) const {
    if (!is_trip(trial.text("fault_cause"))) {
        findings.differs("trial.fault_cause", to_text(trial.at("fault_cause")),
                         "a cause of faults");
    }
    std::string noted;
    for (const StoredEvent& stored : events_) {
        if (stored.event.kind != protocols::EventKind::fault ||
            stored.event.trial != trial.integer("trial_id")) {
            continue;
        }
        noted = stored.event.value;
        if (noted == trial.text("fault_cause")) {
            return;
        }
    }
    if (!noted.empty() && !trial.null("fault_cause")) {
        findings.differs("trial.fault_cause", to_text(trial.at("fault_cause")),
                         fmt::format("the event says {}", noted));
    }
}

/// What the rule chose for a trial that begins now.
std::optional<double> TrialCheck::stimulus_of(const PlannedTrial& planned,
                                              Findings& findings) const {
    const bool of_rule = planned.adaptive && planned.phase != protocols::Phase::practice;
    if (of_rule && progress_.runs().of(planned.adaptive->run).finished()) {
        findings.differs("trial", "one more of a run", "the run had ended");
        return std::nullopt;
    }
    return stimulus_for(frame_.protocol, planned, progress_.runs());
}

}  // namespace palpate::data
