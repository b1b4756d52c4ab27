#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/device/machine.hpp"
#include "protocols/design/plan.hpp"
#include "protocols/observer/person.hpp"
#include "protocols/protocol/protocol.hpp"
#include "protocols/session/progress.hpp"
#include "protocols/session/recorder.hpp"
#include "protocols/trial/presentation.hpp"
#include "data/store/database.hpp"
#include "data/store/reader.hpp"
#include "data/verify/stored_trace.hpp"

namespace palpate::data {

/// What the trials of a session are checked against.
struct SessionFrame {
    protocols::Protocol protocol;
    std::string protocol_hash;
    protocols::SessionKey key;
    std::uint64_t seed = 0;
    protocols::Plan plan;                           ///< as drawn again
    std::vector<std::string> pictures;              ///< as stored, from the left
    std::optional<engine::PantographSpec> machine;  ///< with which the session began
    std::optional<engine::Gantry> gantry;           ///< the same, where no other followed
    bool simulated = false;
    std::optional<protocols::Person> person{};  ///< of an observer file, who answered
    bool traceless = false;                     ///< simulated without keeping ticks
    bool replayed = false;  ///< by recorded hands: no answer was judged by how its object was felt
};

/// One interval of a trial: its row of presentation, and its ticks.
struct CheckedInterval {
    StoredRow row;
    /// What the ticks follow from, until all that they say is checked.
    std::shared_ptr<const engine::FeltScene> scene;
    StoredChunks chunks;
    StoredTrace trace;
};

/// A scene of a session: most trials let one feel what an earlier one did.
struct KnownScene {
    protocols::Presentation felt;
    protocols::SceneConstants here;                  ///< by exp() of this machine
    std::shared_ptr<const engine::FeltScene> scene;  ///< with those that were recorded
};

/// The intervals of a trial against what they should have let one feel: rows of presentation and
/// decays. Ticks are left to check_ticks().
/// @param expected  what the plan and the rule say
/// @param known     those of trials before, for this one and those to come
[[nodiscard]] std::vector<CheckedInterval> check_intervals(
    Database& database,
    const SessionFrame& frame,
    const StoredRow& trial,
    std::span<const protocols::Presentation> expected,
    bool answered,
    std::vector<KnownScene>& known,
    Findings& findings);

/// Chunks, replay and times of each interval. Asks no database: for any thread.
void check_ticks(const SessionFrame& frame,
                 std::span<CheckedInterval> intervals,
                 std::int64_t period_ns,
                 Findings& findings);

/// The row of response: place, object and correct by the kind of answer, and their ranges.
/// @return false if it is no answer to the question
bool check_response(const SessionFrame& frame,
                    const StoredRow& response,
                    const protocols::PlannedTrial& planned,
                    std::span<const protocols::Presentation> felt,
                    Findings& findings);

/// What the rule takes in with the answer of a trial.
/// @param stimulus  what the rule chose
/// @param runs      before the answer
[[nodiscard]] protocols::RuleAnswer rule_answer(const SessionFrame& frame,
                                                const StoredRow& response,
                                                const protocols::PlannedTrial& planned,
                                                double stimulus,
                                                const protocols::AdaptiveRuns& runs);

/// The row of adaptive_step of a trial: none without an answer that the rule took in; else outcome,
/// estimates and state are those of the rule.
/// @param runs  with the answer
void check_step(Database& database,
                std::int64_t trial,
                const std::optional<protocols::RuleAnswer>& answer,
                const protocols::AdaptiveRuns& runs,
                Findings& findings);

/// The columns of a trial that ended and of its intervals, added up again from its ticks.
///
/// How many ticks were felt (the rest is the ramp out of the force) is known where the clock was
/// virtual; on a real one the stored number is believed as far as a whole ramp stands behind it.
/// @param force  the device of the trial gives some
/// @return what was felt of each interval; nothing where ticks are missing
std::vector<protocols::TrialSummary> check_summary(const SessionFrame& frame,
                                                   const StoredRow& trial,
                                                   std::span<const CheckedInterval> intervals,
                                                   bool answered_by_numbers,
                                                   bool force,
                                                   Findings& findings);

/// Why an answer does not count: by the rules of [invalid], or because somebody marked it.
/// @param mark  the reason of its mark, if it has one @param felt of each interval, from
/// check_summary()
void check_invalid(const SessionFrame& frame,
                   const StoredRow& trial,
                   const std::optional<std::string>& mark,
                   std::span<const protocols::TrialSummary> felt,
                   Findings& findings);

/// The rows of fault_tick: the last ticks of the last interval, at most 100, for a faulted trial;
/// none else.
/// @param rows  of the trial, by tick
void check_fault_ticks(std::span<const StoredRow> rows,
                       const StoredRow& trial,
                       const StoredTrace& last,
                       Findings& findings);

}  // namespace palpate::data
