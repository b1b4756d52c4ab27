#include "engine/commissioning/pulses.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "engine/device/homing.hpp"

namespace palpate::engine {
namespace {

constexpr double kMoreForce = 0.05;    ///< N beyond the strongest pulse, whatever is asked for
constexpr double kMaxSpeed = 0.5;      ///< m/s: nobody pushes a handle that is free
constexpr double kMaxJump = 10.0;      ///< m/s between two readings
constexpr double kSilence = 0.010;     ///< s without a new reading
constexpr int kAgain = 12;             ///< times that a pulse is tried again
constexpr int kLateAnswers = 3;        ///< ticks in a row without a new reading that times bear
constexpr int kLateTicks = 3;          ///< ticks of a pulse that may come late: ms, caught up with
constexpr double kStill = 0.040;       ///< s within a count
constexpr double kPatience = 0.6;      ///< s for the handle to come to rest
constexpr double kAfterwards = 0.060;  ///< s, recorded after the force

constexpr std::array<double, 5> kForces{0.1, 0.2, 0.3, 0.5, 1.0};
constexpr std::array<Vec3, 6> kDirections{Vec3{1.0, 0.0, 0.0}, Vec3{-1.0, 0.0, 0.0},
                                          Vec3{0.0, 1.0, 0.0}, Vec3{0.0, -1.0, 0.0},
                                          Vec3{0.0, 0.0, 1.0}, Vec3{0.0, 0.0, -1.0}};

}  // namespace

std::span<const double> pulse_forces(std::size_t axes) noexcept {
    return std::span(kForces).first(axes > 2 ? 5 : 3);
}

std::span<const Vec3> pulse_directions(std::size_t axes) noexcept {
    return std::span(kDirections).first(2 * axes);
}

PulseRunner::PulseRunner(Device& device, const Machine& machine, double period, Wait wait)
    : device_(&device), machine_(machine), period_(period), wait_(std::move(wait)) {
    const double motor_time = device.traits().motor_time;
    limits_ = {.period = period,
               .max_force = pulse_forces(machine.axes()).back() + kMoreForce,
               .ramp_step = 1.0,
               .speed = kMaxSpeed,
               .jump = kMaxJump * period,
               .silent_run = static_cast<std::int32_t>(std::ceil(kSilence / period)),
               .delay_ticks = device.traits().delay_ticks,
               .heat_step = motor_time > 0.0 ? period / motor_time : 0.0,
               .axes = static_cast<int>(machine.axes())};
}

PulseRunner::~PulseRunner() {
    device_->prove_zero();
}

PulseRunner::Tick PulseRunner::tick(const Vec3& force) {
    const bool in_time = wait_();
    Tick tick{.reading = device_->read(), .in_time = in_time};
    here_ = tick.reading.ok() ? tick.reading.hip : here_;
    tick.command = make_safe(safety_, limits_,
                             {.force = force,
                              .hip = tick.reading.hip,
                              .counts = tick.reading.counts,
                              .found = trip_of(tick.reading.fault),
                              .fresh = tick.reading.fresh,
                              .time_ns = ticks_++ * static_cast<std::int64_t>(period_ * 1e9 + 0.5),
                              .load = load_});
    load_ = device_->write(tick.command.force).load;
    return tick;
}

/// Until all encoders have stood still within a count, or the time is up.
void PulseRunner::settle() {
    safety_ = fresh_state(safety_, limits_, 0.0);
    const auto still = static_cast<int>(kStill / period_);
    Machine::Counts from{};
    int since = 0;
    for (double waited = 0.0; waited < kPatience && since < still; waited += period_) {
        const Machine::Counts now = tick(Vec3{}).reading.counts;
        bool moved = false;
        for (std::size_t i = 0; i < now.size(); ++i) {
            moved = moved || std::abs(now[i] - from[i]) > 1;
        }
        since = moved ? 0 : since + 1;
        from = moved ? now : from;
    }
}

bool PulseRunner::answers_again() {
    const bool back = device_->reconnect();
    reconnected_ = reconnected_ || back;
    return back;
}

/// A machine that is busy may keep the board's answers back: the zeros are out, and it is asked
/// again.
Pulse PulseRunner::give(const Vec3& direction, const PulsePlan& plan) {
    Pulse pulse = give_once(direction, plan);
    const auto is_worth_another = [&] {
        return pulse.trip == Trip::none ? !pulse.steady
                                        : pulse.trip == Trip::device_silent && answers_again();
    };
    for (int i = 0; i < kAgain && is_worth_another(); ++i) {
        pulse = give_once(direction, plan);
    }
    if (pulse.trip == Trip::none && !pulse.steady) {
        pulse.trip = Trip::late;
    }
    return pulse;
}

Pulse PulseRunner::give_once(const Vec3& direction, const PulsePlan& plan) {
    settle();
    safety_ = fresh_state(safety_, limits_, 0.0);
    Pulse pulse;
    pulse.force = direction * plan.force;
    const auto longest = static_cast<std::size_t>(plan.longest / period_);
    const auto rest = static_cast<std::size_t>(kAfterwards / period_);
    std::size_t end = 2 * longest + rest;
    Vec3 force = pulse.force;
    int late_answers = 0;
    int late_ticks = 0;
    for (std::size_t k = 0; k < end && pulse.trip == Trip::none; ++k) {
        const Tick now = tick(force);
        late_answers = now.reading.fresh ? 0 : late_answers + 1;
        late_ticks += now.in_time ? 0 : 1;
        pulse.steady = pulse.steady && late_ticks <= kLateTicks && late_answers <= kLateAnswers;
        if (k == 0) {
            pulse.place = here_;
        }
        const Machine::Counts& counts = now.reading.counts;
        const auto place = machine_.locate(counts);
        pulse.samples.push_back(
            {.time = static_cast<double>(k) * period_,
             .counts = counts,
             .torque = place ? machine_.drive(*place, now.command.force).torque : Vec3{},
             .fresh = now.reading.fresh && now.reading.ok()});
        pulse.trip = now.command.trip;
        const bool far = glm::length(now.reading.hip - pulse.place) >= plan.travel;
        if (pulse.turn == 0 && k > 0 && (far || k >= longest)) {
            pulse.turn = k + 1;
            end = 2 * pulse.turn + rest;
        }
        force = pulse.turn == 0 ? pulse.force : k + 1 < 2 * pulse.turn ? -pulse.force : Vec3{};
    }
    if (pulse.trip == Trip::none) {
        device_->write(Vec3{});
    } else {
        device_->prove_zero();
    }
    return pulse;
}

Rest PulseRunner::watch(double seconds) {
    Vec3 last{};
    MarkCounts seen;
    for (double waited = 0.0; waited < seconds; waited += period_) {
        static_cast<void>(wait_());
        const Reading reading = device_->read();
        device_->write(Vec3{});
        if (reading.fault == DeviceFault::silent || reading.fault == DeviceFault::held) {
            static_cast<void>(answers_again());
        }
        const bool usable = reading.ok() || reading.fault == DeviceFault::unreachable;
        if (usable && reading.fresh) {
            seen.add(reading.counts);
            last = reading.hip;
        }
    }
    return seen.readings() > 0 ? Rest{.place = last, .counts = seen.mean(), .span = seen.span()}
                               : Rest{};
}

Vec3 acting_torque(std::span<const PulseSample> samples, std::size_t k, double delay) noexcept {
    const double behind = delay / (samples[k].time - samples[k - 1].time);
    const auto whole = static_cast<std::size_t>(behind);
    const double part = behind - static_cast<double>(whole);
    const auto torque = [&](std::size_t back) {
        return k >= back + 1 ? samples[k - back - 1].torque : Vec3{};
    };
    return (1.0 - part) * torque(whole) + part * torque(whole + 1);
}

std::int32_t moved(const Pulse& pulse) noexcept {
    std::int32_t max = 0;
    for (const PulseSample& sample : pulse.samples) {
        for (std::size_t i = 0; i < sample.counts.size(); ++i) {
            max = std::max(max, std::abs(sample.counts[i] - pulse.samples.front().counts[i]));
        }
    }
    return max;
}

}  // namespace palpate::engine
