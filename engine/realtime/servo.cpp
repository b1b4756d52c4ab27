#include "engine/realtime/servo.hpp"

#include <cmath>
#include <ctime>
#include <stdexcept>

namespace palpate::engine {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

/// Ticks that one advance() of the virtual clock runs: the screen is asked every 10 ms at 1 kHz.
constexpr std::int64_t kSliceNs = 10'000'000;

std::int64_t checked_period(double rate_hz) {
    if (!(rate_hz >= 1000.0 && rate_hz <= 10000.0)) {
        throw std::invalid_argument("the servo rate is " + std::to_string(rate_hz) +
                                    " Hz: give 1000 to 10000");
    }
    return static_cast<std::int64_t>(std::floor(1e9 / rate_hz + 0.5));
}

SafetyLimits with_period(const ServoSpec& spec) {
    SafetyLimits limits = spec.limits;
    limits.period = 1.0 / spec.rate_hz;
    return limits;
}

void sleep_until(std::int64_t deadline_ns) noexcept {
    const timespec deadline{.tv_sec = deadline_ns / kSecond, .tv_nsec = deadline_ns % kSecond};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &deadline, nullptr) != 0) {
    }
}

}  // namespace

std::int64_t monotonic_ns() noexcept {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return static_cast<std::int64_t>(now.tv_sec) * kSecond + now.tv_nsec;
}

Servo::Servo(Device& device, const ServoSpec& spec)
    : loop_(device, with_period(spec)),
      period_ns_(checked_period(spec.rate_hz)),
      ramp_ticks_(static_cast<std::int64_t>(std::ceil(1.0 / spec.limits.ramp_step))) {}

void Servo::run_tick(std::int64_t time_ns, std::int64_t lateness_ns, bool enable) noexcept {
    const TickOrder order{.time_ns = time_ns,
                          .lateness_ns = lateness_ns,
                          .enable = enable,
                          .held = held_.load(std::memory_order_relaxed),
                          .stop = stop_.load(std::memory_order_relaxed)};
    if (!ring_.push(loop_.tick(order))) {
        dropped_.fetch_add(1, std::memory_order_relaxed);
    }
}

void Servo::rewind() noexcept {
    ring_.clear();
    stop_.store(false);
}

VirtualServo::VirtualServo(Device& device, const ServoSpec& spec, double pace)
    : Servo(device, spec), pace_(pace) {}

void VirtualServo::begin(const Scene& scene) {
    rewind();
    loop_.begin(scene);
    ticks_ = 0;
    wall_start_ns_ = monotonic_ns();
}

ServoStatus VirtualServo::advance() {
    const std::int64_t slice = kSliceNs / period_ns_;
    for (std::int64_t i = 0; i < slice && !faulted(); ++i) {
        run_tick(ticks_ * period_ns_, 0, true);
        ++ticks_;
    }
    wait_for_wall_clock();
    return faulted() ? ServoStatus::faulted : ServoStatus::running;
}

void VirtualServo::end() {
    for (std::int64_t i = 0; i < ramp_ticks_ && !faulted(); ++i) {
        run_tick(ticks_ * period_ns_, 0, false);
        ++ticks_;
    }
    loop_.silence();
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

ThreadServo::ThreadServo(Device& device, const ServoSpec& spec) : Servo(device, spec) {}

ThreadServo::~ThreadServo() {
    if (thread_.joinable()) {
        end();
    }
}

void ThreadServo::begin(const Scene& scene) {
    if (thread_.joinable()) {
        end();
    }
    rewind();
    loop_.begin(scene);
    enable_.store(true);
    quit_.store(false);
    faulted_.store(false);
    start_ns_ = monotonic_ns() + period_ns_;
    thread_ = std::thread([this] { run(); });
}

ServoStatus ThreadServo::advance() {
    return faulted_.load() ? ServoStatus::faulted : ServoStatus::running;
}

void ThreadServo::end() {
    enable_.store(false);
    quit_.store(true);
    if (thread_.joinable()) {
        thread_.join();
    }
}

double ThreadServo::elapsed_s() const noexcept {
    return static_cast<double>(monotonic_ns() - start_ns_) * 1e-9;
}

void ThreadServo::run() noexcept {
    std::int64_t ramp_left = ramp_ticks_;
    std::int64_t deadline = start_ns_;
    while (!faulted()) {
        sleep_until(deadline);
        const bool enable = enable_.load(std::memory_order_relaxed);
        const std::int64_t now = monotonic_ns();
        run_tick(now - start_ns_, now - deadline, enable);
        if (quit_.load(std::memory_order_relaxed) && --ramp_left < 0) {
            break;
        }
        deadline += period_ns_;
        if (now > deadline + 100 * period_ns_) {  // suspended: do not race through what was missed
            deadline = now;
        }
    }
    faulted_.store(faulted());
    loop_.silence();
}

}  // namespace palpate::engine
