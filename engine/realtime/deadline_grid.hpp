#pragma once

#include <cstdint>

namespace palpate::engine {

/// Deadlines at first + k * period, k = 0, 1, ... Arithmetic alone: it reads no clock.
///
/// A deadline that was slept through is not made up for: two ticks in a row without a rest between
/// them would give the force of an old HIP and then the next one at once. The tick that woke late
/// runs once, its lateness tells the gap, and the next one comes at the first deadline still ahead.
class DeadlineGrid {
public:
    /// @param first_ns   the first deadline
    /// @param period_ns  > 0
    constexpr DeadlineGrid(std::int64_t first_ns, std::int64_t period_ns) noexcept
        : deadline_(first_ns), period_(period_ns) {}

    /// The one to wait for.
    [[nodiscard]] constexpr std::int64_t deadline() const noexcept { return deadline_; }

    /// The loop woke at `now_ns` for deadline(): goes on to the first deadline after both.
    /// @return deadlines passed over: 0 when the loop woke less than a period late
    constexpr std::int64_t pass(std::int64_t now_ns) noexcept {
        const std::int64_t late = now_ns - deadline_;
        const std::int64_t missed = late > 0 ? late / period_ : 0;
        deadline_ += (missed + 1) * period_;
        return missed;
    }

private:
    std::int64_t deadline_;
    std::int64_t period_;
};

}  // namespace palpate::engine
