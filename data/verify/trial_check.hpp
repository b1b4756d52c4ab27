#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocols/design/plan.hpp"
#include "protocols/protocol/protocol.hpp"
#include "protocols/session/adaptive_runs.hpp"
#include "protocols/session/pending_trials.hpp"
#include "data/store/resume_policy.hpp"
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
    [[nodiscard]] const protocols::PendingTrials& pending() const noexcept { return pending_; }

private:
    void heed_marks(const StoredRow& trial);
    void check_attempt(const StoredRow& trial, bool answered);
    void check_outcome(const StoredRow& trial,
                       std::span<const CheckedInterval> intervals,
                       bool answered);
    [[nodiscard]] std::optional<double> stimulus_of(const protocols::PlannedTrial& planned);

    Database& database_;
    const SessionFrame& frame_;
    Findings& findings_;
    /// An attempt that was answered or faulted.
    struct Attempt {
        std::int64_t trial = 0;
        std::size_t position = 0;
        protocols::Outcome outcome{};
        bool counted = false;  ///< when it ended
        std::int64_t marked_after =
            0;  ///< last trial when somebody said it does not count; 0: nobody
    };
    protocols::PendingTrials pending_;
    protocols::AdaptiveRuns runs_;
    std::vector<Redo> redos_;
    std::int64_t last_ = 0;  ///< trial that was looked at
    std::vector<Attempt> made_;
    std::map<std::size_t, std::int64_t> attempts_;  ///< so far, by position
    std::int64_t period_ns_;
    std::int64_t replayed_ = 0;
};

}  // namespace palpate::data
