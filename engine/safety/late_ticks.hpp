#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "engine/safety/safety_limits.hpp"

namespace palpate::engine {

/// Periods in which the force was not renewed in time: a tick that is late by k periods leaves k of
/// them. A plain value.
struct LateTicks {
    static constexpr std::int32_t kWindow = 100;  ///< periods looked back on

    std::int64_t tick = 0;     ///< of the next call
    std::int64_t counted = 0;  ///< periods before this one are in the count
    std::int32_t run = 0;      ///< late ones in a row
    std::int32_t share = 0;    ///< late ones among the last 100
    std::array<bool, kWindow> recent{};
    std::size_t next = 0;  ///< slot of `recent`
};

/// How many periods a wake-up missed: 0 up to kLateShare of a period, else the nearest whole
/// number.
[[nodiscard]] std::int32_t periods_late(std::int64_t lateness_ns, double period) noexcept;

/// True when `limits.late_run` periods in a row or `limits.late_share` of the last 100 were late.
///
/// After a stall of k periods the servo catches up: the ticks that follow are late by k - 1, k - 2,
/// ... These belong to periods that are counted already, so a stall counts as k and not as k (k +
/// 1) / 2.
[[nodiscard]] bool late_too_often(LateTicks& late,
                                  const SafetyLimits& limits,
                                  std::int64_t lateness_ns) noexcept;

/// Readings are judged by their mean age over so long, s: what a busy machine keeps back for 10 ms
/// is no delay of the device.
inline constexpr double kDelayWindow = 0.25;

/// How much older than promised the readings were, ticks, in the mean of the last kDelayWindow. A
/// plain value.
struct DelayWatch {
    double mean = 0.0;
};

/// True while the mean is above `spare`. The mean follows each reading by period / kDelayWindow of
/// the way: readings that are late by c ticks from some tick on are noticed after n ticks,
///
///     c (1 - (1 - period / kDelayWindow)^n) > spare
///
/// @param behind  ticks by which this tick's reading is older than the device's delay, >= 0
/// @param spare   ticks; infinity: nothing is watched   @param period  s, < kDelayWindow
[[nodiscard]] inline bool delayed(DelayWatch& watch,
                                  double behind,
                                  double spare,
                                  double period) noexcept {
    watch.mean += (behind - watch.mean) * (period / kDelayWindow);
    return watch.mean > spare;
}

}  // namespace palpate::engine
