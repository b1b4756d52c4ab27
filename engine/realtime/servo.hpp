#pragma once

#include <atomic>
#include <memory>
#include <thread>
#include <vector>

#include "engine/realtime/spsc_ring.hpp"
#include "engine/realtime/tick_loop.hpp"

namespace palpate::engine {

using TickRing = SpscRing<TickRecord>;

/// 16,384 ticks: 16 s at 1 kHz, far above any pause of the reader.
inline constexpr std::size_t kRingTicks = 16384;

enum class ServoStatus : std::uint8_t {
    running,
    faulted,  ///< the safety chain has tripped: force zero, latched until the next trial
};

struct ServoSpec {
    double rate_hz = 1000.0;  ///< 1000 to 10000
    SafetyLimits limits{};    ///< limits.period follows from rate_hz
};

/// Runs ticks of a device and a scene, on some clock. Ticks come out of ring().
class Servo {
public:
    Servo(Device& device, const ServoSpec& spec);
    Servo(const Servo&) = delete;
    Servo& operator=(const Servo&) = delete;
    virtual ~Servo() = default;

    /// Starts a trial: time 0, force ramping in. @param scene  outlives the trial
    virtual void begin(const Scene& scene) = 0;
    /// Lets a little time pass (about 10 ms, or less) and tells how things stand.
    virtual ServoStatus advance() = 0;
    /// Ramps the force out, writes zero, stops. The ramp's ticks are in the ring as well.
    virtual void end() = 0;
    /// Since the trial's first deadline, s.
    [[nodiscard]] virtual double elapsed_s() const noexcept = 0;

    [[nodiscard]] TickRing& ring() noexcept { return ring_; }
    /// Ticks that found the ring full and are not in it; 0 in every sound run.
    [[nodiscard]] std::int64_t dropped() const noexcept {
        return dropped_.load(std::memory_order_relaxed);
    }
    [[nodiscard]] std::int64_t period_ns() const noexcept { return period_ns_; }
    [[nodiscard]] std::int64_t ramp_ticks() const noexcept { return ramp_ticks_; }

    /// Any thread: the dead-man switch is held (from the start it counts as held).
    void hold(bool held) noexcept { held_.store(held, std::memory_order_relaxed); }
    /// Any thread: force off now and for the rest of the trial, the experimenter's key.
    void stop() noexcept { stop_.store(true, std::memory_order_relaxed); }

    /// Why the force is off, and the ticks up to then. After advance() said faulted, or after end().
    [[nodiscard]] Trip trip() const noexcept { return loop_.trip(); }
    [[nodiscard]] std::vector<TickRecord> last_ticks() const { return loop_.flight().last(); }

protected:
    void run_tick(std::int64_t time_ns, std::int64_t lateness_ns, bool enable) noexcept;
    /// Before each trial: forgets stop() and the last trial's ticks.
    void rewind() noexcept;
    [[nodiscard]] bool faulted() const noexcept { return loop_.trip() != Trip::none; }

    TickLoop loop_;
    std::int64_t period_ns_;
    std::int64_t ramp_ticks_;

private:
    TickRing ring_{kRingTicks};
    std::atomic<std::int64_t> dropped_{0};
    std::atomic<bool> held_{true};
    std::atomic<bool> stop_{false};
};

/// The virtual clock: a tick is due whenever advance() is called, so a run is as fast as the machine
/// and the same to the bit every time. `pace` > 0 slows it to that multiple of real time.
class VirtualServo : public Servo {
public:
    VirtualServo(Device& device, const ServoSpec& spec, double pace = 0.0);

    void begin(const Scene& scene) override;
    ServoStatus advance() override;
    void end() override;
    [[nodiscard]] double elapsed_s() const noexcept override;

private:
    void wait_for_wall_clock() const;

    double pace_;
    std::int64_t ticks_ = 0;
    std::int64_t wall_start_ns_ = 0;
};

/// Real time: a thread of its own on absolute deadlines of CLOCK_MONOTONIC.
class ThreadServo : public Servo {
public:
    ThreadServo(Device& device, const ServoSpec& spec);
    ~ThreadServo() override;

    void begin(const Scene& scene) override;
    /// Does not wait: the caller waits for its own events.
    ServoStatus advance() override;
    void end() override;
    [[nodiscard]] double elapsed_s() const noexcept override;

private:
    void run() noexcept;

    std::thread thread_;
    std::atomic<bool> enable_{false};
    std::atomic<bool> quit_{false};
    std::atomic<bool> faulted_{false};
    std::int64_t start_ns_ = 0;
};

/// CLOCK_MONOTONIC, the one clock of palpate, ns.
[[nodiscard]] std::int64_t monotonic_ns() noexcept;

}  // namespace palpate::engine
