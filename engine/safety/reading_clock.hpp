#pragma once

#include <algorithm>
#include <cstdint>

namespace palpate::engine {

/// How long the hand had to move between two readings. A plain value.
struct ReadingClock {
    bool started = false;
    std::int64_t last_ns = 0;
    double now = 0.0;    ///< of this tick, s
    double since = 0.0;  ///< from the last fresh reading to this tick, s, >= one period
    double read = 0.0;   ///< when the last fresh reading was taken, s
};

/// One tick on. A tick takes at least a period: one that catches up after a late one counts as
/// whole, so that nothing is taken for faster than it was.
/// @param time_ns  when the tick woke up, since any moment   @param period  T, s
inline void advance(ReadingClock& clock, std::int64_t time_ns, double period, bool fresh) noexcept {
    const double passed = static_cast<double>(time_ns - clock.last_ns) * 1e-9;
    clock.now += clock.started ? std::max(period, passed) : 0.0;
    clock.since = std::max(period, clock.now - clock.read);
    clock.last_ns = time_ns;
    clock.started = true;
    if (fresh) {
        clock.read = clock.now;
    }
}

}  // namespace palpate::engine
