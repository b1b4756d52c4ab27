#include "protocols/session/trial_meter.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "engine/realtime/felt_scene.hpp"

namespace palpate::protocols {

TrialMeter::TrialMeter(double stiffness, const engine::SceneView& scene)
    : ledger_(stiffness), exploration_(scene), in_space_(scene.space != nullptr) {
    const engine::SceneSpec* spec = scene.plane != nullptr ? &scene.plane->spec()
                                  : scene.space != nullptr ? &scene.space->spec().contact
                                                           : nullptr;
    sum_.sticks = spec == nullptr || spec->friction.mu_s > 0.0;
}

namespace {

void add_flags(unsigned flags, TrialSummary& sum) {
    sum.late_ticks += (flags & engine::tick_late) != 0 ? 1 : 0;
    sum.saturated_ticks += (flags & engine::tick_saturated) != 0 ? 1 : 0;
    sum.skipped_ticks += (flags & engine::tick_skipped) != 0 ? 1 : 0;
    sum.slewed_ticks += (flags & engine::tick_force_slew) != 0 ? 1 : 0;
    sum.stale_ticks += (flags & engine::tick_stale) != 0 ? 1 : 0;
}

}  // namespace

void TrialMeter::add_stroke(const engine::TickRecord& tick) {
    if (in_space_) {
        strokes_.add_along(tick, {1.0, 0.0});
        across_.add_along(tick, {0.0, 1.0});
    } else {
        strokes_.add(tick);
    }
}

void TrialMeter::add_contact(const engine::TickRecord& tick) {
    if (sum_.contact_ticks++ == 0) {
        sum_.first_contact_s = static_cast<double>(tick.time_ns) * 1e-9;
    }
    sum_.before_vertex_ticks += !in_space_ && tick.segment == 0 ? 1 : 0;
    sum_.after_vertex_ticks += !in_space_ && tick.segment == 1 ? 1 : 0;
    sum_.slip_ticks += tick.mode != engine::Mode::stuck ? 1 : 0;
    force_sum_ += tick.normal_force;
    sum_.max_normal_force_n = std::max(sum_.max_normal_force_n, tick.normal_force);
}

void TrialMeter::add(std::span<const engine::TickRecord> ticks) {
    for (const engine::TickRecord& tick : ticks) {
        if (started_) {
            const engine::Vec3 step = tick.hip - last_hip_;
            sum_.path_length_m += glm::length(step);
            sum_.energy_j += glm::dot(last_force_, step);
            if (tick.mode != engine::Mode::free) {
                contact_path_ += glm::length(step);
                contact_time_ += static_cast<double>(tick.time_ns - last_time_) * 1e-9;
            }
        }
        sum_.start = started_ ? sum_.start : engine::Vec2(tick.hip);
        started_ = true;
        ledger_.add(tick.hip, tick.force, engine::in_episode(tick));
        last_hip_ = tick.hip;
        last_force_ = tick.force;
        last_time_ = tick.time_ns;
        add_stroke(tick);
        exploration_.add(tick);
        ++sum_.ticks;
        add_flags(tick.flags, sum_);
        if (tick.mode != engine::Mode::free) {
            add_contact(tick);
        }
    }
}

TrialSummary TrialMeter::summary() const {
    TrialSummary summary = sum_;
    summary.contact_episodes = ledger_.episodes();
    summary.worst_episode_j = ledger_.worst();
    summary.strokes = strokes_.strokes() + across_.strokes();
    summary.strokes_before_vertex = strokes_.before_vertex();
    summary.strokes_after_vertex = strokes_.after_vertex();
    summary.reversals = strokes_.reversals() + across_.reversals();
    summary.vertex_ticks = exploration_.vertex_ticks();
    summary.stick_events = exploration_.stick_events();
    summary.speed = exploration_.speed();
    summary.normal_force = exploration_.normal_force();
    summary.covered_share = exploration_.covered_share();
    if (contact_time_ > 0.0) {
        summary.mean_speed_m_per_s = contact_path_ / contact_time_;
    }
    if (sum_.contact_ticks > 0) {
        summary.mean_normal_force_n = force_sum_ / static_cast<double>(sum_.contact_ticks);
    }
    return summary;
}

TrialSummary together(const TrialSummary& a, const TrialSummary& b) {
    TrialSummary all = a;
    for (const auto member :
         {&TrialSummary::ticks, &TrialSummary::contact_ticks, &TrialSummary::slip_ticks,
          &TrialSummary::late_ticks, &TrialSummary::saturated_ticks, &TrialSummary::skipped_ticks,
          &TrialSummary::slewed_ticks, &TrialSummary::stale_ticks, &TrialSummary::strokes,
          &TrialSummary::strokes_before_vertex, &TrialSummary::strokes_after_vertex,
          &TrialSummary::reversals, &TrialSummary::vertex_ticks, &TrialSummary::stick_events,
          &TrialSummary::before_vertex_ticks, &TrialSummary::after_vertex_ticks,
          &TrialSummary::contact_episodes}) {
        all.*member += b.*member;
    }
    all.sticks = a.sticks || b.sticks;
    all.path_length_m += b.path_length_m;
    all.energy_j += b.energy_j;
    all.max_normal_force_n = std::max(a.max_normal_force_n, b.max_normal_force_n);
    all.worst_episode_j = a.contact_episodes == 0 ? b.worst_episode_j
                        : b.contact_episodes == 0 ? a.worst_episode_j
                                                  : std::max(a.worst_episode_j, b.worst_episode_j);
    if (all.contact_ticks > 0) {
        all.mean_normal_force_n = (a.mean_normal_force_n * static_cast<double>(a.contact_ticks) +
                                   b.mean_normal_force_n * static_cast<double>(b.contact_ticks)) /
                                  static_cast<double>(all.contact_ticks);
        all.mean_speed_m_per_s = (a.mean_speed_m_per_s * static_cast<double>(a.contact_ticks) +
                                  b.mean_speed_m_per_s * static_cast<double>(b.contact_ticks)) /
                                 static_cast<double>(all.contact_ticks);
    }
    all.first_contact_s = a.first_contact_s ? a.first_contact_s : b.first_contact_s;
    return all;
}

std::string why_invalid(const Protocol& protocol, const TrialSummary& summary, bool late_counts) {
    const InvalidSpec& rules = protocol.invalid;
    std::string why;
    const auto add = [&why](const std::string& reason) {
        why += (why.empty() ? "" : "; ") + reason;
    };
    const auto ticks = static_cast<double>(summary.ticks);
    const auto late = static_cast<double>(summary.late_ticks);
    const auto stale = static_cast<double>(summary.stale_ticks);
    if (late_counts && late > rules.late_share * ticks) {
        add(fmt::format("late {:.2f} % of its ticks, above {:g} %", 100.0 * late / ticks,
                        100.0 * rules.late_share));
    }
    if (late_counts && stale > rules.stale_share * ticks) {
        add(fmt::format("stale {:.2f} % of its readings, above {:g} %", 100.0 * stale / ticks,
                        100.0 * rules.stale_share));
    }
    const double contact = static_cast<double>(summary.contact_ticks) / protocol.apparatus.rate_hz;
    if (contact < rules.contact_min) {
        add(fmt::format("contact {:.3f} s, below {:g} s", contact, rules.contact_min));
    }
    if (summary.path_length_m < rules.path_min) {
        add(fmt::format("path {:.1f} mm, below {:g} mm", 1e3 * summary.path_length_m,
                        1e3 * rules.path_min));
    }
    return why;
}

std::string why_invalid(const Protocol& protocol,
                        std::span<const TrialSummary> intervals,
                        bool late_counts) {
    std::string why;
    for (std::size_t i = 0; i < intervals.size(); ++i) {
        const std::string one = why_invalid(protocol, intervals[i], late_counts);
        if (!one.empty()) {
            why +=
                fmt::format("{}{}{}", why.empty() ? "" : "; ",
                            intervals.size() == 1 ? "" : fmt::format("interval {}: ", i + 1), one);
        }
    }
    return why;
}

}  // namespace palpate::protocols
