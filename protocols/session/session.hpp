#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "protocols/protocol/protocol.hpp"
#include "protocols/session/ports.hpp"
#include "protocols/session/progress.hpp"

namespace palpate::protocols {

/// How a run of a session ended.
struct SessionEnd {
    enum class Why : std::uint8_t {
        finished,
        aborted,
        faulted,  ///< a fault that nobody mended
    } why = Why::finished;
    std::size_t next = 0;      ///< first position that still has to run
    TrialNumber number{};      ///< of that one, as its screens will say
    std::string fault{};       ///< of faulted: what happened last and what to do, a sentence
    std::size_t in_a_row = 0;  ///< of faulted: trials since the last good one
    std::size_t tries = 0;     ///< of faulted: how often the device was asked to come back, in vain
};

/// Runs what is pending of a plan to its end, or until someone stops it.
///
/// A trial: ready -> force ramps in -> explore -> done or time-out -> force ramps out -> pictures
/// -> choice -> durable. The force is off whenever anything else happens, also when an exception (a
/// full disk) passes through.
///
/// An answered trial that breaks a rule of [invalid] keeps its answer and its reason and is set
/// back (see PendingTrials). A trial whose force went off by itself ends as faulted, with its cause
/// and last ticks, and is set back too; the session goes on when the device works and the observer
/// agrees. Breaks come after as many answered trials as the plan says, whichever these were.
///
/// At the desk the experimenter may mark the running or the last trial: its answer stays, does not
/// count, and its position is set back as if it had never counted; and may pause before the next
/// trial: events "pause" and "go on" tell when and for how long. Both work from the welcome to the
/// ready screen as well.
///
/// In real time an event "timing" at each fault and at the end tells how late the ticks so far
/// were.
///
/// Where the protocol has a rule, it chooses what is felt, and takes in every answer that counts
/// before the next trial; practice does not go there. A trial that does not count leaves it as it
/// was: the next trial of the run is asked what this one was.
/// @param progress  of this protocol and plan, with all attempts and events so far
[[nodiscard]] SessionEnd run_session(const Protocol& protocol,
                                     const Plan& plan,
                                     const SessionView& view,
                                     SessionProgress progress,
                                     Ports ports);

}  // namespace palpate::protocols
