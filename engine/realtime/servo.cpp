#include "engine/realtime/servo.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/refuse.hpp"

namespace palpate::engine {
namespace {

/// Ticks that one advance() of the virtual clock runs: the screen is asked every 10 ms at 1 kHz.
constexpr std::int64_t kSliceNs = 10'000'000;

std::int64_t checked_period(const ServoSpec& spec) {
    refuse_if(!(spec.rate_hz >= 1000.0 && spec.rate_hz <= 10000.0),
              "the servo rate is {:f} Hz: give 1000 to 10000", spec.rate_hz);
    refuse_if(!(spec.spin_share >= 0.0 && spec.spin_share <= 0.5),
              "the servo may spin for {:f} of its period: give 0 to 0.5", spec.spin_share);
    return tick_period_ns(spec.rate_hz);
}

SafetyLimits with_period(const ServoSpec& spec) {
    SafetyLimits limits = spec.limits;
    limits.period = 1.0 / spec.rate_hz;
    return limits;
}

}  // namespace

Servo::Servo(Device& device, const ServoSpec& spec)
    : loop_(device, with_period(spec)),
      period_ns_(checked_period(spec)),
      ramp_ticks_(static_cast<std::int64_t>(std::ceil(1.0 / spec.limits.ramp_step))) {}

void Servo::hold(bool held) noexcept {
    held_ns_.store(held ? monotonic_ns() : 0, std::memory_order_relaxed);
}

void Servo::beat() noexcept {
    const std::int64_t now = monotonic_ns();
    beat_ns_.store(now, std::memory_order_relaxed);
    std::int64_t seen = held_ns_.load();
    if (seen != 0 && seen != kAlways) {  // who is alive would have said that it was let go
        held_ns_.compare_exchange_strong(seen, now);
    }
}

/// In the ramp out nobody says it again.
bool Servo::held_at(std::int64_t at_ns, bool enable) const noexcept {
    const std::int64_t seen = held_ns_.load(std::memory_order_relaxed);
    const bool lasts = seen == kAlways || !real_time() || !enable;
    return seen != 0 && (lasts || at_ns - seen <= kHeldNs);
}

double Servo::screen_age_at(std::int64_t at_ns) const noexcept {
    const std::int64_t beat = beat_ns_.load(std::memory_order_relaxed);
    return real_time() ? std::max(0.0, 1e-9 * static_cast<double>(at_ns - beat)) : 0.0;
}

void Servo::run_tick(std::int64_t time_ns,
                     std::int64_t at_ns,
                     std::int64_t lateness_ns,
                     bool enable) noexcept {
    const TickOrder order{
        .time_ns = time_ns,
        .lateness_ns = lateness_ns,
        .enable = enable,
        .held = held_at(at_ns, enable),
        .screen_age = screen_age_at(at_ns),
        .stop = found_ != Trip::none ? found_ : stop_.load(std::memory_order_relaxed)};
    const TickRecord record = loop_.tick(order);
    if (!ring_.push(record)) {
        dropped_.fetch_add(1, std::memory_order_relaxed);
    }
    lateness_.add(lateness_ns, (record.flags & tick_late) != 0);
}

void Servo::run_idle(std::int64_t at_ns) noexcept {
    const Reading reading = loop_.idle();
    idle_fault_ = reading.fault;
    const Trip moved = watch_rest(rest_watch_, loop_.limits(), reading, at_ns, monotonic_ns());
    Trip none = Trip::none;
    moved_.compare_exchange_strong(none, moved);
    rest_.publish({.at_ns = at_ns, .hip = reading.hip, .fault = reading.fault});
}

void Servo::rewind() noexcept {
    ring_.clear();
    beat();
}

VirtualServo::VirtualServo(Device& device, const ServoSpec& spec, double pace)
    : Servo(device, spec), pace_(pace) {}

VirtualServo::~VirtualServo() {
    if (in_trial_) {
        loop_.silence();
    }
}

void VirtualServo::begin(const SceneView& scene) {
    rewind();
    loop_.begin(scene);
    ticks_ = 0;
    wall_start_ns_ = monotonic_ns();
    in_trial_ = true;
}

ServoStatus VirtualServo::advance() {
    const std::int64_t slice = kSliceNs / period_ns_;
    for (std::int64_t i = 0; i < slice && !faulted(); ++i) {
        const std::int64_t time = ticks_++ * period_ns_;
        run_tick(time, time, 0, true);
        if (faulted()) {
            loop_.prove_zero();
        }
    }
    wait_for_wall_clock();
    return faulted() ? ServoStatus::faulted : ServoStatus::running;
}

void VirtualServo::end() {
    if (!in_trial_) {
        return;
    }
    for (std::int64_t i = 0; i < ramp_ticks_ && !faulted(); ++i) {
        const std::int64_t time = ticks_++ * period_ns_;
        run_tick(time, time, 0, false);
    }
    loop_.silence();
    in_trial_ = false;
}

double VirtualServo::elapsed_s() const noexcept {
    return static_cast<double>(ticks_ * period_ns_) * 1e-9;
}

void VirtualServo::wait_for_wall_clock() const {
    if (pace_ > 0.0) {
        const double due = static_cast<double>(ticks_ * period_ns_) / pace_;
        sleep_until(wall_start_ns_ + static_cast<std::int64_t>(due));
    }
}

}  // namespace palpate::engine
