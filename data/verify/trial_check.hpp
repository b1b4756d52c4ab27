#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/side_by_side.hpp"
#include "protocols/design/plan.hpp"
#include "protocols/protocol/protocol.hpp"
#include "data/store/stored_progress.hpp"
#include "data/verify/interval_check.hpp"

namespace palpate::data {

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
