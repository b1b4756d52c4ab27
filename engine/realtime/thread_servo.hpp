#pragma once

#include <atomic>
#include <cstdint>
#include <thread>

#include "engine/realtime/deadline_grid.hpp"
#include "engine/realtime/servo.hpp"

namespace palpate::engine {

/// Real time: one thread for the whole life of this, on absolute deadlines of CLOCK_MONOTONIC.
///
/// The thread takes no lock, allocates nothing and makes no system call but clock, sleep and what
/// the device makes. begin(), end(), park() and unpark() hand it one order at a time, in one atomic
/// word that it looks at once a tick; they return when it has carried the order out.
///
///     parked   the device is not touched. At the start, after park(); after a fault it is kept off
///     resting  read every tick, zero force: latest() moves with the hand
///     running  a trial
///
/// Ticks of a trial are numbered without a gap. time_ns is true: where a deadline was slept through
/// it jumps by the periods that went missing (see DeadlineGrid), the late tick's lateness tells by
/// how many, and lateness().missed() counts them.
///
/// The motors' heat outlives a trial, faulted or not: the next one begins with what is left of it
/// after the rest in between. A new program takes the motors for cold.
class ThreadServo : public Servo {
public:
    /// Starts the thread and takes its rights: rights() is final when this returns.
    /// @throws std::invalid_argument as Servo; std::system_error if no thread can be had
    ThreadServo(Device& device, const ServoSpec& spec);
    /// Ramps out of a trial that still runs. Zero force is the last thing written.
    ~ThreadServo() override;

    void begin(const SceneView& scene) override;
    /// Does not wait for a caller that waits for its own events; one that comes back within half a
    /// millisecond waits here for one, so that it does not take a processor for itself.
    ServoStatus advance() override;
    void end() override;
    void park() override;
    void unpark() override;
    [[nodiscard]] double elapsed_s() const noexcept override;
    [[nodiscard]] bool real_time() const noexcept override { return true; }

private:
    enum class Order : std::uint8_t { none, park, rest, run, finish, quit };
    enum class State : std::uint8_t { parked, resting, running, ramping, faulted };

    struct Wake {
        std::int64_t now_ns = 0;
        std::int64_t lateness_ns = 0;
    };

    void give(Order order);
    void live() noexcept;
    void work() noexcept;
    [[nodiscard]] Wake wake_at(std::int64_t deadline_ns) noexcept;
    [[nodiscard]] bool obey(std::int64_t deadline_ns) noexcept;
    [[nodiscard]] double rest_s(std::int64_t now_ns) const noexcept;
    [[nodiscard]] bool one_tick(const Wake& wake) noexcept;
    [[nodiscard]] bool one_rest(const Wake& wake) noexcept;
    void leave(State state) noexcept;
    void stand(State state) noexcept { state_.store(state, std::memory_order_release); }
    void done() noexcept { done_.store(taken_, std::memory_order_release); }
    [[nodiscard]] State state() const noexcept { return state_.load(std::memory_order_acquire); }

    // Between the threads. An order is its number * 8 + Order.
    std::atomic<std::uint64_t> order_{0};
    std::atomic<std::uint64_t> done_{0};  ///< the last order that was carried out
    std::atomic<State> state_{State::parked};
    std::atomic<std::int64_t> start_ns_{0};  ///< the trial's first deadline
    SceneView scene_{};                      ///< set before the order to run it
    std::int64_t asked_ns_ = 0;              ///< the caller's own: end of the last advance()

    // The thread's own.
    std::uint64_t taken_ = 0;  ///< the last order that it looked at
    bool left_ = false;        ///< parked by a fault: it keeps the force off until the next order
    std::int64_t ramp_left_ = 0;
    std::int64_t last_tick_ns_ = 0;  ///< of any trial; 0: none yet
    AdaptiveSpin spin_;

    RealtimeWish wish_;
    ProgramRights program_rights_;
    std::thread thread_;
};

}  // namespace palpate::engine
