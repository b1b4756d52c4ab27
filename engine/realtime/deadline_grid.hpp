#pragma once

#include <algorithm>
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

/// How long before a deadline to stop sleeping and watch the clock instead. Arithmetic alone,
/// integers.
///
/// Follows the 511/512 quantile q of how late the sleep ends: q grows by 511 steps when a sleep
/// ended later than q, and shrinks by one step when not, so that it rests where one sleep in 512 is
/// later. A step is q / 4096 + 1 ns: quick at any size. A few odd wake-ups of milliseconds, as a
/// virtual machine has them, count as one exceedance each and do not blow it up.
///
/// What it costs: about q of every period on one processor (60 us on a common machine: 6 % at 1
/// kHz, and half of it at 10 kHz, where the bound holds).
class AdaptiveSpin {
public:
    /// @param max_ns  the longest watch, >= 0; 0: always sleeps to the end
    constexpr explicit AdaptiveSpin(std::int64_t max_ns) noexcept
        : max_(std::max<std::int64_t>(0, max_ns)), ahead_(std::min<std::int64_t>(max_, kFirst)) {}

    /// 0 to max_ns.
    [[nodiscard]] constexpr std::int64_t ahead_ns() const noexcept { return ahead_; }
    [[nodiscard]] constexpr bool on() const noexcept { return max_ > 0; }

    /// A sleep ended `late_ns` after the time that was asked for.
    constexpr void woke(std::int64_t late_ns) noexcept {
        const std::int64_t step = ahead_ / 4096 + 1;
        ahead_ += late_ns > ahead_ ? 511 * step : -step;
        ahead_ = std::clamp<std::int64_t>(ahead_, 0, max_);
    }

private:
    static constexpr std::int64_t kFirst = 100'000;  ///< 100 us, before anything is known

    std::int64_t max_;
    std::int64_t ahead_;
};

}  // namespace palpate::engine
