#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "engine/base/clock.hpp"
#include "engine/base/lock_free.hpp"
#include "engine/realtime/lateness_histogram.hpp"
#include "engine/realtime/realtime_rights.hpp"
#include "engine/realtime/tick_loop.hpp"
#include "engine/safety/motion_watch.hpp"

namespace palpate::engine {

/// How ticks leave the servo's thread.
using TickRing = SpscRing<TickRecord>;

/// 16,384 ticks: 16 s at 1 kHz, far above any pause of the reader.
inline constexpr std::size_t kRingTicks = 16384;

/// A dead-man key counts as held for so long after the screen last saw it held, ns. Longer than
/// SafetyLimits::screen_silence, so that a screen that stands still is called so.
inline constexpr std::int64_t kHeldNs = 300'000'000;

/// Whether the servo still gives force.
enum class ServoStatus : std::uint8_t {
    running,
    faulted,  ///< the safety chain has tripped: force zero, latched until the next trial
};

/// How a servo runs.
struct ServoSpec {
    double rate_hz = 1000.0;  ///< 1000 to 10000
    SafetyLimits limits{};    ///< limits.period follows from rate_hz
    /// What a real-time servo asks of the system. None: everything for a device that gives force,
    /// RealtimeWish::pointer() for another.
    std::optional<RealtimeWish> realtime{};
    /// Share of the period that a real-time servo may watch the clock before a deadline instead of
    /// sleeping, 0 to 0.5; 0: it sleeps. See AdaptiveSpin. Off unless asked for: 25 us at the 99th
    /// percentile do not matter at 1 kHz. 0.3 brings them below 1 us for a tenth of a
    /// processor at 1 kHz, a quarter at 4 and 10 kHz (tests/bench, `servo`).
    double spin_share = 0.0;
};

/// What the device said between trials: where a free handle is.
struct RestReading {
    std::int64_t at_ns = 0;  ///< monotonic_ns() of the reading; 0: a trial began since
    Vec3 hip{};              ///< m
    DeviceFault fault = DeviceFault::none;  ///< hip is not new
};

/// Runs ticks of a device and a scene, on some clock. Ticks come out of ring().
///
/// begin(), advance(), end(), park() and unpark() belong to one thread; hold(), beat(), stop(),
/// allow() and resting() to any.
class Servo {
public:
    /// @param device  outlives the servo
    /// @throws std::invalid_argument for a rate or a share of spinning out of its range
    Servo(Device& device, const ServoSpec& spec);
    virtual ~Servo() = default;

    /// Starts a trial: time 0, force ramping in. @param scene  what it looks at outlives the trial
    virtual void begin(const SceneView& scene) = 0;
    /// Lets a little time pass (about 10 ms, or less) and tells how things stand.
    virtual ServoStatus advance() = 0;
    /// Ramps the force out, writes zero, stops. The ramp's ticks are in the ring as well.
    virtual void end() = 0;
    /// Since the trial's first deadline, s.
    [[nodiscard]] virtual double elapsed_s() const noexcept = 0;

    /// Between trials: from here to the next begin() or unpark() the device is not touched, so that
    /// Device::reconnect() or a calibration may use it. Before the first begin(), and after a
    /// fault, a servo is parked by itself.
    virtual void park() {}
    /// Between trials: reads the device again, with zero force, so that resting() moves with
    /// the hand.
    virtual void unpark() {}

    /// Deadlines are those of the wall clock, and may be missed.
    [[nodiscard]] virtual bool real_time() const noexcept { return false; }

    /// For its name and traits; the servo alone reads it and gives it force.
    [[nodiscard]] const Device& device() const noexcept { return loop_.device(); }
    /// Where the ticks come out; one reader.
    [[nodiscard]] TickRing& ring() noexcept { return ring_; }
    /// Ticks that found the ring full and are not in it; 0 in every sound run.
    [[nodiscard]] std::int64_t dropped() const noexcept {
        return dropped_.load(std::memory_order_relaxed);
    }
    [[nodiscard]] std::int64_t period_ns() const noexcept { return period_ns_; }
    [[nodiscard]] std::int64_t ramp_ticks() const noexcept { return ramp_ticks_; }

    /// Any thread: the dead-man key went down or up (from the start it counts as held). On the
    /// wall's clock that it is held holds for kHeldNs; beat() says it again.
    void hold(bool held) noexcept;
    /// Any thread: whoever could end the force is alive. On the wall's clock a trial with
    /// SafetyLimits::screen_silence needs this again and again; its begin counts as one.
    void beat() noexcept;
    /// Any thread: force off now, and none in this trial or another until allow(). The first cause
    /// stays. @param why  Trip::stopped or Trip::focus_lost
    void stop(Trip why = Trip::stopped) noexcept {
        Trip none = Trip::none;
        stop_.compare_exchange_strong(none, why);
    }
    /// Between trials: whoever may has settled what stopped the force.
    void allow() noexcept { stop_.store(Trip::none); }
    /// Any thread: the newest reading between trials; none before the first.
    [[nodiscard]] std::optional<RestReading> resting() const noexcept { return rest_.read(); }

    /// Any thread: how the handle moved between trials as no hand does, Trip::jump or
    /// Trip::over_speed; none: it did not. It stays until forget_move(), and a trial that begins
    /// before trips on it in its first tick.
    [[nodiscard]] Trip moved() const noexcept { return moved_.load(); }
    /// Between trials: whoever may was told.
    void forget_move() noexcept { moved_.store(Trip::none); }

    /// Why the force is off, and the ticks up to then. After advance() said faulted, or after
    /// end().
    [[nodiscard]] Trip trip() const noexcept { return loop_.trip(); }
    [[nodiscard]] std::vector<TickRecord> last_ticks() const { return loop_.flight().last(); }
    /// Lateness of all ticks of all trials so far, 0 on a virtual clock. After end() or a fault.
    [[nodiscard]] const LatenessHistogram& lateness() const noexcept { return lateness_; }
    /// What the system granted; nothing is asked for a virtual clock.
    [[nodiscard]] const RealtimeRights& rights() const noexcept { return rights_; }

protected:
    void run_tick(std::int64_t time_ns,
                  std::int64_t at_ns,
                  std::int64_t lateness_ns,
                  bool enable) noexcept;
    void run_idle(std::int64_t at_ns) noexcept;
    /// On the thread that ticks, as it begins to rest.
    void begin_rest() noexcept { rest_watch_ = RestWatch{}; }
    /// The same, as a trial begins.
    void take_move() noexcept { found_ = moved_.exchange(Trip::none); }
    /// On the thread that ticks, as a trial begins: what was read before it is no place any more.
    void forget_rest() noexcept { rest_.publish({}); }
    /// Before each trial: forgets the last trial's ticks.
    void rewind() noexcept;
    /// Where the ticks go that come out of ring().
    [[nodiscard]] MemoryPart ring_memory() const noexcept {
        return {ring_.slots().data(), ring_.slots().size_bytes()};
    }
    [[nodiscard]] bool faulted() const noexcept { return loop_.trip() != Trip::none; }

    TickLoop loop_;
    std::int64_t period_ns_;
    std::int64_t ramp_ticks_;
    LatenessHistogram lateness_{};
    RealtimeRights rights_{};
    DeviceFault idle_fault_ = DeviceFault::none;  ///< of the last tick between trials

private:
    static constexpr std::int64_t kAlways = std::numeric_limits<std::int64_t>::max();
    [[nodiscard]] bool held_at(std::int64_t at_ns, bool enable) const noexcept;
    [[nodiscard]] double screen_age_at(std::int64_t at_ns) const noexcept;

    TickRing ring_{kRingTicks};
    LatestValue<RestReading> rest_{};
    RestWatch rest_watch_{};
    Trip found_ = Trip::none;  ///< before this trial
    std::atomic<Trip> moved_{Trip::none};
    std::atomic<std::int64_t> dropped_{0};
    std::atomic<std::int64_t> held_ns_{kAlways};  ///< when it was last seen held; 0: let go
    std::atomic<std::int64_t> beat_ns_{0};
    std::atomic<Trip> stop_{Trip::none};
};

/// The virtual clock: a tick is due whenever advance() is called, so a run is as fast as the
/// machine and the same to the bit every time. `pace` > 0 slows it to that multiple of real time.
/// The device is touched inside begin(), advance() and end() only. Every trial begins with cold
/// motors: no time passes between trials on this clock, and a resumed session has to give the
/// trials of the unbroken one.
class VirtualServo : public Servo {
public:
    /// @param pace  of real time; 0: as fast as the machine. @throws as Servo
    VirtualServo(Device& device, const ServoSpec& spec, double pace = 0.0);
    /// Zero force is the last thing written, also where a trial was left by an exception.
    ~VirtualServo() override;

    void begin(const SceneView& scene) override;
    ServoStatus advance() override;
    void end() override;
    [[nodiscard]] double elapsed_s() const noexcept override;

private:
    void wait_for_wall_clock() const;

    double pace_;
    std::int64_t ticks_ = 0;
    std::int64_t wall_start_ns_ = 0;
    bool in_trial_ = false;
};

}  // namespace palpate::engine
