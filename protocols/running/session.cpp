#include "protocols/running/session.hpp"

#include <chrono>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>

#include "protocols/running/trial_runner.hpp"
#include "protocols/running/trouble.hpp"

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
          runner_(protocol, plan, ports, simulated, runs),
          pending_(std::move(pending)),
          rested_(pending_.answered()) {}

    SessionEnd run(const SessionView& view) {
        if (ports_.observer.welcome(view) == Signal::abort) {
            return stopped();
        }
        for (bool first = true; !pending_.empty(); first = false) {
            const PlannedTrial& planned = plan_.trials.at(pending_.next());
            const TrialView trial = runner_.view_of(planned, pending_.answered() + 1);
            if (!first && between(trial) == Signal::abort) {
                return stopped();
            }
            const TrialResult result = runner_.run(planned, trial);
            if (result.outcome == Outcome::aborted) {
                return stopped();
            }
            pending_.note(planned.position, result.outcome, result.invalid.empty());
            note_invalid(planned, result);
            if (tell(trial, result) == Signal::abort) {
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
        return {.why = SessionEnd::Why::finished, .next = pending_.next()};
    }

private:
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
        note_timing();
        ports_.recorder.event("abort", before_next());
        return {.why = SessionEnd::Why::aborted, .next = pending_.next()};
    }

    SessionEnd gave_up(const Fault& fault, std::size_t tries) {
        const std::string trouble = ports_.apparatus.trouble();
        ports_.recorder.event("gave up",
                              fmt::format("{}, after {} tries in vain and {} faults in a row",
                                          before_next(), tries, faults_));
        return {.why = SessionEnd::Why::faulted,
                .next = pending_.next(),
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
    TrialRunner runner_;
    PendingTrials pending_;
    std::size_t rested_;      ///< answered trials at the last break, or when this run began
    std::size_t faults_ = 0;  ///< in a row
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
