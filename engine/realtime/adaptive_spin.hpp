#pragma once

#include <algorithm>
#include <cstdint>

namespace palpate::engine {

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
