#pragma once

#include <array>
#include <vector>

#include "protocols/design/protocol.hpp"
#include "protocols/running/ports.hpp"
#include "protocols/running/trial_meter.hpp"

namespace palpate::protocols {

/// Runs one trial after another on the ports of a session. Private to protocols/running.
class TrialRunner {
public:
    /// All arguments outlive the runner.
    /// @param simulated  the hand: its late ticks make no trial invalid
    TrialRunner(const Protocol& protocol, const Plan& plan, Ports& ports, bool simulated);

    /// One attempt, recorded unless it was aborted before it began. The force is off when it returns,
    /// and when anything is thrown.
    TrialResult run(const PlannedTrial& planned, const TrialView& view);

    /// The attempt that was recorded last; 0: none yet.
    [[nodiscard]] TrialId last() const noexcept { return last_; }

    /// @param number  of the trial as shown, 1, 2, ...
    [[nodiscard]] TrialView view_of(const PlannedTrial& planned, std::size_t number) const;

private:
    void explore(TrialId id, const TrialView& view, TrialResult& result);
    void note_fault(const PlannedTrial& planned, TrialResult& result);
    void note_lost_ticks(const PlannedTrial& planned);
    void answer(const PlannedTrial& planned, const TrialView& view, TrialResult& result);
    void drain(TrialId id, bool exploring);

    const Protocol& protocol_;
    const Plan& plan_;
    Ports& ports_;
    bool simulated_;
    std::vector<Picture> pictures_;
    TrialId last_ = 0;
    TrialMeter meter_{1.0};
    std::optional<double> tripped_s_;  ///< when the running trial's force went off by itself
    std::int64_t dropped_ = 0;         ///< ticks lost so far in this run
    std::array<engine::TickRecord, 256> buffer_{};
};

}  // namespace palpate::protocols
