#pragma once

#include <array>
#include <functional>
#include <vector>

#include "protocols/protocol/protocol.hpp"
#include "protocols/session/ports.hpp"
#include "protocols/session/progress.hpp"
#include "protocols/session/trial_meter.hpp"

namespace palpate::protocols {

/// Runs one trial after another on the ports of a session. Private to protocols/session.
class TrialRunner {
public:
    /// All arguments outlive the runner.
    /// @param simulated  the hand: its late ticks make no trial invalid
    /// @param progress   of the session: every attempt goes there when it is over
    /// @param happened   takes what happens beside
    TrialRunner(const Protocol& protocol,
                const Plan& plan,
                Ports& ports,
                bool simulated,
                SessionProgress& progress,
                std::function<void(const Event&)> happened);

    /// One attempt, recorded unless it was aborted before it began. The force is off when it
    /// returns, and when anything is thrown.
    /// @param view  of its first interval
    TrialResult run(const PlannedTrial& planned, TrialView view);

    /// The attempt that was recorded last; 0: none yet.
    [[nodiscard]] TrialId last() const noexcept { return last_; }

    /// Of the trial to run now.
    [[nodiscard]] TrialView view_of(const PendingTrials& pending) const;

private:
    /// A trial that was begun.
    struct Running {
        TrialId id;
        const PlannedTrial& planned;
        TrialView view;  ///< of the interval that runs
        TrialResult result{};
    };
    [[nodiscard]] Signal begin(const TrialView& view);
    void feel(Running& trial, const Presentation& felt, const engine::SceneView& scene);
    void explore(Running& trial);
    void note_fault(Running& trial);
    void note_lost_ticks(const Running& trial);
    void note_away(const PlannedTrial& planned, double away_s);
    /// @return what the protocol's rule takes in, if it does
    std::optional<RuleAnswer> answer(Running& trial, std::span<const Presentation> felt);
    /// @param answer  what the protocol's rule takes in
    void end(Running& trial, const std::optional<RuleAnswer>& answer);
    void drain(TrialId id, bool exploring);
    [[nodiscard]] Fault fault_of(engine::Trip cause) const;

    const Protocol& protocol_;
    const Plan& plan_;
    Ports& ports_;
    bool simulated_;
    SessionProgress& progress_;
    std::function<void(const Event&)> happened_;
    std::vector<Picture> pictures_;
    TrialId last_ = 0;
    Question question_;
    std::optional<TrialMeter> meter_;  ///< of the running interval
    std::optional<double> tripped_s_;  ///< when the running trial's force went off by itself
    std::int64_t dropped_ = 0;         ///< ticks lost so far in this run
    std::array<engine::TickRecord, 256> buffer_{};
};

}  // namespace palpate::protocols
