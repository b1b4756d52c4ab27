#include "engine/safety/late_ticks.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::engine {
namespace {

void add(LateTicks& late, bool is_late) noexcept {
    bool& slot = late.recent[late.next];
    late.share += static_cast<std::int32_t>(is_late) - static_cast<std::int32_t>(slot);
    slot = is_late;
    late.next = (late.next + 1) % late.recent.size();
    late.run = is_late ? late.run + 1 : 0;
}

}  // namespace

std::int32_t periods_late(std::int64_t lateness_ns, double period) noexcept {
    const double share = lateness_ns > 0 ? static_cast<double>(lateness_ns) / (period * 1e9) : 0.0;
    if (!(share > kLateShare)) {
        return 0;
    }
    const double window = LateTicks::kWindow;
    return static_cast<std::int32_t>(std::clamp(std::floor(share + 0.5), 1.0, window));
}

bool late_too_often(LateTicks& late,
                    const SafetyLimits& limits,
                    std::int64_t lateness_ns) noexcept {
    const std::int64_t tick = late.tick++;
    const std::int32_t missed = periods_late(lateness_ns, limits.period);
    if (missed == 0) {
        late.run = 0;
        if (tick >= late.counted) {
            add(late, false);
        }
    }
    for (std::int64_t i = std::max(tick, late.counted); i < tick + missed; ++i) {
        add(late, true);
    }
    late.counted = std::max(late.counted, tick + std::max(missed, 1));
    const bool in_a_row = limits.late_run > 0 && late.run >= limits.late_run;
    return in_a_row || (limits.late_share > 0 && late.share >= limits.late_share);
}

}  // namespace palpate::engine
