#include "engine/realtime/thread_servo.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace palpate::engine {
namespace {

/// How often a parked thread looks for an order: a trial may begin that much later, which nobody
/// feels, and the processor rests while people read.
constexpr std::int64_t kParkedNs = 4'000'000;
constexpr std::int64_t kLeftNs = 1'000'000;  ///< the same where it keeps the force off meanwhile
/// How often who gave an order looks whether it was carried out.
constexpr auto kPatience = std::chrono::microseconds(500);

/// A caller of advance() that is back within this time waits for nothing by itself.
constexpr std::int64_t kAtOnceNs = 500'000;

void relax() noexcept {
#if defined(__x86_64__)
    _mm_pause();
#endif
}

RealtimeWish wish_of(const Device& device, const ServoSpec& spec) {
    return spec.realtime.value_or(device.traits().gives_force ? RealtimeWish::everything()
                                                              : RealtimeWish::pointer());
}

/// A fault between trials that more reading will not heal.
bool is_gone(DeviceFault fault) noexcept {
    return fault == DeviceFault::lost || fault == DeviceFault::unguarded ||
           fault == DeviceFault::stopped || fault == DeviceFault::ended;
}

}  // namespace

ThreadServo::ThreadServo(Device& device, const ServoSpec& spec)
    : Servo(device, spec),
      spin_(static_cast<std::int64_t>(spec.spin_share * static_cast<double>(period_ns_))),
      wish_(wish_of(device, spec)),
      program_rights_(wish_, rights_, std::array{ring_memory(), MemoryPart{this, sizeof *this}}) {
    {
        const AllSignalsBlocked blocked;  // a handler must not run inside a tick
        thread_ = std::thread([this] { live(); });
    }
    give(Order::none);  // returns when the thread has its rights
}

ThreadServo::~ThreadServo() {
    end();
    give(Order::quit);
    thread_.join();
}

void ThreadServo::begin(const SceneView& scene) {
    end();
    rewind();
    scene_ = scene;
    program_rights_.renew();
    give(Order::run);
}

ServoStatus ThreadServo::advance() {
    if (monotonic_ns() - asked_ns_ < kAtOnceNs) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    asked_ns_ = monotonic_ns();
    return state() == State::faulted ? ServoStatus::faulted : ServoStatus::running;
}

void ThreadServo::end() {
    if (state() == State::running) {
        give(Order::finish);
    }
}

void ThreadServo::park() {
    end();
    give(Order::park);
}

void ThreadServo::unpark() {
    end();
    give(Order::rest);
}

double ThreadServo::elapsed_s() const noexcept {
    const std::int64_t start = start_ns_.load(std::memory_order_relaxed);
    return start == 0 ? 0.0 : static_cast<double>(monotonic_ns() - start) * 1e-9;
}

void ThreadServo::give(Order order) {
    const std::uint64_t number = order_.load(std::memory_order_relaxed) / 8 + 1;
    const std::uint64_t word = number * 8 + static_cast<std::uint64_t>(order);
    order_.store(word, std::memory_order_release);
    while (done_.load(std::memory_order_acquire) != word) {
        std::this_thread::sleep_for(kPatience);
    }
}

void ThreadServo::live() noexcept {
    take_thread_rights(wish_, rights_);
    for (;;) {
        const std::uint64_t word = order_.load(std::memory_order_acquire);
        if (word != done_.load(std::memory_order_relaxed)) {
            left_ = false;
            const auto order = static_cast<Order>(word % 8);  // finish: a fault was quicker
            if (order == Order::run || order == Order::rest) {
                work();
                continue;
            }
            taken_ = word;
            done();
            if (order == Order::quit) {
                return;
            }
        }
        if (left_) {
            loop_.keep_off();
        }
        sleep_until(monotonic_ns() + (left_ ? kLeftNs : kParkedNs));
    }
}

void ThreadServo::work() noexcept {
    DeadlineGrid grid(monotonic_ns() + period_ns_, period_ns_);
    for (;;) {
        const Wake wake = wake_at(grid.deadline());
        if (!obey(grid.deadline()) || !one_tick(wake)) {
            return;
        }
        const std::int64_t missed = grid.pass(wake.now_ns);
        if (state() != State::resting) {
            lateness_.add_missed(missed);
        }
    }
}

ThreadServo::Wake ThreadServo::wake_at(std::int64_t deadline_ns) noexcept {
    const std::int64_t asked = deadline_ns - spin_.ahead_ns();
    std::int64_t now = monotonic_ns();
    if (now < asked) {
        sleep_until(asked);
        now = monotonic_ns();
        spin_.woke(now - asked);
    }
    while (now < deadline_ns) {
        relax();
        now = monotonic_ns();
    }
    return {.now_ns = now, .lateness_ns = now - deadline_ns};
}

/// Since the last tick of the trial before; for ever before the first.
double ThreadServo::rest_s(std::int64_t now_ns) const noexcept {
    return last_tick_ns_ == 0 ? std::numeric_limits<double>::infinity()
                              : std::max(0.0, static_cast<double>(now_ns - last_tick_ns_) * 1e-9);
}

/// @return false: leave the device alone
bool ThreadServo::obey(std::int64_t deadline_ns) noexcept {
    const std::uint64_t word = order_.load(std::memory_order_acquire);
    if (word == taken_) {
        return true;
    }
    taken_ = word;
    switch (static_cast<Order>(word % 8)) {
        case Order::run:
            idle_fault_ = DeviceFault::none;
            forget_rest();
            take_move();
            loop_.begin(scene_, rest_s(deadline_ns));
            start_ns_.store(deadline_ns, std::memory_order_relaxed);
            stand(State::running);
            done();
            break;
        case Order::finish:  // done when the force is out
            ramp_left_ = ramp_ticks_;
            stand(State::ramping);
            break;
        case Order::rest:
            idle_fault_ = DeviceFault::none;
            if (state() != State::resting) {
                begin_rest();
            }
            stand(State::resting);
            done();
            break;
        case Order::park:
            loop_.prove_zero();
            stand(State::parked);
            done();
            return false;
        case Order::quit:
            loop_.prove_zero();
            stand(State::parked);
            return false;
        case Order::none:
            done();
            break;
    }
    return true;
}

/// Nobody reads the device any more: zero is proved, then the state is said.
void ThreadServo::leave(State state) noexcept {
    loop_.prove_zero();
    left_ = true;
    stand(state);
}

/// @return false: a fault that more reading will not heal
bool ThreadServo::one_rest(const Wake& wake) noexcept {
    const DeviceFault before = idle_fault_;
    run_idle(wake.now_ns);
    if (is_gone(idle_fault_)) {
        leave(State::parked);
        return false;
    }
    const bool failed = idle_fault_ != DeviceFault::none && idle_fault_ != DeviceFault::unreachable;
    if (failed && idle_fault_ != before) {
        loop_.prove_zero();
    } else if (failed) {
        loop_.keep_off();
    }
    return true;
}

/// @return false: a fault, zero was written
bool ThreadServo::one_tick(const Wake& wake) noexcept {
    if (state() == State::resting) {
        return one_rest(wake);
    }
    const bool enable = state() == State::running;
    const std::int64_t start = start_ns_.load(std::memory_order_relaxed);
    run_tick(wake.now_ns - start, wake.now_ns, wake.lateness_ns, enable);
    last_tick_ns_ = wake.now_ns;
    if (faulted()) {
        leave(State::faulted);
        return false;
    }
    if (!enable && --ramp_left_ <= 0) {
        loop_.silence();
        begin_rest();
        stand(State::resting);
        done();
    }
    return true;
}

}  // namespace palpate::engine
