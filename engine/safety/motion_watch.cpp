#include "engine/safety/motion_watch.hpp"

#include <cmath>

namespace palpate::engine {

std::size_t window_ticks(double period) noexcept {
    const double ticks = std::floor(kSpeedWindow / period + 0.5);
    return static_cast<std::size_t>(
        std::clamp(ticks, 1.0, static_cast<double>(MotionWatch::kSlots - 1)));
}

Trip watch_motion(MotionWatch& watch,
                  const SafetyLimits& limits,
                  const Vec3& hip,
                  bool fresh,
                  const ReadingClock& clock) noexcept {
    if (watch.seen == 0 && !fresh) {
        return Trip::
            none;  // an old HIP is no start of a way: the hand may have gone anywhere since
    }
    const MotionWatch::TimedPlace last = watch.ring[(watch.seen - 1) % MotionWatch::kSlots];
    const bool first = watch.seen == 0;
    const std::size_t slot = watch.seen++ % MotionWatch::kSlots;
    if (!fresh) {
        watch.ring[slot] = last;
        return Trip::none;
    }
    watch.ring[slot] = {.hip = hip, .time = clock.now};
    if (first) {
        return Trip::none;
    }
    // Written so that a way that is not a number trips.
    if (!(glm::length(hip - last.hip) <= limits.jump * (clock.since / limits.period))) {
        return Trip::jump;
    }
    const std::size_t window = window_ticks(limits.period);
    const std::size_t back = std::min(window, watch.seen - 1);
    const MotionWatch::TimedPlace& old = watch.ring[(watch.seen - 1 - back) % MotionWatch::kSlots];
    const double span = std::max(static_cast<double>(window) * limits.period, clock.now - old.time);
    return glm::length(hip - old.hip) <= limits.speed * span ? Trip::none : Trip::over_speed;
}

Trip watch_rest(RestWatch& watch,
                const SafetyLimits& limits,
                const Reading& reading,
                std::int64_t from_ns,
                std::int64_t to_ns) noexcept {
    const bool fresh = reading.ok() && reading.fresh;
    advance(watch.clock, from_ns, limits.period, fresh);
    Trip trip = watch_motion(watch.motion, limits, reading.hip, fresh, watch.clock);
    const bool uncertain = static_cast<double>(to_ns - from_ns) > 2e9 * limits.period;
    trip = uncertain ? Trip::none : trip;
    if (uncertain || trip != Trip::none) {  // what follows is judged by itself
        watch = RestWatch{};
    }
    return trip;
}

}  // namespace palpate::engine
