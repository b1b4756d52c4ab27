#include "engine/safety/rest_watch.hpp"

namespace palpate::engine {

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
