#pragma once

#include <functional>

#include "protocols/running/apparatus.hpp"
#include "protocols/running/observer.hpp"
#include "protocols/running/operator_desk.hpp"
#include "protocols/running/recorder.hpp"

namespace palpate::protocols {

/// Waits on the wall clock, s.
void sleep_for(double seconds);

/// The three ports of a session, and how to interrupt it. All outlive the run.
struct Ports {
    Apparatus& apparatus;
    Observer& observer;
    Recorder& recorder;
    std::function<bool()> interrupted = [] {
        return false;
    };  ///< e.g. a signal arrived
    std::function<void(const PlannedTrial&, const TrialResult&)> progress = [](const PlannedTrial&,
                                                                               const TrialResult&) {
    };
    std::function<void(double)> pause = sleep_for;  ///< between two questions after a fault, s
    OperatorDesk* desk = nullptr;                   ///< none: nobody asks for anything
};

}  // namespace palpate::protocols
