#pragma once

namespace palpate::engine {

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
