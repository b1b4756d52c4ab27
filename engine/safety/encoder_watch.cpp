#include "engine/safety/encoder_watch.hpp"

#include <cmath>

namespace palpate::engine {
namespace {

/// As ==, which calls memcmp for them.
bool same(const EncoderWatch::Counts& a, const EncoderWatch::Counts& b) noexcept {
    return ((a[0] ^ b[0]) | (a[1] ^ b[1]) | (a[2] ^ b[2])) == 0;
}

}  // namespace

bool encoder_stuck(EncoderWatch& watch,
                   const EncoderWatch::Counts& counts,
                   const Vec3& hip,
                   int axes,
                   const Vec3& push,
                   double travel) noexcept {
    bool stuck = false;
    for (int i = 0; i < axes; ++i) {
        const auto axis = static_cast<std::size_t>(i);
        EncoderWatch::Still& still = watch.still[axis];
        if (!watch.started || counts[axis] != watch.counts[axis]) {
            still = {.from = hip, .counts = counts};
        } else if (axes > 2 && !(std::fabs(push[i]) > kPush)) {
            still = {.from = hip, .counts = counts, .travel = still.travel};
        }
        const double stroke = !same(counts, still.counts) ? glm::length(hip - still.from) : 0.0;
        if (stroke >= kStroke) {
            still = {.from = hip, .counts = counts, .travel = still.travel + stroke};
        }
        stuck = stuck || still.travel > travel;
    }
    watch.counts = counts;
    watch.started = true;
    return stuck;
}

StillWatch::State stillness(StillWatch& watch,
                            const EncoderWatch::Counts& counts,
                            double force,
                            double now) noexcept {
    const bool counted = !watch.started || !same(counts, watch.counts);
    if (counted || !(force > kStillForce || watch.eases)) {
        watch = {.started = true, .counts = counts, .since = now};
        return StillWatch::State::moves;
    }
    watch.eases = now - watch.since > kStillEase;
    if (now - watch.since > kStillTrip) {
        return StillWatch::State::dead;
    }
    return watch.eases ? StillWatch::State::eases : StillWatch::State::moves;
}

}  // namespace palpate::engine
