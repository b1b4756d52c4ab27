#include "protocols/session/session.hpp"

#include <chrono>
#include <thread>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "engine/realtime/servo.hpp"
#include "protocols/session/trial_runner.hpp"
#include "protocols/session/trouble.hpp"
#include "protocols/session/trust.hpp"

namespace palpate::protocols {
namespace {

class Session {
public:
    Session(const Protocol& protocol,
            const Plan& plan,
            SessionProgress progress,
            Ports& ports,
            bool simulated)
        : protocol_(protocol),
          plan_(plan),
          ports_(ports),
          progress_(std::move(progress)),
          runner_(protocol,
                  plan,
                  ports,
                  simulated,
                  progress_,
                  [this](const Event& event) { happened(event); }),
          rested_(pending().answered()) {}

    SessionEnd run(const SessionView& view) {
        for (const Event& event : ports_.opening) {
            happened(event);
        }
        if (ports_.observer.welcome(view) == Signal::abort) {
            return stopped();
        }
        for (bool fresh = true; check_mark(), !pending().empty();) {
            next_ = runner_.view_of(pending());
            const std::size_t marks = marks_;
            if (check_stop() == Signal::abort || check_pause() == Signal::abort) {
                return stopped();
            }
            if (wants_stop()) {  // since the pause
                continue;
            }
            if (const engine::Trip moved = ports_.apparatus.moved(); moved != engine::Trip::none) {
                const Fault fault{
                    .cause = moved, .text = std::string(explanation(moved)), .last = {}};
                if (lost_before(plan_.trials.at(pending().next()), fault) == Signal::abort) {
                    return stopped();
                }
                continue;
            }
            if ((!fresh || !trusted()) && between() == Signal::abort) {
                return stopped();
            }
            fresh = true;  // what is wanted now comes without another gap
            // Who stopped a proof goes on before it is right; after a mark another trial may be
            // next.
            if (wanted() || !trusted() || marks_ != marks) {
                continue;
            }
            if (const auto end = attempt(fresh)) {
                return *end;
            }
        }
        note_timing();
        note_stop(ports_);  // nothing is felt any more
        ports_.recorder.finish_session();
        ports_.observer.finish(view);
        return ended(SessionEnd::Why::finished);
    }

private:
    /// What an attempt leaves behind, and whoever looks on hears of it.
    void keep(const PlannedTrial& planned, const TrialNumber& number, const TrialResult& result) {
        last_ = runner_.last();
        trust_ = apply(trust_, Attempt{.trial = *last_, .position = planned.position});
        last_number_ = number;
        last_position_ = planned.position;
        ports_.progress({.planned = planned,
                         .result = result,
                         .trial = *last_,
                         .number = number,
                         .known = progress_,
                         .waited_s = std::exchange(waited_s_, 0.0)});
    }

    /// One attempt at the next trial, and what its fault asks for. `fresh`: nothing was begun.
    /// @return the session's end, if it ended it
    std::optional<SessionEnd> attempt(bool& fresh) {
        const PlannedTrial& planned = plan_.trials.at(pending().next());
        const TrialNumber number = pending().number();
        const TrialResult result = runner_.run(planned, next_);
        if (!result.begun) {
            const bool over =
                result.outcome == Outcome::aborted ||
                (result.fault && lost_before(planned, *result.fault) == Signal::abort);
            return over ? std::optional(stopped()) : std::nullopt;
        }
        fresh = false;
        keep(planned, number, result);
        if (result.outcome == Outcome::aborted) {
            last_.reset();  // a mark that was made meanwhile was not meant for the one before
            return stopped();
        }
        note_invalid(planned, result);
        if (tell(next_, result) == Signal::abort) {
            return stopped();
        }
        faults_ = result.fault ? faults_ + 1 : 0;
        if (!result.fault) {
            return std::nullopt;
        }
        return after_fault(planned, *result.fault);
    }

    /// @return the session's end, if nobody mended it
    std::optional<SessionEnd> after_fault(const PlannedTrial& planned, const Fault& fault) {
        note_attempt(EventKind::fault, planned,
                     fmt::format("{}: {}", to_string(fault.cause), fault.text),
                     to_string(fault.cause));
        note_timing();
        const MendResult end = waiting([&] { return mend(ports_, fault, faults_, rig(), last_); });
        return end.signal == Signal::give_up ? std::optional(gave_up(fault, end.tries))
             : end.signal != Signal::go_on   ? std::optional(stopped())
                                             : std::nullopt;
    }

    [[nodiscard]] const PendingTrials& pending() const { return progress_.pending(); }

    [[nodiscard]] bool wanted() const { return ports_.desk->wants(); }
    [[nodiscard]] bool wants_stop() const { return ports_.desk->wants_stop(); }

    void happened(const Event& event) {
        ports_.recorder.event(event);
        ports_.happened(event);
        const bool waited = event.kind == EventKind::go_on || event.kind == EventKind::provenance;
        waited_s_ += waited ? event.duration_s.value_or(0.0) : 0.0;
        progress_ = apply(std::move(progress_), event);
        trust_ = apply(trust_, event);
        if (const auto other = other_board(event, ports_.apparatus, board_)) {
            happened(*other);
        }
    }

    /// Force may be felt.
    [[nodiscard]] bool trusted() const {
        return !ports_.apparatus.has_proof() || trust_.gives_force();
    }
    [[nodiscard]] TrustPort rig() {
        return {.trust = trust_, .happened = [this](const Event& event) {
                    happened(event);
                }};
    }

    /// A mark concerns the last attempt of this run.
    void check_mark() {
        const auto reason = ports_.desk->take_mark();
        if (!reason) {
            return;
        }
        MarkReply reply{.found = last_ && progress_.counts(*last_), .reason = *reason};
        const std::string why = (reason->empty() ? "" : ": ") + *reason;
        if (reply.found) {
            happened({.kind = EventKind::mark, .text = kMarkedAtDesk + why, .trial = last_});
            reply = {.found = true,
                     .runs_again = pending().has(last_position_),
                     .number = last_number_,
                     .next = pending().number(),
                     .trial = *last_,
                     .reason = *reason};
            next_ = pending().empty() ? next_ : runner_.view_of(pending());
            last_.reset();
            ++marks_;
        } else {
            happened({.kind = EventKind::note, .text = "a mark found no answer that counts" + why});
        }
        ports_.desk->reply(reply);
        ports_.marked(reply);
    }

    /// Nobody feels anything meanwhile: a mark is kept and answered while it waits, not after it.
    template <class Wait>
    std::invoke_result_t<Wait&> waiting(Wait wait) {
        struct Until {
            OperatorDesk* desk;
            ~Until() {
                desk->answer_at_once({});
                desk->await_handle({});
            }
        } const until{ports_.desk};
        ports_.desk->answer_at_once([this] { check_mark(); });
        return wait();
    }

    /// A stop while nothing is felt, and what stands against every trial, hold the session until
    /// the experimenter goes on.
    Signal check_stop() {
        const engine::Trip cause = engine::Trip::stopped;
        const std::string why(explanation(cause));
        return wants_stop() ? mended({.cause = cause, .text = why, .last = {}}) : Signal::go_on;
    }

    Signal check_pause() {
        if (!ports_.desk->take_pause()) {
            return Signal::go_on;
        }
        note_before_next(EventKind::pause);
        const std::int64_t begun = monotonic_ns();
        ports_.paused(true);
        const Signal signal = waiting([&] { return ports_.observer.pause(next_); });
        ports_.paused(false);
        const double paused = static_cast<double>(monotonic_ns() - begun) * 1e-9;
        if (signal == Signal::go_on && !wants_stop()) {
            happened({.kind = EventKind::go_on,
                      .text = fmt::format("after a pause of {:.1f} s", paused),
                      .duration_s = paused});
        }
        return signal;
    }

    /// A break where the plan has one after as many answered trials, once, and a short one where
    /// the rig has to be proved; a gap elsewhere.
    Signal between() {
        const std::size_t done = pending().answered();
        const bool planned = plan_.trials[done].break_before && rested_ != done;
        if (!planned && trusted()) {
            return waiting([&] { return ports_.observer.gap(protocol_.timing.gap); });
        }
        if (!trusted() && trust_.state == Trust::unknown) {
            return mend_unproved(kNotProved);
        }
        rested_ = planned ? done : rested_;
        note_before_next(EventKind::rest);
        HandleCheck check(ports_.apparatus, trust_);
        const Signal signal = waiting([&] {
            ports_.desk->await_handle([&check] { return !check.over(); });
            return ports_.observer.rest(planned ? protocol_.timing.break_min : 0.0, next_);
        });
        return signal == Signal::go_on ? check_handle(check) : signal;
    }

    /// What was proved in a break. Where something was not right the session goes on once it is.
    Signal check_handle(HandleCheck& check) {
        check.finish();
        while (!check.over()) {
            if (ports_.observer.gap(kTroubleSlice) == Signal::abort || ports_.interrupted()) {
                return Signal::abort;
            }
        }
        for (const Event& event : check.proved()) {
            happened(event);
        }
        if (check.refused().empty()) {
            return trusted() || wants_stop() ? Signal::go_on : mend_unproved(kAnother);
        }
        const Event refused = refused_proof(trust_, check.refused());
        happened(refused);
        return wants_stop() ? Signal::go_on : mend_unproved(refused.text);
    }

    /// The device went away, or its handle moved as no hand does, before anybody began: no attempt
    /// has failed.
    Signal lost_before(const PlannedTrial& planned, const Fault& fault) {
        ports_.apparatus.forget_move();
        happened({.kind = EventKind::fault,
                  .text = fmt::format("before the trial at position {}: {}", planned.position,
                                      fault.text),
                  .position = planned.position,
                  .value = std::string(to_string(fault.cause))});
        ports_.alarm({.sentence = fault.text});  // it may be mended before anybody hears of it
        return mended(fault);
    }

    Signal mend_unproved(const std::string& why) {
        return mended({.cause = engine::Trip::none, .text = why, .last = {}});
    }

    /// Between trials. @return go_on or abort
    Signal mended(const Fault& fault) {
        const MendResult end = waiting([&] { return mend(ports_, fault, 1, rig()); });
        return end.signal == Signal::go_on ? Signal::go_on : Signal::abort;
    }

    /// Says whether the answer was right, where the protocol wants that and it can be said.
    Signal tell(const TrialView& trial, const TrialResult& result) {
        const Feedback when = protocol_.response.feedback;
        const bool due = when == Feedback::all || (when == Feedback::practice && trial.practice);
        return due && result.response && result.response->correct ? waiting([&] {
            return ports_.observer.feedback(trial, *result.response->correct);
        })
                                                                  : Signal::go_on;
    }

    void note_invalid(const PlannedTrial& planned, const TrialResult& result) {
        if (!result.invalid.empty()) {
            note_attempt(EventKind::invalid, planned,
                         fmt::format("{}: {}", result.invalid,
                                     pending().has(planned.position) ? "will be run again"
                                                                     : "not run again"));
        }
    }

    SessionEnd stopped() {
        check_mark();
        note_stop(ports_);
        note_timing();
        note_before_next(EventKind::abort);
        return ended(SessionEnd::Why::aborted);
    }

    SessionEnd gave_up(const Fault& fault, std::size_t tries) {
        const std::string trouble = ports_.apparatus.trouble();
        note_before_next(EventKind::gave_up,
                         fmt::format(", after {} in vain and {} in a row",
                                     counted(tries, "try", "tries"), counted(faults_, "fault")),
                         static_cast<std::int64_t>(tries));
        SessionEnd end = ended(SessionEnd::Why::faulted);
        end.fault = trouble.empty() ? fault.text : trouble;
        end.in_a_row = faults_;
        end.tries = tries;
        return end;
    }

    [[nodiscard]] SessionEnd ended(SessionEnd::Why why) const {
        return {.why = why, .next = pending().next(), .number = pending().number()};
    }

    void note_timing() {
        if (const std::string timing = ports_.apparatus.timing(); !timing.empty()) {
            happened({.kind = EventKind::timing, .text = timing});
        }
    }

    /// Of the trial that would come now.
    void note_before_next(EventKind kind,
                          const std::string& more = {},
                          std::optional<std::int64_t> count = {}) {
        const std::size_t position = pending().next();
        happened({.kind = kind,
                  .text = fmt::format("before the trial at position {}{}", position, more),
                  .position = position,
                  .count = count});
    }

    /// Of the attempt that is over.
    void note_attempt(EventKind kind,
                      const PlannedTrial& planned,
                      const std::string& what,
                      std::string_view value = {}) {
        happened({.kind = kind,
                  .text = fmt::format("position {}: {}", planned.position, what),
                  .trial = last_,
                  .position = planned.position,
                  .value = std::string(value)});
    }

    const Protocol& protocol_;
    const Plan& plan_;
    Ports& ports_;
    SessionProgress progress_;
    RigTrust trust_;
    std::string board_ = ports_.apparatus.identity();
    TrialRunner runner_;           ///< notes what becomes of its trials in progress_
    std::size_t rested_;           ///< answered trials at the last break, or when this run began
    std::size_t faults_ = 0;       ///< in a row
    std::optional<TrialId> last_;  ///< the attempt before now, of this run; a mark would mean it
    TrialNumber last_number_{};
    TrialView next_{};  ///< a mark in a break changes it
    std::size_t last_position_ = 0;
    std::size_t marks_ = 0;  ///< answers that the desk took back
    double waited_s_ = 0.0;  ///< in pauses and troubles since the last attempt
};

}  // namespace

void sleep_for(double seconds) {
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

SessionEnd run_session(const Protocol& protocol,
                       const Plan& plan,
                       const SessionView& view,
                       SessionProgress progress,
                       Ports ports) {
    OperatorDesk nobody;
    ports.desk = ports.desk == nullptr ? &nobody : ports.desk;
    return Session(protocol, plan, std::move(progress), ports, view.simulated).run(view);
}

}  // namespace palpate::protocols
