#include "protocols/session/trial_runner.hpp"

#include <algorithm>
#include <ranges>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "protocols/trial/trial_scene.hpp"

namespace palpate::protocols {

TrialRunner::TrialRunner(const Protocol& protocol,
                         const Plan& plan,
                         Ports& ports,
                         bool simulated,
                         SessionProgress& progress,
                         std::function<void(const Event&)> happened)
    : protocol_(protocol),
      plan_(plan),
      ports_(ports),
      simulated_(simulated),
      progress_(progress),
      happened_(std::move(happened)),
      pictures_(make_pictures(protocol, plan.picture_order)),
      question_(question_of(protocol, pictures_)) {}

TrialView TrialRunner::view_of(const PendingTrials& pending) const {
    const TrialNumber number = pending.number();
    return {.number = number.number,
            .total = number.total,
            .practice = number.practice,
            .done = pending.answered(),
            .unanswered = pending.unanswered(),
            .explore_min_s = protocol_.timing.explore_min,
            .explore_prompt_s = protocol_.timing.explore_prompt,
            .explore_timeout_s = protocol_.timing.explore_timeout};
}

/// What the running trial ended by, or what keeps it from beginning.
Fault TrialRunner::fault_of(engine::Trip cause) const {
    const std::string trouble = ports_.apparatus.trouble();
    return {.cause = cause,
            .text = trouble.empty() ? std::string(explanation(cause)) : trouble,
            .last = ports_.apparatus.last_ticks()};
}

/// The participant is at the start of an interval. @return as Observer::ready
Signal TrialRunner::begin(const TrialView& view) {
    if (view.interval > 1 && ports_.observer.gap(protocol_.timing.gap) == Signal::abort) {
        return Signal::abort;
    }
    const Signal signal = ports_.observer.ready(view);
    return ports_.interrupted() ? Signal::abort : signal;
}

TrialResult TrialRunner::run(const PlannedTrial& planned, TrialView view) {
    const std::vector<Presentation> felt =
        presentations_of(protocol_, planned, stimulus_for(protocol_, planned, progress_.runs()));
    view.intervals = felt.size();
    const Signal begun = begin(view);
    const bool wanted = begun == Signal::go_on && !ports_.desk->wants();
    const engine::Trip moved = ports_.apparatus.moved();
    if (!wanted || moved != engine::Trip::none) {
        TrialResult result;
        result.outcome = begun == Signal::abort ? Outcome::aborted : result.outcome;
        result.begun = false;
        if (begun == Signal::no_place) {
            result.fault = fault_of(ports_.apparatus.place_fault());
        } else if (wanted) {
            result.fault = fault_of(moved);
        }
        return result;
    }
    last_ = ports_.recorder.begin_trial(planned);
    Running trial{.id = last_, .planned = planned, .view = view};
    TrialResult& result = trial.result;
    bool timed_out = false;
    for (const Presentation& one : felt) {
        trial.view.interval = one.interval;
        const Signal again = one.interval > 1 ? begin(trial.view) : Signal::go_on;
        if (again == Signal::no_place) {  // its first tick ends it, and keeps why
            ports_.apparatus.stop(ports_.apparatus.place_fault());
        } else if (again != Signal::go_on) {
            result.outcome = Outcome::aborted;
            break;
        }
        const engine::FeltScene scene = make_felt_scene(protocol_, one);
        ports_.recorder.begin_interval(
            trial.id, one, {.slip_decay = scene.decay().slip, .heal_decay = scene.decay().heal});
        ports_.felt(trial.id, one);
        feel(trial, one, scene);
        timed_out = timed_out || result.outcome == Outcome::timed_out;
        if (!is_answered(result.outcome)) {
            break;
        }
    }
    std::optional<RuleAnswer> given;
    if (is_answered(result.outcome)) {
        result.outcome = timed_out ? Outcome::timed_out : Outcome::complete;
        given = answer(trial, felt);
    }
    end(trial, given);
    return std::move(result);
}

void TrialRunner::end(Running& trial, const std::optional<RuleAnswer>& answer) {
    TrialResult& result = trial.result;
    progress_ = apply(std::move(progress_), {.trial = trial.id,
                                             .position = trial.planned.position,
                                             .outcome = result.outcome,
                                             .counts = result.response && result.invalid.empty(),
                                             .answer = answer});
    if (answer) {
        result.step = progress_.runs().step_after(*answer);
    }
    ports_.recorder.end_trial(trial.id, result);
    note_lost_ticks(trial);
}

void TrialRunner::feel(Running& trial, const Presentation& felt, const engine::SceneView& scene) {
    TrialResult& result = trial.result;
    meter_.emplace(protocol_.apparatus.stiffness, scene);
    tripped_s_.reset();
    const double felt_s = result.done_s;  // in the interval before
    result.done_uncertainty_s = 0.0;      // of this interval, and not of the one before
    {
        ForceScope force(ports_.apparatus, scene, trial.planned.position, felt.interval);
        explore(trial);
        force.end();
        drain(trial.id, false);
    }
    note_fault(trial);
    const TrialSummary sum = meter_->summary();
    result.intervals.push_back(
        {.done_s = result.done_s, .done_uncertainty_s = result.done_uncertainty_s, .summary = sum});
    result.done_s += felt_s;
    result.summary = result.intervals.size() == 1 ? sum : together(result.summary, sum);
}

void TrialRunner::explore(Running& trial) {
    TrialResult& result = trial.result;
    const TimingSpec& timing = protocol_.timing;
    for (;;) {
        const engine::ServoStatus status = ports_.apparatus.advance();
        drain(trial.id, true);
        const double elapsed = ports_.apparatus.elapsed_s();
        result.done_s = elapsed;
        if (status == engine::ServoStatus::faulted) {
            result.outcome = Outcome::faulted;
            return;
        }
        const ExplorationStep exploring = ports_.observer.explore(trial.view, elapsed);
        if (exploring.alive) {  // and so does this loop
            ports_.apparatus.beat();
        }
        if (exploring.signal == Signal::abort || ports_.interrupted()) {
            result.outcome = Outcome::aborted;
            return;
        }
        if (exploring.signal == Signal::done && exploring.at_s >= timing.explore_min) {
            result.outcome = Outcome::complete;
            result.done_s = exploring.at_s;
            result.done_uncertainty_s = exploring.uncertainty_s;
            return;
        }
        if (ports_.apparatus.exhausted()) {
            result.outcome = Outcome::complete;
            return;
        }
        if (elapsed >= timing.explore_timeout) {
            result.outcome = Outcome::timed_out;
            return;
        }
    }
}

/// A trip before done spoils the trial, also when it was seen only afterwards; one in the ramp out
/// of the force spoils nothing that was felt, unless more was to come, or an encoder stands still:
/// that is told from strokes, and they were felt.
void TrialRunner::note_fault(Running& trial) {
    TrialResult& result = trial.result;
    const bool more = trial.view.interval < trial.view.intervals;
    const engine::Trip cause = ports_.apparatus.trip();
    const bool felt =
        tripped_s_ && (*tripped_s_ <= result.done_s || cause == engine::Trip::stuck_encoder);
    if (is_answered(result.outcome) && (felt || (tripped_s_ && more))) {
        result.outcome = Outcome::faulted;
        result.done_s = std::min(result.done_s, *tripped_s_);
    }
    if (result.outcome != Outcome::faulted) {
        if (tripped_s_) {
            happened_({.kind = EventKind::fault,
                       .text = fmt::format("after the exploration at position {} had ended: {}",
                                           trial.planned.position, to_string(cause)),
                       .trial = trial.id,
                       .position = trial.planned.position,
                       .value = std::string(to_string(cause))});
        }
        return;
    }
    result.fault = fault_of(cause);
}

std::optional<RuleAnswer> TrialRunner::answer(Running& trial, std::span<const Presentation> felt) {
    const PlannedTrial& planned = trial.planned;
    TrialResult& result = trial.result;
    const Choice choice = ports_.observer.choose(trial.view, question_);
    if (choice.signal != Signal::done) {
        result.outcome = choice.signal == Signal::too_late ? Outcome::unanswered : Outcome::aborted;
        return std::nullopt;
    }
    note_away(planned, choice.away_s);
    Response response{choice};
    if (!question_.confidence) {
        response.confidence.reset();
    }
    response.correct = is_right(protocol_, plan_, planned, felt, choice.place);
    if (question_.kind == ResponseKind::identification) {
        response.object = plan_.picture_order.at(choice.place);
    }
    if (!ports_.apparatus.repeats()) {
        const auto each = std::views::transform(result.intervals, &IntervalResult::summary);
        const std::vector<TrialSummary> summaries(each.begin(), each.end());
        result.invalid = why_invalid(protocol_, summaries, !simulated_);
    }
    result.response = response;
    if (!planned.adaptive || planned.phase == Phase::practice || !result.invalid.empty()) {
        return std::nullopt;
    }
    const Presentation& chosen = felt[felt.size() == 1 ? 0 : planned.adaptive->comparison - 1];
    return RuleAnswer{.run = planned.adaptive->run,
                      .stimulus = chosen.stimulus.value(),
                      .outcome = outcome_of(protocol_, planned, response),
                      .track = std::string(progress_.runs().of(planned.adaptive->run).track())};
}

/// @param exploring  the ticks count for the summary and for the observer; the ramp out does not
void TrialRunner::drain(TrialId id, bool exploring) {
    for (;;) {
        const std::size_t n = ports_.apparatus.ring().pop(buffer_);
        if (n == 0) {
            return;
        }
        const std::span<const engine::TickRecord> ticks(buffer_.data(), n);
        for (const engine::TickRecord& tick : ticks) {
            if ((tick.flags & engine::tick_fault) != 0 && !tripped_s_) {
                tripped_s_ = static_cast<double>(tick.time_ns) * 1e-9;
            }
        }
        if (exploring) {
            meter_->add(ticks);
            ports_.observer.feel(ticks);
        }
        ports_.recorder.append(id, ticks);
    }
}

/// Its time says less, and so may the answer: who looks on decides whether it counts.
void TrialRunner::note_away(const PlannedTrial& planned, double away_s) {
    constexpr double kGlance = 0.1;
    if (away_s <= kGlance) {
        return;
    }
    const std::string text = fmt::format(
        "for {:.1f} s the question was out of sight, or the keyboard with another window", away_s);
    happened_({.kind = EventKind::note,
               .text = text,
               .trial = last_,
               .position = planned.position,
               .duration_s = away_s,
               .key = "question away"});
    ports_.alarm(
        {.sentence = text + ": its answer is kept; mark the trial if it should not count"});
}

void TrialRunner::note_lost_ticks(const Running& trial) {
    if (const std::int64_t lost = ports_.apparatus.dropped() - dropped_; lost > 0) {
        dropped_ += lost;
        happened_({.kind = EventKind::ticks_lost,
                   .text = fmt::format("{} found the ring full at position {}",
                                       counted(lost, "tick"), trial.planned.position),
                   .trial = trial.id,
                   .position = trial.planned.position,
                   .count = lost});
    }
}

}  // namespace palpate::protocols
