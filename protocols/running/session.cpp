#include "protocols/running/session.hpp"

#include <array>

#include "protocols/running/trial_meter.hpp"
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

class Running {
public:
    Running(const Protocol& protocol, const Plan& plan, Ports& ports)
        : protocol_(protocol),
          plan_(plan),
          ports_(ports),
          pictures_(make_pictures(protocol, plan.picture_order)) {}

    /// Runs one planned trial; its outcome says whether the session may go on.
    Outcome trial(const PlannedTrial& planned) {
        const TrialView view = view_of(planned);
        if (ports_.observer.ready(view) == Signal::abort || ports_.interrupted()) {
            return Outcome::aborted;
        }
        const engine::Scene scene = make_scene(protocol_, planned.condition);
        const TrialId id = ports_.recorder.begin_trial(
            planned, {.slip_decay = scene.decay().slip, .heal_decay = scene.decay().heal});
        meter_ = TrialMeter(protocol_.apparatus.stiffness);
        TrialResult result;
        {
            Felt felt(ports_.apparatus, scene, planned);
            explore(id, view, result);
            felt.end();
            drain(id, false);
        }
        result.summary = meter_.summary();
        if (result.outcome == Outcome::complete || result.outcome == Outcome::timed_out) {
            answer(planned, view, result);
        }
        ports_.recorder.end_trial(id, result);
        if (const std::int64_t lost = ports_.apparatus.dropped() - dropped_; lost > 0) {
            dropped_ += lost;
            ports_.recorder.event("ticks lost", std::to_string(lost) +
                                                    " ticks found the ring full at position " +
                                                    std::to_string(planned.position));
        }
        ports_.progress(planned, result);
        return result.outcome;
    }

    [[nodiscard]] TrialView view_of(const PlannedTrial& planned) const {
        return {.number = planned.position + 1,
                .total = plan_.trials.size(),
                .practice = planned.phase == Phase::practice,
                .explore_min_s = protocol_.timing.explore_min,
                .explore_prompt_s = protocol_.timing.explore_prompt,
                .explore_timeout_s = protocol_.timing.explore_timeout};
    }

private:
    void explore(TrialId id, const TrialView& view, TrialResult& result) {
        const TimingSpec& timing = protocol_.timing;
        for (;;) {
            const engine::ServoStatus status = ports_.apparatus.advance();
            drain(id, true);
            const double elapsed = ports_.apparatus.elapsed_s();
            const Exploring exploring = ports_.observer.explore(view, elapsed);
            result.done_s = elapsed;
            if (exploring.signal == Signal::abort || ports_.interrupted()) {
                result.outcome = Outcome::aborted;
                return;
            }
            if (status == engine::ServoStatus::faulted) {
                result.outcome = Outcome::faulted;
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

    void answer(const PlannedTrial& planned, const TrialView& view, TrialResult& result) {
        const Choice choice = ports_.observer.choose(view, pictures_);
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
    }

    /// @param exploring  the ticks count for the summary and for the observer; the ramp out does not
    void drain(TrialId id, bool exploring) {
        for (;;) {
            const std::size_t n = ports_.apparatus.ring().pop(buffer_);
            if (n == 0) {
                return;
            }
            const std::span<const engine::TickRecord> ticks(buffer_.data(), n);
            if (exploring) {
                meter_.add(ticks);
                ports_.observer.feel(ticks);
            }
            ports_.recorder.append(id, ticks);
        }
    }

    const Protocol& protocol_;
    const Plan& plan_;
    Ports& ports_;
    std::vector<Picture> pictures_;
    TrialMeter meter_{1.0};
    std::int64_t dropped_ = 0;  ///< ticks lost so far in this run
    std::array<engine::TickRecord, 256> buffer_{};
};

bool answered(Outcome outcome) {
    return outcome == Outcome::complete || outcome == Outcome::timed_out;
}

}  // namespace

SessionEnd run_session(const Protocol& protocol,
                       const Plan& plan,
                       const SessionView& view,
                       std::size_t from,
                       Ports ports) {
    Running running(protocol, plan, ports);
    const auto stopped = [&](std::size_t next, SessionEnd::Why why, std::string_view kind) {
        ports.recorder.event(kind, "before the trial at position " + std::to_string(next));
        return SessionEnd{why, next};
    };
    if (ports.observer.welcome(view) == Signal::abort) {
        return stopped(from, SessionEnd::Why::aborted, "abort");
    }
    for (std::size_t i = from; i < plan.trials.size(); ++i) {
        const PlannedTrial& planned = plan.trials[i];
        if (planned.break_before && i != from) {
            ports.recorder.event("break", "before the trial at position " + std::to_string(i));
            if (ports.observer.rest(protocol.timing.break_min, running.view_of(planned)) ==
                Signal::abort) {
                return stopped(i, SessionEnd::Why::aborted, "abort");
            }
        } else if (i != from && ports.observer.gap(protocol.timing.gap) == Signal::abort) {
            return stopped(i, SessionEnd::Why::aborted, "abort");
        }
        const Outcome outcome = running.trial(planned);
        if (!answered(outcome)) {
            return outcome == Outcome::faulted ? stopped(i, SessionEnd::Why::faulted, "fault")
                                               : stopped(i, SessionEnd::Why::aborted, "abort");
        }
    }
    ports.recorder.finish_session();
    ports.observer.finish(view);
    return {SessionEnd::Why::finished, plan.trials.size()};
}

}  // namespace palpate::protocols
