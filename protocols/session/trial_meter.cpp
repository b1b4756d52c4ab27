#include "protocols/session/trial_meter.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "engine/realtime/felt_scene.hpp"

namespace palpate::protocols {

TrialMeter::TrialMeter(double stiffness, const engine::SceneView& scene)
    : ledger_(stiffness, scene.plane != nullptr && scene.plane->soft() != nullptr),
      cover_(scene.plane != nullptr
                 ? std::variant<OutlineCover, PatchCover>(OutlineCover(scene.plane->outline()))
                 : PatchCover()),
      in_space_(scene.space != nullptr) {
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

using S = TrialSummary;

/// How the intervals of a trial become one number.
enum class Adds : std::uint8_t { sum, largest, by_contact, worst, first };

template <auto Member, auto... Part>
Measure::Value value_of(const S& sum) {
    const auto& value = ((sum.*Member).*....*Part);
    if constexpr (requires { value.has_value(); }) {
        return value ? Measure::Value(*value) : Measure::Value();
    } else {
        return value;
    }
}

template <Adds How, auto Member>
void add(const S& a, const S& b, S& all) {
    const auto& first = a.*Member;
    const auto& second = b.*Member;
    if constexpr (How == Adds::sum) {
        all.*Member = first + second;
    } else if constexpr (How == Adds::largest) {
        all.*Member = std::max(first, second);
    } else if constexpr (How == Adds::worst) {  // of those with an episode
        all.*Member = a.contact_episodes == 0 ? second
                    : b.contact_episodes == 0 ? first
                                              : std::max(first, second);
    } else if constexpr (How == Adds::by_contact) {
        if (const std::int64_t contact = a.contact_ticks + b.contact_ticks; contact > 0) {
            all.*Member = (first * static_cast<double>(a.contact_ticks) +
                           second * static_cast<double>(b.contact_ticks)) /
                          static_cast<double>(contact);
        }
    } else if constexpr (requires { first.has_value(); }) {
        all.*Member = first ? first : second;
    }
}

template <Adds How, auto Member, auto... Part>
constexpr Measure measure(std::string_view column,
                          int in_trial,
                          int in_interval,
                          std::string_view meaning,
                          Measure::Needs needs = Measure::Needs::nothing) {
    return {column, value_of<Member, Part...>, add<How, Member>, in_trial, in_interval, meaning,
            needs};
}

using enum Adds;
using Needs = Measure::Needs;

/// tables.sql itself has the columns of place 0 in both tables: one has a CHECK, one stands apart.
// clang-format off
constexpr Measure kMeasures[] = {
    measure<sum, &S::ticks>("ticks", 0, 0, ""),
    measure<sum, &S::contact_ticks>("contact_ticks", 1, 1, "of them in contact"),
    measure<sum, &S::slip_ticks>("slip_ticks", 2, 2, "of these: slip or transition"),
    measure<sum, &S::late_ticks>("late_ticks", 3, 3, "woke more than half a period late"),
    measure<sum, &S::saturated_ticks>("saturated_ticks", 4, 4, "the device could not give the force"),
    measure<sum, &S::slewed_ticks>("force_slew_ticks", 5, 0, "the force changed as fast as it may"),
    measure<sum, &S::stale_ticks>("stale_ticks", 6, 0, "without a new reading"),
    measure<sum, &S::skipped_ticks>("skipped_ticks", 7, 0, "out of reach: nothing was computed"),
    measure<sum, &S::before_vertex_ticks>("before_vertex_ticks", 8, 10,
        "in contact with segment 0, before vertex 0"),
    measure<sum, &S::after_vertex_ticks>("after_vertex_ticks", 9, 12,
        "in contact with segment 1, after vertex 0"),
    measure<sum, &S::path_length_m>("path_length_m", 10, 5, "of HIP"),
    measure<first, &S::start, &engine::Vec2::x>("start_x_m", 0, 8, "HIP at the first tick, to the right"),
    measure<first, &S::start, &engine::Vec2::y>("start_y_m", 0, 9,
        "HIP at the first tick, away from the person"),
    measure<sum, &S::strokes>("strokes", 11, 13, "along the surface, 5 mm or more in one direction"),
    measure<sum, &S::strokes_before_vertex>("strokes_before_vertex", 0, 14,
        "of these: had gone 5 mm on segment 0"),
    measure<sum, &S::strokes_after_vertex>("strokes_after_vertex", 0, 15,
        "of these: had gone 5 mm on segment 1"),
    measure<sum, &S::reversals>("reversals", 0, 16, "of these: came back on the one before, without a lift"),
    measure<sum, &S::vertex_ticks>("vertex_ticks", 0, 11, "in contact on vertex 0 itself"),
    measure<sum, &S::stick_events>("stick_events", 0, 17,
        "times that a sliding god-object stuck again; NULL: without friction nothing sticks", Needs::friction),
    measure<first, &S::speed, &Deciles::p10>("speed_p10_m_per_s", 0, 18,
        "of HIP in contact, over 20 ms: a tenth is no faster"),
    measure<first, &S::speed, &Deciles::p50>("speed_p50_m_per_s", 0, 19, "a half is no faster"),
    measure<first, &S::speed, &Deciles::p90>("speed_p90_m_per_s", 0, 20, "nine tenths are no faster"),
    measure<first, &S::normal_force, &Deciles::p10>("normal_force_p10_n", 0, 21,
        "rendered, over contact ticks: a tenth is no stronger; NULL: no force", Needs::force),
    measure<first, &S::normal_force, &Deciles::p50>("normal_force_p50_n", 0, 22,
        "a half is no stronger; NULL: no force", Needs::force),
    measure<first, &S::normal_force, &Deciles::p90>("normal_force_p90_n", 0, 23,
        "nine tenths are no stronger; NULL: no force", Needs::force),
    measure<first, &S::covered_share>("covered_share", 0, 24,
        "share of the outline, its base left out, that the god-object visited"),
    measure<by_contact, &S::mean_speed_m_per_s>("mean_speed_m_per_s", 12, 0,
        "of HIP in contact: its path there by the time there"),
    measure<by_contact, &S::mean_normal_force_n>("mean_normal_force_n", 13, 6,
        "rendered, over contact ticks; 0 without contact; NULL: the device gives no force", Needs::force),
    measure<largest, &S::max_normal_force_n>("max_normal_force_n", 14, 7,
        "largest rendered normal force; NULL: as above", Needs::force),
    measure<sum, &S::energy_j>("energy_j", 15, 0, "work done on the user; NULL: as above", Needs::force),
    measure<sum, &S::contact_episodes>("contact_episodes", 16, 0, "times that HIP came into contact"),
    measure<worst, &S::worst_episode_j>("worst_episode_j", 17, 0,
        "most energy an episode (with a compliance: all up to one, for the object keeps some between "
        "them) gave beyond K/2 sum |dh|^2; <= 0: passive; NULL: no force", Needs::force),
    measure<first, &S::first_contact_s>("first_contact_s", 0, 0, ""),
};
// clang-format on

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
    sum_.vertex_ticks += tick.segment == -1 ? 1 : 0;
    sum_.stick_events += tick.mode == engine::Mode::stuck && last_mode_ != engine::Mode::stuck &&
                         last_mode_ != engine::Mode::free;
    force_sum_ += tick.normal_force;
    forces_.push_back(tick.normal_force);
    sum_.max_normal_force_n = std::max(sum_.max_normal_force_n, tick.normal_force);
    std::visit([&tick](auto& cover) { cover.add(tick); }, cover_);
    add_speed(tick);
}

/// Way by time between contact ticks kWindow or more apart.
void TrialMeter::add_speed(const engine::TickRecord& tick) {
    const std::int64_t time = tick.time_ns - from_time_;
    const bool begins = last_mode_ == engine::Mode::free;
    if (!begins && time < kWindow) {
        return;
    }
    if (!begins) {
        speeds_.push_back(glm::length(tick.hip - from_) / (static_cast<double>(time) * 1e-9));
    }
    from_ = tick.hip;
    from_time_ = tick.time_ns;
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
        ledger_.add(tick.hip, tick.force, tick.mode != engine::Mode::free);
        last_hip_ = tick.hip;
        last_force_ = tick.force;
        last_time_ = tick.time_ns;
        add_stroke(tick);
        ++sum_.ticks;
        add_flags(tick.flags, sum_);
        if (tick.mode != engine::Mode::free) {
            add_contact(tick);
        }
        last_mode_ = tick.mode;
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
    summary.speed = deciles_of(speeds_);
    summary.normal_force = deciles_of(forces_);
    summary.covered_share = std::visit([](const auto& cover) { return cover.share(); }, cover_);
    if (contact_time_ > 0.0) {
        summary.mean_speed_m_per_s = contact_path_ / contact_time_;
    }
    if (sum_.contact_ticks > 0) {
        summary.mean_normal_force_n = force_sum_ / static_cast<double>(sum_.contact_ticks);
    }
    return summary;
}

std::span<const Measure> measures() noexcept {
    return kMeasures;
}

Measure::Value measured(const Measure& measure, const TrialSummary& sum, bool force) {
    const bool none = (measure.needs == Measure::Needs::force && !force) ||
                      (measure.needs == Measure::Needs::friction && !sum.sticks);
    return none ? Measure::Value() : measure.value(sum);
}

TrialSummary together(const TrialSummary& a, const TrialSummary& b) {
    TrialSummary all = a;
    all.sticks = a.sticks || b.sticks;
    for (const Measure& one : kMeasures) {
        one.add(a, b, all);
    }
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
        add(fmt::format("contact below {:g} s", rules.contact_min));
    }
    if (summary.path_length_m < rules.path_min) {
        add(fmt::format("path below {:g} mm", 1e3 * rules.path_min));
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
