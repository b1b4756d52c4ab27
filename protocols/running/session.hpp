#pragma once

#include <functional>
#include <string>

#include "protocols/design/protocol.hpp"
#include "protocols/running/apparatus.hpp"
#include "protocols/running/observer.hpp"
#include "protocols/running/recorder.hpp"

namespace palpate::protocols {

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
};

struct SessionEnd {
    enum class Why : std::uint8_t { finished, aborted, faulted } why = Why::finished;
    std::size_t next = 0;  ///< first position that still has to run
};

/// Runs a plan from position `from` to its end, or until someone stops it.
///
/// A trial: ready -> force ramps in -> explore -> done or time-out -> force ramps out -> pictures ->
/// choice -> durable. The force is off whenever anything else happens, also when an exception (a
/// full disk) passes through.
[[nodiscard]] SessionEnd run_session(const Protocol& protocol,
                                     const Plan& plan,
                                     const SessionView& view,
                                     std::size_t from,
                                     Ports ports);

}  // namespace palpate::protocols
