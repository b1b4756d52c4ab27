#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>

#include "engine/device/calibration.hpp"

namespace palpate::engine {

/// What hangs on a board: motors and encoders of pivot 1 and pivot 2, or of three straight axes.
class BoardPlant {
public:
    BoardPlant() = default;
    BoardPlant(const BoardPlant&) = delete;
    BoardPlant& operator=(const BoardPlant&) = delete;
    virtual ~BoardPlant() = default;

    /// What the motors get, N m, anticlockwise; of two motors the third is 0.
    virtual void set_torque(const Vec3& newton_metres) noexcept = 0;
    virtual void advance(double seconds) noexcept = 0;
    /// rad, anticlockwise. @param axis  from 0, one that is there
    [[nodiscard]] virtual double angle(std::size_t axis) const noexcept = 0;
    /// A set-up is about to take the present pose for its offset.
    virtual void before_set_up() noexcept {}
};

/// A board behind a port as a machine of bytes, deterministic, on a clock that poll() and pass()
/// drive.
class PortBoard {
public:
    static constexpr double kPollPeriod = 50e-6;  ///< s

    PortBoard() = default;
    PortBoard(const PortBoard&) = delete;
    PortBoard& operator=(const PortBoard&) = delete;
    virtual ~PortBoard() = default;

    /// Bytes from the host.
    virtual void receive(std::span<const std::uint8_t> bytes) {
        in_.insert(in_.end(), bytes.begin(), bytes.end());
    }
    /// 50 us pass: the plant moves, and one command is taken.
    virtual void poll() = 0;
    /// 50 us pass while the bus is still at the rest of a command.
    virtual void pass() = 0;
    /// Bytes to the host that are due. @return how many were put into `into`
    [[nodiscard]] virtual std::size_t transmit(std::span<std::uint8_t> into) {
        std::size_t sent = 0;
        for (; sent < into.size() && !out_.empty() && out_.front().poll <= polls_; ++sent) {
            into[sent] = out_.front().byte;
            out_.pop_front();
        }
        return sent;
    }
    /// The command at the front lacks bytes that the board would make up.
    [[nodiscard]] virtual bool command_is_cut() const noexcept { return false; }
    /// Bytes from the host wait to be taken.
    [[nodiscard]] virtual bool has_input() const noexcept { return !in_.empty(); }
    /// What the motors get, N m, anticlockwise; of two motors the third is 0.
    [[nodiscard]] virtual Vec3 torque() const noexcept = 0;
    /// From now on no command is answered, or each is again.
    virtual void hush(bool silent) = 0;
    /// Somebody presses the emergency stop, if there is one, or releases it.
    virtual void press_stop(bool /*pressed*/) noexcept {}
    /// s since it began.
    [[nodiscard]] virtual double time() const noexcept {
        return static_cast<double>(polls_) * kPollPeriod;
    }
    /// Power off and on: nothing is set up, motors are off.
    virtual void power_cycle() = 0;

protected:
    /// When what is answered now is due. @param delay  s from a command to its answer
    [[nodiscard]] std::int64_t due_after(double delay) const noexcept {
        return polls_ + static_cast<std::int64_t>(delay / kPollPeriod);
    }
    /// A byte to the host, and when it is due.
    struct Due {
        std::int64_t poll = 0;
        std::uint8_t byte = 0;
    };

    std::deque<std::uint8_t> in_{};
    std::deque<Due> out_{};
    std::int64_t polls_ = 0;
};

}  // namespace palpate::engine
