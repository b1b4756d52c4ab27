#include "protocols/session/session.hpp"

#include <chrono>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "engine/realtime/servo.hpp"
#include "protocols/session/trial_runner.hpp"
#include "protocols/session/trouble.hpp"

namespace palpate::protocols {
namespace {

class Session {
public:
    Session(const Protocol& protocol,
            const Plan& plan,
            PendingTrials pending,
            Ports& ports,
            bool simulated,
            AdaptiveRuns& runs)
        : protocol_(protocol),
          plan_(plan),
          ports_(ports),
          runs_(runs),
          runner_(protocol, plan, ports, simulated, runs),
          pending_(std::move(pending)),
          rested_(pending_.answered()) {}

    SessionEnd run(const SessionView& view) {
        if (ports_.observer.welcome(view) == Signal::abort) {
            return stopped();
        }
        for (bool fresh = true; heed_mark(), !pending_.empty();) {
            const TrialView next = view_of_next();
            if (heed_pause(next) == Signal::abort || (!fresh && between(next) == Signal::abort)) {
                return stopped();
            }
            fresh = true;  // what is wanted now comes without another gap
            if (wanted()) {
                continue;
            }
            const PlannedTrial& planned = plan_.trials.at(pending_.next());
            const TrialResult result = runner_.run(planned, next);
            if (!result.begun) {
                if (result.outcome == Outcome::aborted) {
                    return stopped();
                }
                continue;
            }
            fresh = false;
            const TrialNumber number = pending_.number();
            last_ = Last{planned.position, result.outcome, runner_.last(),
                         result.response && result.invalid.empty(), pending_};
            pending_.note(planned.position, result.outcome, result.invalid.empty());
            ports_.progress({.planned = planned,
                             .result = result,
                             .number = number,
                             .left = pending_.order().size(),
                             .runs_again = pending_.has(planned.position)});
            if (result.outcome == Outcome::aborted) {
                last_.reset();  // a mark that was made meanwhile was not meant for the one before
                return stopped();
            }
            note_invalid(planned, result);
            if (tell(next, result) == Signal::abort) {
                return stopped();
            }
            faults_ = result.fault ? faults_ + 1 : 0;
            if (result.fault) {
                ports_.recorder.event(
                    "fault", fmt::format("position {}: {}: {}", planned.position,
                                         to_string(result.fault->cause), result.fault->text));
                note_timing();
                const Mended mended = mend(ports_, *result.fault, faults_);
                if (mended.signal == Signal::give_up) {
                    return gave_up(*result.fault, mended.tries);
                }
                if (mended.signal != Signal::go_on) {
                    return stopped();
                }
            }
        }
        note_timing();
        ports_.recorder.finish_session();
        ports_.observer.finish(view);
        return {
            .why = SessionEnd::Why::finished, .next = pending_.next(), .number = pending_.number()};
    }

private:
    [[nodiscard]] TrialView view_of_next() const {
        return runner_.view_of(pending_.number(), pending_.answered());
    }

    [[nodiscard]] bool wanted() const { return ports_.desk != nullptr && ports_.desk->wants(); }

    /// A mark concerns the last attempt, which was the last to change what is left: that change is made
    /// again, with an answer that does not count. So does whoever resumes from the database.
    void heed_mark() {
        if (ports_.desk == nullptr || !ports_.desk->take_mark()) {
            return;
        }
        if (!last_ || !last_->counts) {
            ports_.recorder.event("note", "a mark found no answer that counts");
            return;
        }
        ports_.recorder.mark(last_->id, kMarkedAtDesk);
        runs_.forget(last_->id);
        pending_ = last_->before;
        pending_.note(last_->position, last_->outcome, false);
        last_.reset();
    }

    Signal heed_pause(const TrialView& next) {
        if (ports_.desk == nullptr || !ports_.desk->take_pause()) {
            return Signal::go_on;
        }
        ports_.recorder.event("pause", before_next());
        const std::int64_t begun = engine::monotonic_ns();
        const Signal signal = ports_.observer.pause(next);
        ports_.recorder.event(
            "go on", fmt::format("after a pause of {:.1f} s",
                                 static_cast<double>(engine::monotonic_ns() - begun) * 1e-9));
        return signal;
    }

    /// A break where the plan has one after as many answered trials, once; a gap elsewhere.
    Signal between(const TrialView& next) {
        const std::size_t done = pending_.answered();
        if (!plan_.trials[done].break_before || rested_ == done) {
            return ports_.observer.gap(protocol_.timing.gap);
        }
        rested_ = done;
        ports_.recorder.event("break", before_next());
        return ports_.observer.rest(protocol_.timing.break_min, next);
    }

    /// Says whether the answer was right, where the protocol wants that and it can be said.
    Signal tell(const TrialView& trial, const TrialResult& result) {
        const Feedback when = protocol_.response.feedback;
        const bool due = when == Feedback::all || (when == Feedback::practice && trial.practice);
        return due && result.response && result.response->correct
                 ? ports_.observer.feedback(trial, *result.response->correct)
                 : Signal::go_on;
    }

    void note_invalid(const PlannedTrial& planned, const TrialResult& result) {
        if (!result.invalid.empty()) {
            ports_.recorder.event(
                "invalid", fmt::format("position {}: {}: {}", planned.position, result.invalid,
                                       pending_.has(planned.position) ? "will be run again"
                                                                      : "not run again"));
        }
    }

    SessionEnd stopped() {
        heed_mark();
        note_timing();
        ports_.recorder.event("abort", before_next());
        return {
            .why = SessionEnd::Why::aborted, .next = pending_.next(), .number = pending_.number()};
    }

    SessionEnd gave_up(const Fault& fault, std::size_t tries) {
        const std::string trouble = ports_.apparatus.trouble();
        ports_.recorder.event(
            "gave up", fmt::format("{}, after {} in vain and {} in a row", before_next(),
                                   counted(tries, "try", "tries"), counted(faults_, "fault")));
        return {.why = SessionEnd::Why::faulted,
                .next = pending_.next(),
                .number = pending_.number(),
                .fault = trouble.empty() ? fault.text : trouble,
                .in_a_row = faults_,
                .tries = tries};
    }

    void note_timing() {
        if (const std::string timing = ports_.apparatus.timing(); !timing.empty()) {
            ports_.recorder.event("timing", timing);
        }
    }

    [[nodiscard]] std::string before_next() const {
        return fmt::format("before the trial at position {}", pending_.next());
    }

    const Protocol& protocol_;
    const Plan& plan_;
    Ports& ports_;
    AdaptiveRuns& runs_;
    TrialRunner runner_;
    PendingTrials pending_;
    std::size_t rested_;      ///< answered trials at the last break, or when this run began
    std::size_t faults_ = 0;  ///< in a row

    /// The attempt before now.
    struct Last {
        std::size_t position = 0;
        Outcome outcome{};
        TrialId id = 0;
        bool counts = false;   ///< it has an answer, and no rule of [invalid] was broken
        PendingTrials before;  ///< what was left when it began
    };
    std::optional<Last> last_;
};

}  // namespace

void sleep_for(double seconds) {
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

SessionEnd run_session(const Protocol& protocol,
                       const Plan& plan,
                       const SessionView& view,
                       PendingTrials pending,
                       Ports ports,
                       AdaptiveRuns runs) {
    if (runs.size() != protocol.runs.size()) {
        throw std::logic_error(
            fmt::format("{} rules for {} runs", runs.size(), protocol.runs.size()));
    }
    return Session(protocol, plan, std::move(pending), ports, view.simulated, runs).run(view);
}

}  // namespace palpate::protocols
