#include "engine/safety/buzz_watch.hpp"

namespace palpate::engine {
namespace {

/// The depth turned at its deepest: one more way from top to top.
void count_cycle(BuzzWatch& watch) noexcept {
    const double period = watch.at - watch.peak;
    const double way = (watch.top - watch.trough) + (watch.extreme - watch.trough);
    const bool quick = period * kBuzzFrequency <= 1.0 && way >= kBuzzSpeed * period;
    const bool lasts = watch.cycles == 0 || way >= kBuzzLasts * watch.way;
    watch.cycles = !quick ? 0 : lasts ? watch.cycles + 1 : 1;
    watch.way = way;
    watch.top = watch.extreme;
    watch.peak = watch.at;
}

}  // namespace

bool buzzes(BuzzWatch& watch, double depth, double now) noexcept {
    const double beyond = watch.rising ? depth - watch.extreme : watch.extreme - depth;
    if (beyond >= 0.0) {
        watch.extreme = depth;
        watch.at = now;
    } else if (beyond <= -kBuzzSwing) {
        if (watch.rising) {
            count_cycle(watch);
        } else {
            watch.trough = watch.extreme;
        }
        watch.rising = !watch.rising;
        watch.extreme = depth;
        watch.at = now;
    }
    return watch.cycles >= kBuzzCycles;
}

}  // namespace palpate::engine
