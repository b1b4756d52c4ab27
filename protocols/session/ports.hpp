#pragma once

#include <functional>

#include "protocols/session/operator_desk.hpp"
#include "protocols/session/progress.hpp"
#include "protocols/session/recorder.hpp"
#include "protocols/trial/apparatus.hpp"
#include "protocols/trial/observer.hpp"

namespace palpate::protocols {

/// Waits on the wall clock, s.
void sleep_for(double seconds);

/// An attempt that has ended, for whoever looks on.
struct Progress {
    const PlannedTrial& planned;
    const TrialResult& result;
    TrialId trial = 0;
    TrialNumber number{};          ///< as its screens said
    const SessionProgress& known;  ///< what the session knows now
    double waited_s = 0.0;         ///< in pauses and troubles since the attempt before

    /// Trials still to run, those set back counted; and whether this one is among them.
    [[nodiscard]] std::size_t left() const { return known.pending().order().size(); }
    [[nodiscard]] bool runs_again() const { return known.pending().has(planned.position); }
};

/// The three ports of a session, and how to interrupt it. All outlive the run.
struct Ports {
    Apparatus& apparatus;
    Observer& observer;
    Recorder& recorder;
    std::vector<Event> opening{};  ///< what was found of the rig at its opening, kept first
    /// Asked before each trial and while one runs: true ends the session.
    std::function<bool()> interrupted = [] {
        return false;
    };  ///< e.g. a signal arrived
    /// Hears of every event when it is kept, of what an interval lets one feel when it begins, and
    /// of every attempt when it is stored.
    std::function<void(const Event&)> happened = [](const Event&) {
    };
    std::function<void(TrialId, const Presentation&)> felt = [](TrialId, const Presentation&) {
    };
    std::function<void(const Progress&)> progress = [](const Progress&) {
    };
    /// What is wrong, each time that it becomes another sentence: whoever could mend it is to hear
    /// of it.
    std::function<void(const TroubleView&)> alarm = [](const TroubleView&) {
    };
    /// A pause of the experimenter's begins (true), or is over.
    std::function<void(bool)> paused = [](bool) {
    };
    /// What became of a mark at the desk.
    std::function<void(const MarkReply&)> marked = [](const MarkReply&) {
    };
    std::function<void(double)> pause = sleep_for;  ///< between two questions after a fault, s
    OperatorDesk* desk = nullptr;                   ///< none: nobody asks for anything
};

}  // namespace palpate::protocols
