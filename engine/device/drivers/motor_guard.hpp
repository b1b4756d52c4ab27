#pragma once

#include <cstddef>

#include "engine/device/drivers/board_bytes.hpp"

namespace palpate::engine {

/// What a guard says to a board, and hears from it.
struct GuardPackets {
    BoardBytes zero{};            ///< switches the motors off
    BoardBytes setup{};           ///< what the board may need to understand it; may be empty
    BoardBytes answer{};          ///< how the answer to `zero` begins, at most 8 bytes
    std::size_t answer_size = 0;  ///< bytes of the whole answer
};

/// Whoever switches the motors off when this program no longer can: a process of its own, or, in
/// tests without a port, nobody.
class MotorGuard {
public:
    MotorGuard() = default;
    MotorGuard(const MotorGuard&) = delete;
    MotorGuard& operator=(const MotorGuard&) = delete;
    virtual ~MotorGuard() = default;

    /// From now on guards this port; a guard that was gone is started again. Between trials.
    /// @return false if nobody took the port over
    [[nodiscard]] virtual bool watch(int port, const GuardPackets& packets) = 0;
    /// Lets go of the port, whose motors are off. Between trials.
    virtual void release() noexcept = 0;

    /// Before a torque is sent: from now on a driver that falls silent is taken for hung.
    virtual void force_on() noexcept = 0;
    /// After a zero torque was sent.
    virtual void force_off() noexcept = 0;

    /// From now on, until it is called with false or watch(): zero torque every 20 ms, for nobody
    /// ticks.
    virtual void repeat_zeros(bool /*on*/) noexcept {}

    /// The guard is there and well. Cheap enough for every tick.
    [[nodiscard]] virtual bool alive() const noexcept = 0;
    /// The guard has zeroed the motors because the driver was silent with the force on; until
    /// watch().
    [[nodiscard]] virtual bool tripped() const noexcept = 0;
};

}  // namespace palpate::engine
