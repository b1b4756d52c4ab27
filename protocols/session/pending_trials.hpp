#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include "protocols/design/plan.hpp"
#include "protocols/design/streams.hpp"
#include "protocols/session/recorder.hpp"

namespace palpate::protocols {

/// How positions are run again.
struct RequeueRule {
    StreamKey key{};       ///< of the session; purpose and block are the rule's own
    std::size_t max = 10;  ///< times a position, InvalidSpec::max_requeues
};

/// Where a trial stands, as people read it: practice is counted by itself, main and catch trials
/// together.
struct TrialNumber {
    bool practice = false;
    std::size_t number =
        0;  ///< one more than are done: what is run again makes it stand, never jump
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

}  // namespace palpate::protocols
