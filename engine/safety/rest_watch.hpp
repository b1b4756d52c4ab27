#pragma once

#include "engine/device/device.hpp"
#include "engine/safety/motion_watch.hpp"

namespace palpate::engine {

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
