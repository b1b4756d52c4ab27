#pragma once

#include "engine/realtime/lateness_histogram.hpp"
#include "engine/realtime/realtime_rights.hpp"

namespace palpate::ui {

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
