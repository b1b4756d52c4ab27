#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "engine/realtime/lateness_histogram.hpp"
#include "engine/realtime/realtime_rights.hpp"

/// cyclictest of rt-tests, the usual measure of wake-up latency on Linux. Never needed: where it is
/// not installed there is nothing to compare with.
namespace palpate::ui {

/// Its histogram of wake-up latencies.
struct Cyclictest {
    std::vector<std::int64_t> counts;  ///< counts[k]: latencies of k to k + 1 us
    std::int64_t overflows = 0;        ///< beyond the last bin
    double max_us = 0.0;

    /// Cycles, overflows counted.
    [[nodiscard]] std::int64_t total() const;
    /// Lateness that `share` of the cycles do not exceed, us; between the ends of a bin by
    /// proportion. max_us among the overflows, 0 without cycles.
    [[nodiscard]] double quantile_us(double share) const;
};

/// Reads what `cyclictest -q -h` prints, one thread. None if that is no such output, or without a
/// cycle.
[[nodiscard]] std::optional<Cyclictest> parse_cyclictest(std::string_view output);

/// It is on the PATH.
[[nodiscard]] bool cyclictest_installed();

/// Runs it: one thread, absolute sleeps on CLOCK_MONOTONIC.
/// @param rate_hz   100 to 100,000
/// @param realtime  with -m -p80, as a servo with all its rights; without: as an ordinary program
/// @return none if it is not installed or gave nothing (no right to real-time priority)
[[nodiscard]] std::optional<Cyclictest> run_cyclictest(double rate_hz,
                                                       double seconds,
                                                       bool realtime);

/// What a servo thread was like for a while.
struct WakeUps {
    engine::LatenessHistogram lateness{};
    engine::RealtimeRights rights{};
    double processor_share = 0.0;  ///< of one processor, the thread that waits for it included
};

/// Runs the servo's own thread, with a device that does nothing and a scene that is out of reach.
/// @param rate_hz     1000 to 10000
/// @param seconds     > 0
/// @param spin_share  see engine::ServoSpec
[[nodiscard]] WakeUps measure_wake_ups(double rate_hz,
                                       double seconds,
                                       const engine::RealtimeWish& wish,
                                       double spin_share = 0.0);

}  // namespace palpate::ui
