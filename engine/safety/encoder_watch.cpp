#include "engine/safety/encoder_watch.hpp"

namespace palpate::engine {

bool encoder_stuck(EncoderWatch& watch,
                   const std::array<std::int32_t, 2>& counts,
                   const Vec2& hip,
                   double travel) noexcept {
    bool stuck = false;
    for (std::size_t axis = 0; axis < 2; ++axis) {
        EncoderWatch::Still& still = watch.still[axis];
        const std::int32_t other = counts[1 - axis];
        if (!watch.started || counts[axis] != watch.counts[axis]) {
            still = {.from = hip, .other = other};
        }
        const double stroke = glm::length(hip - still.from);
        if (stroke >= kStroke && other != still.other) {
            still = {.from = hip, .other = other, .travel = still.travel + stroke};
        }
        stuck = stuck || still.travel > travel;
    }
    watch.counts = counts;
    watch.started = true;
    return stuck;
}

}  // namespace palpate::engine
