#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/base/side_by_side.hpp"
#include "engine/device/machine.hpp"
#include "engine/realtime/scene_view.hpp"
#include "engine/realtime/tick_record.hpp"
#include "protocols/design/plan.hpp"
#include "protocols/observer/person.hpp"
#include "protocols/protocol/protocol.hpp"
#include "protocols/session/progress.hpp"
#include "protocols/session/recorder.hpp"
#include "protocols/trial/presentation.hpp"
#include "data/store/database.hpp"
#include "data/store/reader.hpp"
#include "data/store/stored_progress.hpp"
#include "data/trace/replay.hpp"
#include "data/trace/ticks.hpp"
#include "data/verify/findings.hpp"

namespace palpate::data {

/// The ticks of an interval of a trial up to the first chunk that is not what was written.
struct StoredTrace {
    Ticks ticks;
    bool whole = true;  ///< nothing is damaged or missing in between
    /// Contacts are what chunks hold; else all are what the scene makes of HIP.
    bool holds_contacts = false;
    bool on_virtual_clock = true;  ///< no tick was ever late by anything
    bool punctual = true;          ///< all ticks are whole periods after the first deadline
};

/// Checks every chunk: codec, checksum, streams, counts, order, that the replay of what it does not
/// hold has the hash that the recorder wrote, and that what everybody can read is what the exact
/// numbers say.
/// @param chunks     of the interval, in order
/// @param scene      as the trial's, with its decays
/// @param period_ns  of the session
/// @param room       for the ticks, if it is large enough: pages that need not be cleared again
[[nodiscard]] StoredTrace check_trace(std::span<const ChunkView> chunks,
                                      const engine::SceneView& scene,
                                      const std::optional<engine::PantographSpec>& machine,
                                      std::int64_t period_ns,
                                      Findings& findings,
                                      Ticks room);

/// Where chunks hold contacts: runs the trial's recorded HIP through `scene` again and compares, to
/// the bit: force, normal and tangential force, GO, mu, u, segment, mode, and the flags skipped and
/// outside cone. One finding a column, with its first tick and how many differ. Other contacts are
/// the scene's already.
void check_replay(const engine::SceneView& scene, const StoredTrace& trace, Findings& findings);

/// Of three straight axes: HIP is where the counts say, in one finding with its first tick and how
/// many differ. A tick whose device gave no place, having no counts or some outside the workspace,
/// keeps that before it.
void check_counts(const engine::Gantry& gantry, const StoredTrace& trace, Findings& findings);

/// What is stored of a virtual clock's ticks: none is late, time goes in whole periods. A real
/// clock's ticks: time never goes back.
/// @param period_ns  T, ns
void check_times(const StoredTrace& trace, std::int64_t period_ns, Findings& findings);

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

/// Checks the attempts of one session in the order in which they were made. Their rows are looked
/// at one after the other, their ticks side by side.
class TrialCheck {
public:
    /// @param report  takes what is found, trial by trial, and how many ticks were replayed
    /// @param rooms   for ticks, of sessions before: for those to come
    TrialCheck(Database& database,
               std::int64_t session,
               const SessionFrame& frame,
               SessionReport& report,
               TickRooms& rooms);

    /// What is found may be in the report later only.
    void check(const StoredRow& trial);
    /// Everything that was found is in the report.
    void finish();
    [[nodiscard]] const protocols::SessionProgress& progress() const noexcept { return progress_; }

private:
    /// A trial of which the rows were looked at.
    struct TrialRows {
        StoredRow trial;
        std::optional<StoredRow> response{};
        std::vector<CheckedInterval> intervals{};
        std::vector<StoredRow> fault_ticks{};
        std::optional<std::string> mark{};
        bool force = true;       ///< its device gives some
        std::size_t done = 0;    ///< trials of the session before
        bool is_answer = false;  ///< to the question
        std::vector<Finding> found{};
        std::int64_t replayed = 0;           ///< ticks
        std::optional<std::size_t> ticks{};  ///< the task that looks at them
    };

    void take_events();
    void check_rows(TrialRows& pending, Findings& findings);
    void check_ticks_of(TrialRows& pending) const;
    void check_place(const StoredRow& trial, Findings& findings);
    void check_planned(TrialRows& pending,
                       const protocols::PlannedTrial& planned,
                       Findings& findings);
    void finish_first();
    [[nodiscard]] bool counted(const StoredRow& trial) const;
    void take(const StoredRow& trial,
              bool answered,
              const std::optional<protocols::RuleAnswer>& answer,
              Findings& findings);
    void check_cause(const StoredRow& trial, Findings& findings) const;
    void check_outcome(const TrialRows& pending, Findings& findings) const;
    [[nodiscard]] std::optional<double> stimulus_of(const protocols::PlannedTrial& planned,
                                                    Findings& findings) const;

    Database& database_;
    const SessionFrame& frame_;
    SessionReport& report_;
    TickRooms& rooms_;
    std::vector<KnownScene> known_;
    protocols::Question question_;
    protocols::SessionProgress progress_;  ///< before the trial that is looked at
    std::vector<StoredEvent> events_;
    DeviceProgress device_;     ///< of the trial that is looked at
    std::size_t taken_ = 0;     ///< of these
    std::int64_t checked_ = 0;  ///< trials
    std::int64_t period_ns_;
    std::deque<TrialRows> pending_;
    SideBySide work_;  ///< the last one: it ends first
};

/// Checks one session and its trials. @param session the row of the session with those of its study
/// and its participant: name, title, code, protocol_sha256, protocol_toml
/// @param rooms  for ticks, of sessions before: for those to come
[[nodiscard]] SessionReport check_session(Database& database,
                                          const StoredRow& session,
                                          TickRooms& rooms);

}  // namespace palpate::data
