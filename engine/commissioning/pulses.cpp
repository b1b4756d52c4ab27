#include "engine/commissioning/pulses.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace palpate::engine {
namespace {

constexpr double kMostForce = 0.35;    ///< N, whatever is asked for
constexpr double kMostSpeed = 0.5;     ///< m/s: nobody pushes a handle that is free
constexpr double kMostJump = 10.0;     ///< m/s between two readings
constexpr double kSilence = 0.010;     ///< s without a new reading
constexpr int kAgain = 12;             ///< times that a pulse is tried again
constexpr int kLateAnswers = 3;        ///< ticks in a row without a new reading that times bear
constexpr int kLateTicks = 3;          ///< ticks of a pulse that may come late: ms, caught up with
constexpr double kStill = 0.040;       ///< s within a count
constexpr double kPatience = 0.6;      ///< s for the handle to come to rest
constexpr double kAfterwards = 0.060;  ///< s, recorded after the force

/// A pose that cannot be is the trip of the tick.
Trip found(const Reading& reading) noexcept {
    switch (reading.fault) {
        case DeviceFault::none:
            return Trip::none;
        case DeviceFault::silent:
            return Trip::device_silent;
        case DeviceFault::stopped:
            return Trip::device_stopped;
        case DeviceFault::garbage:
            return Trip::device_garbage;
        case DeviceFault::unreachable:
            return Trip::out_of_workspace;
        case DeviceFault::lost:
        case DeviceFault::unguarded:
        case DeviceFault::ended:
            break;
    }
    return Trip::device_lost;
}

}  // namespace

PulseRunner::PulseRunner(Device& device, const PantographSpec& machine, double period, Wait wait)
    : device_(&device), machine_(machine), period_(period), wait_(std::move(wait)) {
    const double motor_time = device.traits().motor_time;
    limits_ = {.period = period,
               .max_force = kMostForce,
               .ramp_step = 1.0,
               .speed = kMostSpeed,
               .jump = kMostJump * period,
               .silent_run = static_cast<std::int32_t>(std::ceil(kSilence / period)),
               .delay_ticks = device.traits().delay_ticks,
               .heat_step = motor_time > 0.0 ? period / motor_time : 0.0};
}

PulseRunner::~PulseRunner() {
    device_->write(Vec2{});
}

PulseRunner::Tick PulseRunner::tick(const Vec2& force) {
    const bool in_time = wait_();
    Tick tick{.reading = device_->read(), .in_time = in_time};
    tick.command = make_safe(safety_, limits_,
                             {.force = force,
                              .hip = tick.reading.hip,
                              .counts = tick.reading.counts,
                              .found = found(tick.reading),
                              .fresh = tick.reading.fresh,
                              .time_ns = ticks_++ * static_cast<std::int64_t>(period_ * 1e9 + 0.5),
                              .load = load_});
    load_ = device_->write(tick.command.force).load;
    return tick;
}

/// Until both encoders have stood still within a count, or the time is up.
void PulseRunner::settle() {
    safety_ = fresh_state(safety_, limits_, 0.0);
    const auto still = static_cast<int>(kStill / period_);
    std::array<std::int32_t, 2> from{};
    int since = 0;
    for (double waited = 0.0; waited < kPatience && since < still; waited += period_) {
        const Reading reading = tick({}).reading;
        const bool moved =
            std::abs(reading.counts[0] - from[0]) > 1 || std::abs(reading.counts[1] - from[1]) > 1;
        since = moved ? 0 : since + 1;
        from = moved ? reading.counts : from;
    }
}

/// A machine that is busy may keep the board's answers back: the zeros are out, and it is asked again.
Pulse PulseRunner::give(const Vec2& direction, const PulsePlan& plan) {
    Pulse pulse = give_once(direction, plan);
    const auto is_worth_another = [&] {
        return pulse.trip == Trip::none ? !pulse.steady
                                        : pulse.trip == Trip::device_silent && device_->reconnect();
    };
    for (int i = 0; i < kAgain && is_worth_another(); ++i) {
        pulse = give_once(direction, plan);
    }
    if (pulse.trip == Trip::none && !pulse.steady) {
        pulse.trip = Trip::late;
    }
    return pulse;
}

Pulse PulseRunner::give_once(const Vec2& direction, const PulsePlan& plan) {
    settle();
    safety_ = fresh_state(safety_, limits_, 0.0);
    Pulse pulse;
    pulse.force = direction * plan.force;
    const auto longest = static_cast<std::size_t>(plan.longest / period_);
    const auto rest = static_cast<std::size_t>(kAfterwards / period_);
    std::size_t end = 2 * longest + rest;
    Vec2 force = pulse.force;
    int late_answers = 0;
    int late_ticks = 0;
    for (std::size_t k = 0; k < end && pulse.trip == Trip::none; ++k) {
        const Tick now = tick(force);
        late_answers = now.reading.fresh ? 0 : late_answers + 1;
        late_ticks += now.in_time ? 0 : 1;
        pulse.steady = pulse.steady && late_ticks <= kLateTicks && late_answers <= kLateAnswers;
        if (k == 0) {
            pulse.place = now.reading.hip;
        }
        const auto fix = machine_.locate(machine_.angles(now.reading.counts));
        pulse.samples.push_back(
            {.time = static_cast<double>(k) * period_,
             .counts = now.reading.counts,
             .torque = fix ? machine_.drive(*fix, now.command.force).torque : Vec2{},
             .fresh = now.reading.fresh && now.reading.ok()});
        pulse.trip = now.command.trip;
        const bool far = glm::length(now.reading.hip - pulse.place) >= plan.travel;
        if (pulse.turn == 0 && k > 0 && (far || k >= longest)) {
            pulse.turn = k + 1;
            end = 2 * pulse.turn + rest;
        }
        force = pulse.turn == 0 ? pulse.force : k + 1 < 2 * pulse.turn ? -pulse.force : Vec2{};
    }
    device_->write(Vec2{});
    return pulse;
}

MarkReading PulseRunner::watch(double seconds) {
    MarkCounts counts;
    Vec2 last{};
    for (double waited = 0.0; waited < seconds; waited += period_) {
        static_cast<void>(wait_());
        const Reading reading = device_->read();
        device_->write(Vec2{});
        if (reading.fault == DeviceFault::silent) {
            static_cast<void>(device_->reconnect());
        }
        const bool usable = reading.ok() || reading.fault == DeviceFault::unreachable;
        if (usable && reading.fresh) {
            counts.add(reading.counts);
            last = reading.hip;
        }
    }
    return counts.readings() > 0 ? counts.at(last) : MarkReading{.place = {NAN, NAN}};
}

std::int32_t moved(const Pulse& pulse) noexcept {
    std::int32_t most = 0;
    for (const PulseSample& sample : pulse.samples) {
        for (std::size_t i = 0; i < 2; ++i) {
            most = std::max(most, std::abs(sample.counts[i] - pulse.samples.front().counts[i]));
        }
    }
    return most;
}

}  // namespace palpate::engine
