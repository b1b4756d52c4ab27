#pragma once

#include <cstdint>

#include "engine/device/drivers/guard_watch.hpp"
#include "engine/device/drivers/motor_guard.hpp"

namespace palpate::engine {

/// A process that holds the port as well and switches the motors off when palpate cannot.
///
/// It wakes at once when the thread that gives force dies, however that comes (kill -9 of palpate
/// too), and zeroes the motors five times: the kernel tells it by a robust mutex that this thread
/// holds, long before the process is gone. When it is, the guard zeroes again; if the board does
/// not answer, it sets the board up and does so again. It also looks every wait_ms: a driver that
/// is silent with the force on (stopped, hung) for `patience` waits has its motors zeroed, and
/// tripped() says so before the driver's next packet. Waits are counted, not clocked, so that a
/// stall of the whole machine is not taken for a hung driver: patience is for hangs only.
///
/// The driver in turn asks the kernel every 2 ms whether its guard has ended or was stopped.
///
/// What it cannot save: both processes killed within these few ms; a cable pulled or a machine that
/// halts with the force on. Only a switch in the motors' supply can.
///
/// It is forked without exec and calls only what may be called after a fork; it closes every file
/// but its own, ignores the terminal's signals, and has a session of its own. Make it before
/// threads.
class GuardProcess : public MotorGuard {
public:
    /// Starts the guard. If that fails, watch() tries again and says so.
    explicit GuardProcess(const GuardTiming& timing = {});
    /// Ends the guard and waits for its end. Motors are not zeroed: the driver has done so.
    ~GuardProcess() override;

    [[nodiscard]] bool watch(int port, const GuardPackets& packets) override;
    void release() noexcept override;
    void force_on() noexcept override;
    void force_off() noexcept override;
    void repeat_zeros(bool on) noexcept override { shared_->repeat.store(on); }
    [[nodiscard]] bool alive() const noexcept override;
    [[nodiscard]] bool tripped() const noexcept override;

    /// It has a control group of its own: what freezes palpate's leaves it alone.
    [[nodiscard]] bool apart() const noexcept { return apart_; }

    /// Of the guard, -1 without one.
    [[nodiscard]] pid_t id() const noexcept { return pid_; }

private:
    [[nodiscard]] bool start();
    void end() noexcept;
    [[nodiscard]] bool listens() const noexcept;
    [[nodiscard]] bool acknowledged() const noexcept;
    void show_life() noexcept;
    [[nodiscard]] bool ended_or_stopped() const noexcept;

    GuardTiming timing_;
    GuardShared* shared_ = nullptr;
    int socket_ = -1;
    pid_t pid_ = -1;
    std::uint64_t beats_ = 0;
    std::uint64_t number_;  ///< of this guard among all of this process
    mutable std::int64_t asked_ns_ = 0;
    mutable bool gone_ = false;
    bool apart_ = false;
};

}  // namespace palpate::engine
