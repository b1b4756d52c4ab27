#include "engine/safety/contact_watch.hpp"

#include <algorithm>

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

constexpr std::size_t kNewest = 5;

/// How fast HIP was before a contact that may be a runaway.
double pace_before(const RunawayWatch& watch) noexcept {
    double pace = watch.came;
    for (std::size_t i = 0; i + kNewest < watch.paces.size(); ++i) {
        pace = std::max(pace, watch.paces[(watch.next + i) % watch.paces.size()]);
    }
    return pace;
}

void close_stretch(RunawayWatch& watch, double depth, const Vec3& hip, double time) noexcept {
    const double pace = glm::length(hip - watch.from) / time;
    // A god-object that turns to another side adds no more than HIP went.
    const double deeper = std::min((depth - watch.depth) / time, pace);
    watch.came = watch.free ? pace : watch.came;
    const bool fast =
        watch.full && deeper >= kRunawaySpeed && deeper >= kRunawayShare * pace_before(watch);
    watch.fast = fast ? watch.fast + 1 : 0;
    watch.paces[watch.next] = pace;
    watch.next = (watch.next + 1) % watch.paces.size();
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

bool runs_away(RunawayWatch& watch, bool full, double depth, const Vec3& hip, double now) noexcept {
    watch.free = watch.free && depth == 0.0;
    watch.full = watch.full && full;
    const double time = now - watch.since;
    const bool over = watch.started && time >= kRunawayStretch;
    if (over) {
        close_stretch(watch, depth, hip, time);
    }
    if (over || !watch.started || (full && !watch.full)) {
        watch = {.started = true,
                 .since = now,
                 .from = hip,
                 .depth = depth,
                 .free = depth == 0.0,
                 .came = watch.came,
                 .paces = watch.paces,
                 .next = watch.next,
                 .fast = watch.fast};
    }
    return watch.fast >= kRunawayStretches;
}

}  // namespace palpate::engine
