#pragma once

#include <cstddef>
#include <vector>

#include "protocols/design/plan.hpp"
#include "protocols/running/recorder.hpp"

namespace palpate::protocols {

/// What a session still has to run, in its order: a plan and all that became of it so far. The one rule
/// for the running session and for its resumption from a database, so that both run the same.
///
/// An answered position is done. A faulted one goes to the end of its part of the session, practice or
/// main with catch trials, behind those that faulted before it: at once again, it would be felt twice
/// in a row, and the second time with a hint. What was aborted or cut off stays where it is: whoever
/// comes back meets it first.
///
/// A position set back may break the run limits of the plan (the same object three times in a row), and
/// the last one of its part is followed by itself: there is nothing else left to put between.
class PendingTrials {
public:
    PendingTrials() = default;
    explicit PendingTrials(const Plan& plan);

    /// The next thing that became of an attempt. Positions that are not pending are ignored.
    void note(std::size_t position, Outcome outcome);

    [[nodiscard]] bool empty() const noexcept { return order_.empty(); }
    /// The position to run now; the number of trials when nothing is left.
    [[nodiscard]] std::size_t next() const noexcept {
        return order_.empty() ? practice_.size() : order_.front();
    }
    /// How many have been answered: the place in the session, whatever was set back.
    [[nodiscard]] std::size_t answered() const noexcept { return practice_.size() - order_.size(); }
    /// Positions, the next one first.
    [[nodiscard]] const std::vector<std::size_t>& order() const noexcept { return order_; }

    friend bool operator==(const PendingTrials&, const PendingTrials&) = default;

private:
    std::vector<std::size_t> order_;
    std::vector<bool> practice_;  ///< by position
};

/// The participant has chosen a picture: the position is done.
[[nodiscard]] constexpr bool is_answered(Outcome outcome) noexcept {
    return outcome == Outcome::complete || outcome == Outcome::timed_out;
}

}  // namespace palpate::protocols
