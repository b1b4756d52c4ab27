#pragma once

#include <array>
#include <cstddef>

#include "engine/geometry/vec.hpp"
#include "engine/safety/reading_clock.hpp"
#include "engine/safety/safety_limits.hpp"
#include "engine/safety/trip.hpp"

namespace palpate::engine {

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

}  // namespace palpate::engine
