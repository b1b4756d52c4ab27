#include "protocols/running/trial_runner.hpp"

#include <fmt/format.h>

#include "protocols/running/pending_trials.hpp"
#include "protocols/running/trial_scene.hpp"

namespace palpate::protocols {
namespace {

/// Switches the force off when the felt part ends, however it ends.
class Felt {
public:
    Felt(Apparatus& apparatus, const engine::Scene& scene, const PlannedTrial& planned)
        : apparatus_(&apparatus) {
        apparatus.begin(scene, planned);
    }
    Felt(const Felt&) = delete;
    Felt& operator=(const Felt&) = delete;
    ~Felt() { end(); }
    void end() {
        if (apparatus_ != nullptr) {
            apparatus_->end();
            apparatus_ = nullptr;
        }
    }

private:
    Apparatus* apparatus_;
};

}  // namespace

TrialRunner::TrialRunner(const Protocol& protocol, const Plan& plan, Ports& ports, bool simulated)
    : protocol_(protocol),
      plan_(plan),
      ports_(ports),
      simulated_(simulated),
      pictures_(make_pictures(protocol, plan.picture_order)) {}

TrialView TrialRunner::view_of(const PlannedTrial& planned, std::size_t number) const {
    return {.number = number,
            .total = plan_.trials.size(),
            .practice = planned.phase == Phase::practice,
            .explore_min_s = protocol_.timing.explore_min,
            .explore_prompt_s = protocol_.timing.explore_prompt,
            .explore_timeout_s = protocol_.timing.explore_timeout};
}

TrialResult TrialRunner::run(const PlannedTrial& planned, const TrialView& view) {
    TrialResult result;
    if (ports_.observer.ready(view) == Signal::abort || ports_.interrupted()) {
        result.outcome = Outcome::aborted;
        result.begun = false;
        return result;
    }
    if (ports_.desk != nullptr && ports_.desk->wants()) {
        result.begun = false;
        return result;
    }
    const engine::Scene scene = make_scene(protocol_, planned.condition);
    const TrialId id = ports_.recorder.begin_trial(
        planned, {.slip_decay = scene.decay().slip, .heal_decay = scene.decay().heal});
    last_ = id;
    meter_ = TrialMeter(protocol_.apparatus.stiffness);
    tripped_s_.reset();
    {
        Felt felt(ports_.apparatus, scene, planned);
        explore(id, view, result);
        felt.end();
        drain(id, false);
    }
    result.summary = meter_.summary();
    note_fault(planned, result);
    if (is_answered(result.outcome)) {
        answer(planned, view, result);
    }
    ports_.recorder.end_trial(id, result);
    note_lost_ticks(planned);
    ports_.progress(planned, result);
    return result;
}

void TrialRunner::explore(TrialId id, const TrialView& view, TrialResult& result) {
    const TimingSpec& timing = protocol_.timing;
    for (;;) {
        const engine::ServoStatus status = ports_.apparatus.advance();
        drain(id, true);
        const double elapsed = ports_.apparatus.elapsed_s();
        result.done_s = elapsed;
        if (status == engine::ServoStatus::faulted) {
            result.outcome = Outcome::faulted;
            return;
        }
        const Exploring exploring = ports_.observer.explore(view, elapsed);
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

/// A trip before done spoils the trial, also when it was seen only afterwards; one in the ramp out of the
/// force spoils nothing that was felt.
void TrialRunner::note_fault(const PlannedTrial& planned, TrialResult& result) {
    const bool felt = tripped_s_ && *tripped_s_ <= result.done_s;
    if (is_answered(result.outcome) && felt) {
        result.outcome = Outcome::faulted;
        result.done_s = *tripped_s_;
    }
    const engine::Trip cause = ports_.apparatus.trip();
    if (result.outcome != Outcome::faulted) {
        if (tripped_s_) {
            ports_.recorder.event("fault",
                                  fmt::format("after the exploration at position {} had ended: {}",
                                              planned.position, to_string(cause)));
        }
        return;
    }
    const std::string trouble = ports_.apparatus.trouble();
    result.fault = Fault{.cause = cause,
                         .text = trouble.empty() ? std::string(explanation(cause)) : trouble,
                         .last = ports_.apparatus.last_ticks()};
}

void TrialRunner::answer(const PlannedTrial& planned, const TrialView& view, TrialResult& result) {
    const Choice choice = ports_.observer.choose(view, which_of(pictures_));
    if (choice.signal == Signal::abort) {
        result.outcome = Outcome::aborted;
        return;
    }
    const std::size_t object = plan_.picture_order.at(choice.place);
    result.response = Response{.place = choice.place,
                               .object = object,
                               .correct = object == planned.condition.object,
                               .reaction_s = choice.reaction_s,
                               .uncertainty_s = choice.uncertainty_s,
                               .input = choice.input};
    if (!ports_.apparatus.repeats()) {
        result.invalid = why_invalid(protocol_, result.summary, !simulated_);
    }
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
            meter_.add(ticks);
            ports_.observer.feel(ticks);
        }
        ports_.recorder.append(id, ticks);
    }
}

void TrialRunner::note_lost_ticks(const PlannedTrial& planned) {
    if (const std::int64_t lost = ports_.apparatus.dropped() - dropped_; lost > 0) {
        dropped_ += lost;
        ports_.recorder.event(
            "ticks lost",
            fmt::format("{} ticks found the ring full at position {}", lost, planned.position));
    }
}

}  // namespace palpate::protocols
