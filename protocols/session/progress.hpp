#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "protocols/design/plan.hpp"
#include "protocols/design/streams.hpp"
#include "protocols/procedure/procedure.hpp"
#include "protocols/protocol/protocol.hpp"
#include "protocols/session/recorder.hpp"
#include "protocols/trial/presentation.hpp"

/// The rules of a session on their way.
namespace palpate::protocols {

/// One procedure for every [[run]] of a protocol, each with a stream of its own (run_key). A value.
class AdaptiveRuns {
public:
    AdaptiveRuns() = default;  ///< of a protocol without a rule
    /// @param session  the session's key; purpose and block are set here
    AdaptiveRuns(const Protocol& protocol, const StreamKey& session);

    /// What the rule shows next. @throws std::logic_error if the run has ended
    [[nodiscard]] double next(std::size_t run) const;
    /// @throws std::invalid_argument as Procedure::update
    void update(const RuleAnswer& answer);
    /// The run as it was before its first answer.
    void restart(std::size_t run) { procedures_.at(run) = begun_.at(run); }
    /// What the rule says with `answer`, its last one.
    [[nodiscard]] AdaptiveStep step_after(const RuleAnswer& answer) const;
    [[nodiscard]] const Procedure& of(std::size_t run) const { return procedures_.at(run); }
    [[nodiscard]] std::size_t size() const noexcept { return procedures_.size(); }

private:
    std::vector<Procedure> begun_;  ///< before the first answer
    std::vector<Procedure> procedures_;
};

/// The stimulus of a planned trial: the rule's next one, in practice that of the protocol; none
/// without a rule.
[[nodiscard]] std::optional<double> stimulus_for(const Protocol& protocol,
                                                 const PlannedTrial& planned,
                                                 const AdaptiveRuns& runs);

/// An answer as the rule counts: two intervals: 1 if the comparison was named; yes or no: 1 for
/// yes; pictures: the place of the named object among the pictured ones in the protocol; a rating:
/// its level.
[[nodiscard]] std::size_t outcome_of(const Protocol& protocol,
                                     const PlannedTrial& planned,
                                     const Response& response);

/// Whether answer `place` is right, where that can be said. Two intervals: the one with the larger
/// value of what varies; none if both have the same. Pictures without a rule: the felt object's;
/// none if there is no such picture.
[[nodiscard]] std::optional<bool> is_right(const Protocol& protocol,
                                           const Plan& plan,
                                           const PlannedTrial& planned,
                                           std::span<const Presentation> felt,
                                           std::size_t place);

/// How positions are run again.
struct RequeueRule {
    StreamKey key{};       ///< of the session; purpose and block are the rule's own
    std::size_t max = 10;  ///< times a position, InvalidSpec::max_requeues
};

/// Where a trial stands, as people read it: practice is counted by itself, main and catch trials
/// together.
struct TrialNumber {
    bool practice = false;
    std::size_t number = 0;  ///< one more than are done: what is run again makes it stand
    std::size_t total = 0;

    friend bool operator==(const TrialNumber&, const TrialNumber&) = default;
};

/// What a session still has to run, in its order: a plan and all that became of it so far. The one
/// rule for the running session and for its resumption from a database, so that both run the same.
///
/// A position with an answer that counts is done. One that faulted, or whose answer does not count,
/// goes to a random later place of its part of the session: practice, or its block of main and
/// catch trials. At least one other trial comes before it, each place is equally likely, and the
/// place follows from the key, the position and how often it was set back: nobody can guess it,
/// every resumption finds it. Once a position has been set back `max` times it is done too, without
/// an answer that counts. What was aborted or cut off stays where it is: whoever comes back meets
/// it first.
///
/// A position set back may break the run limits of the plan (the same object three times in a row),
/// and the last one of its part is followed by itself: there is nothing else left to put between.
class PendingTrials {
public:
    PendingTrials() = default;
    /// Every trial of the plan, in its order, none tried yet.
    explicit PendingTrials(const Plan& plan, RequeueRule rule = {});

    /// The next thing that became of an attempt. Positions that are not pending are ignored.
    /// @param counts  an answer is valid; without meaning for other outcomes
    void note(std::size_t position, Outcome outcome, bool counts = true);

    /// All trials of a part are to be run again, in the order of the plan, as if none had been.
    void begin_again(std::size_t part);
    /// 0: practice; else 1 + block. @pre position < the number of trials
    [[nodiscard]] std::size_t part_of(std::size_t position) const noexcept {
        return part_[position];
    }

    /// Nothing is left to run.
    [[nodiscard]] bool empty() const noexcept { return order_.empty(); }
    /// The position to run now; the number of trials when nothing is left.
    [[nodiscard]] std::size_t next() const noexcept {
        return order_.empty() ? part_.size() : order_.front();
    }
    /// How many are done: the place in the session, whatever was set back.
    [[nodiscard]] std::size_t answered() const noexcept { return part_.size() - order_.size(); }
    /// How many attempts nobody answered.
    [[nodiscard]] std::size_t unanswered() const noexcept { return unanswered_; }
    /// How many practice trials, or other ones, are left.
    [[nodiscard]] std::size_t left(bool practice) const noexcept;
    /// Of the trial to run now; that of the last one when nothing is left.
    [[nodiscard]] TrialNumber number() const noexcept;
    /// The position is still to be run.
    [[nodiscard]] bool has(std::size_t position) const noexcept;
    /// Positions, the next one first.
    [[nodiscard]] const std::vector<std::size_t>& order() const noexcept { return order_; }

    /// The same is left, and the same will come of what happens to it.
    friend bool operator==(const PendingTrials& a, const PendingTrials& b) {
        return a.order_ == b.order_ && a.part_ == b.part_ && a.again_ == b.again_ &&
               a.rule_.max == b.rule_.max;
    }

private:
    struct Again {
        Pcg32 random;
        std::size_t times = 0;

        friend bool operator==(const Again&, const Again&) = default;
    };
    void set_back(std::size_t position);

    RequeueRule rule_{};
    std::vector<std::size_t> order_;
    std::vector<std::size_t> part_;       ///< by position: 0 practice, 1 + block otherwise
    std::map<std::size_t, Again> again_;  ///< by position
    std::size_t unanswered_ = 0;
};

/// The participant has chosen a picture.
[[nodiscard]] constexpr bool is_answered(Outcome outcome) noexcept {
    return outcome == Outcome::complete || outcome == Outcome::timed_out;
}

/// It was felt, or began to be, and ended by itself without an answer: it comes again later, not at
/// once.
[[nodiscard]] constexpr bool is_lost(Outcome outcome) noexcept {
    return outcome == Outcome::faulted || outcome == Outcome::unanswered;
}

/// An attempt at a planned trial that is over.
struct Attempt {
    TrialId trial = 0;
    std::size_t position = 0;
    Outcome outcome = Outcome::interrupted;
    bool counts = false;                 ///< it has an answer, and broke no rule of [invalid]
    std::optional<RuleAnswer> answer{};  ///< what the protocol's rule took in
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
