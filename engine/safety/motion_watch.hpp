#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "engine/device/device.hpp"
#include "engine/geometry/vec.hpp"
#include "engine/safety/safety_limits.hpp"
#include "engine/safety/trip.hpp"

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

/// Speed is the way over this time: one count of 0.1 mm is 0.1 m/s over a tick of 1 ms, and 5 mm/s
/// over this window (which is also what the field's drivers take).
inline constexpr double kSpeedWindow = 0.020;  ///< s

/// Ticks that the window has, 1 to kWindowSlots - 1.
[[nodiscard]] std::size_t window_ticks(double period) noexcept;

/// The way of HIP over the last 20 ms. A plain value.
struct MotionWatch {
    static constexpr std::size_t kSlots = 256;  ///< 20 ms at 10 kHz and a little more

    struct TimedPlace {
        Vec3 hip{};         ///< m
        double time = 0.0;  ///< when it was read, s
    };
    std::array<TimedPlace, kSlots> ring{};
    std::size_t seen = 0;  ///< ticks so far
};

/// Jump: HIP moved further between two fresh readings than `limits.jump` for each period between
/// them. Speed: its ends 20 ms apart are further from each other than `limits.speed` allows; before
/// 20 ms have passed the same distance holds, so that a start cannot trip on a count.
/// A reading that is not fresh says nothing new and trips nothing; the way starts at the first
/// fresh one.
[[nodiscard]] Trip watch_motion(MotionWatch& watch,
                                const SafetyLimits& limits,
                                const Vec3& hip,
                                bool fresh,
                                const ReadingClock& clock) noexcept;

/// The motion of a handle while nothing is felt, from one trial or parking to the next. A plain
/// value.
struct RestWatch {
    MotionWatch motion{};
    ReadingClock clock{};
};

/// What a trial would trip on: between trials, too, an encoder that skips leaves every later place
/// shifted. The way begins at the first fresh reading, wherever the hand is by then.
/// @param from_ns, to_ns  before and after it was read; more than two periods apart nobody knows
///                        when it was read: the way begins anew
/// @return Trip::jump, Trip::over_speed or none
[[nodiscard]] Trip watch_rest(RestWatch& watch,
                              const SafetyLimits& limits,
                              const Reading& reading,
                              std::int64_t from_ns,
                              std::int64_t to_ns) noexcept;

}  // namespace palpate::engine
