#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocols/design/plan.hpp"
#include "protocols/protocol/protocol.hpp"
#include "data/store/stored_progress.hpp"
#include "data/verify/interval_check.hpp"

namespace palpate::data {

/// Checks the attempts of one session in the order in which they were made.
class TrialCheck {
public:
    TrialCheck(Database& database,
               std::int64_t session,
               const SessionFrame& frame,
               Findings& findings);

    void check(const StoredRow& trial);
    [[nodiscard]] std::int64_t replayed() const noexcept { return replayed_; }
    [[nodiscard]] const protocols::SessionProgress& progress() const noexcept { return progress_; }

private:
    void take_events();
    void check_place(const StoredRow& trial);
    void check_planned(const StoredRow& trial,
                       const protocols::PlannedTrial& planned,
                       const StoredRow* response);
    [[nodiscard]] bool counted(const StoredRow& trial) const;
    void take(const StoredRow& trial,
              const StoredRow* response,
              const std::optional<protocols::RuleAnswer>& answer);
    void check_outcome(const StoredRow& trial,
                       std::span<const CheckedInterval> intervals,
                       bool answered);
    [[nodiscard]] std::optional<double> stimulus_of(const protocols::PlannedTrial& planned);

    Database& database_;
    const SessionFrame& frame_;
    Findings& findings_;
    protocols::SessionProgress progress_;  ///< before the trial that is looked at
    std::vector<StoredEvent> events_;
    std::size_t taken_ = 0;     ///< of these
    std::int64_t checked_ = 0;  ///< trials
    std::int64_t period_ns_;
    std::int64_t replayed_ = 0;
};

}  // namespace palpate::data
