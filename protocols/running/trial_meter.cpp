#include "protocols/running/trial_meter.hpp"

#include <algorithm>

namespace palpate::protocols {

void TrialMeter::add(std::span<const engine::TickRecord> ticks) {
    for (const engine::TickRecord& tick : ticks) {
        if (started_) {
            const engine::Vec2 step = tick.hip - last_hip_;
            sum_.path_length_m += glm::length(step);
            sum_.energy_j += glm::dot(last_force_, step);
        }
        started_ = true;
        ledger_.add(tick.hip, tick.force, tick.mode != engine::Mode::free);
        last_hip_ = tick.hip;
        last_force_ = tick.force;
        ++sum_.ticks;
        sum_.late_ticks += (tick.flags & engine::tick_late) != 0 ? 1 : 0;
        sum_.saturated_ticks += (tick.flags & engine::tick_saturated) != 0 ? 1 : 0;
        sum_.skipped_ticks += (tick.flags & engine::tick_skipped) != 0 ? 1 : 0;
        sum_.slewed_ticks += (tick.flags & engine::tick_slewed) != 0 ? 1 : 0;
        sum_.stale_ticks += (tick.flags & engine::tick_stale) != 0 ? 1 : 0;
        if (tick.mode == engine::Mode::free) {
            continue;
        }
        if (sum_.contact_ticks++ == 0) {
            sum_.first_contact_s = static_cast<double>(tick.time_ns) * 1e-9;
        }
        sum_.slip_ticks += tick.mode != engine::Mode::stuck ? 1 : 0;
        force_sum_ += tick.normal_force;
        sum_.max_normal_force_n = std::max(sum_.max_normal_force_n, tick.normal_force);
    }
}

TrialSummary TrialMeter::summary() const {
    TrialSummary summary = sum_;
    summary.contact_episodes = ledger_.episodes();
    summary.worst_episode_j = ledger_.worst();
    if (sum_.contact_ticks > 0) {
        summary.mean_normal_force_n = force_sum_ / static_cast<double>(sum_.contact_ticks);
    }
    return summary;
}

}  // namespace palpate::protocols
