#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include "protocols/session/adaptive_runs.hpp"
#include "protocols/session/pending_trials.hpp"
#include "protocols/session/recorder.hpp"

namespace palpate::protocols {

/// An attempt at a planned trial that is over.
struct Attempt {
    TrialId trial = 0;
    std::size_t position = 0;
    Outcome outcome = Outcome::interrupted;
    bool counts = false;                 ///< it has an answer, and broke no rule of [invalid]
    std::optional<RuleAnswer> answer{};  ///< what the protocol's rule took in

    friend bool operator==(const Attempt&, const Attempt&) = default;
};

/// The key of a mark that takes back the one before of the same trial.
inline constexpr std::string_view kUndone = "undone";

/// What a session knows of itself: what is left to run, what its rules heard, which answers
/// count. It follows from attempts and events alone, in their order: the running session, its
/// resumption from a database and those who check one apply() the same.
///
/// A mark, and a part that begins again, make the session what it would be if these answers had
/// never counted; a mark taken back, what it would be without the mark. Other events change
/// nothing.
class SessionProgress {
public:
    SessionProgress() = default;  ///< of no trial
    /// Before the first trial. @param session  the session's key; purpose and block are set here
    SessionProgress(const Protocol& protocol, const Plan& plan, const StreamKey& session);

    /// What is left to run, and what the rules of adaptive runs know.
    [[nodiscard]] const PendingTrials& pending() const noexcept { return pending_; }
    [[nodiscard]] const AdaptiveRuns& runs() const noexcept { return runs_; }
    /// How many attempts there were at each position that had any.
    [[nodiscard]] const std::map<std::size_t, std::size_t>& attempts() const noexcept {
        return attempts_;
    }
    /// The attempt has an answer that counts still.
    [[nodiscard]] bool counts(TrialId trial) const noexcept;
    /// Attempts of a part (as PendingTrials counts them) whose answers count, in their order.
    [[nodiscard]] std::vector<TrialId> counting(std::size_t part) const;

    friend SessionProgress apply(SessionProgress progress, const Attempt& attempt);
    friend SessionProgress apply(SessionProgress progress, const Event& event);

private:
    /// An attempt that changed what is left; or a part began again.
    struct Step {
        std::optional<Attempt> attempt{};
        std::size_t part = 0;
        bool marked = false;  ///< it counted until somebody said that it does not
    };
    void take(const Step& step);
    void mark(TrialId trial, bool marked);
    void set_counts(const std::vector<TrialId>& trials, bool counts);

    PendingTrials begun_;  ///< before the first trial
    PendingTrials pending_;
    AdaptiveRuns runs_;
    std::vector<Step> steps_;
    std::map<std::size_t, std::size_t> attempts_;
};

/// What the session knows after `attempt` is over.
/// @throws std::exception if its rule does not take the answer
[[nodiscard]] SessionProgress apply(SessionProgress progress, const Attempt& attempt);
/// What the session knows after `event`.
[[nodiscard]] SessionProgress apply(SessionProgress progress, const Event& event);

}  // namespace palpate::protocols
