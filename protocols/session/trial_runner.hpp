#pragma once

#include <array>
#include <vector>

#include "protocols/protocol/protocol.hpp"
#include "protocols/session/adaptive_runs.hpp"
#include "protocols/session/pending_trials.hpp"
#include "protocols/session/ports.hpp"
#include "protocols/session/trial_meter.hpp"

namespace palpate::protocols {

/// Runs one trial after another on the ports of a session. Private to protocols/running.
class TrialRunner {
public:
    /// All arguments outlive the runner.
    /// @param simulated  the hand: its late ticks make no trial invalid
    /// @param runs       of the protocol's rule: a counting answer goes there
    TrialRunner(const Protocol& protocol,
                const Plan& plan,
                Ports& ports,
                bool simulated,
                AdaptiveRuns& runs);

    /// One attempt, recorded unless it was aborted before it began. The force is off when it returns,
    /// and when anything is thrown.
    /// @param view  of its first interval
    TrialResult run(const PlannedTrial& planned, TrialView view);

    /// The attempt that was recorded last; 0: none yet.
    [[nodiscard]] TrialId last() const noexcept { return last_; }

    /// @param done  trials of the whole session
    [[nodiscard]] TrialView view_of(const TrialNumber& number, std::size_t done) const;

private:
    [[nodiscard]] Signal begin(const TrialView& view);
    void feel(TrialId id,
              const PlannedTrial& planned,
              const Presentation& felt,
              const engine::Scene& scene,
              const TrialView& view,
              TrialResult& result);
    void explore(TrialId id, const TrialView& view, TrialResult& result);
    void note_fault(const PlannedTrial& planned, TrialResult& result);
    void note_lost_ticks(const PlannedTrial& planned);
    void answer(TrialId id,
                const PlannedTrial& planned,
                std::span<const Presentation> felt,
                const TrialView& view,
                TrialResult& result);
    void drain(TrialId id, bool exploring);

    const Protocol& protocol_;
    const Plan& plan_;
    Ports& ports_;
    bool simulated_;
    AdaptiveRuns& runs_;
    std::vector<Picture> pictures_;
    TrialId last_ = 0;
    Question question_;
    TrialMeter meter_{1.0};
    std::optional<double> tripped_s_;  ///< when the running trial's force went off by itself
    std::int64_t dropped_ = 0;         ///< ticks lost so far in this run
    std::array<engine::TickRecord, 256> buffer_{};
};

}  // namespace palpate::protocols
