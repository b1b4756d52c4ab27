#pragma once

#include <array>
#include <deque>
#include <optional>

#include "engine/device/emulator/port_board.hpp"
#include "engine/device/firmware/board.h"
#include "engine/device/open/open_wire.hpp"

namespace palpate::engine {

/// The open board's own firmware, compiled for this machine, on emulated pins. Its answers go out
/// at once; commands that come together are taken one after the other.
class OpenBoard : public PortBoard {
public:
    /// @param plant  outlives the board
    /// @param machine  counts a turn and torque limits are those that the firmware was built for
    /// @param wired    how motors and encoders are wired in truth
    OpenBoard(BoardPlant& plant, const Calibration& machine, const OpenWiring& wired);

    void poll() override;
    void pass() override;
    void power_cycle() override;

    /// A datagram of `from`, taken at once; its answer comes out of letter().
    void post(std::uint64_t from, std::span<const std::uint8_t> datagram);
    struct Letter {
        std::int64_t due = 0;  ///< polls since it began
        std::uint64_t to = 0;
        BoardBytes datagram{};
    };
    /// An answer to a datagram that is due.
    [[nodiscard]] std::optional<Letter> letter();

    void press_stop(bool pressed) noexcept override { stop_pressed_ = pressed; }
    /// s from a command to its answer.
    void delay_answers(double seconds) noexcept { delay_ = seconds; }
    void hush(bool silent) noexcept override { silent_ = silent; }
    /// An encoder misses an edge.
    void skip_edge() noexcept { skipped_ = true; }

    /// The drivers' enable line is high.
    [[nodiscard]] bool enabled() const noexcept { return enabled_; }
    [[nodiscard]] Vec3 torque() const noexcept override {
        return {torque_of(0), torque_of(1), torque_of(2)};
    }
    /// From now on the encoder of this axis, from 0, says what it says now: its cable is out; or no
    /// more.
    void unplug_encoder(std::size_t axis, bool out) noexcept;
    [[nodiscard]] int state() const noexcept { return board_.state; }

private:
    friend void ::platform_motors_off(board*);
    friend void ::platform_motors_on(board*);
    friend void ::platform_duty(board*, std::uint8_t, std::int16_t);
    friend bool ::platform_stop_pressed(board*);
    friend void ::platform_sense(board*, board_sense*);
    friend void ::platform_forget(board*, bool);

    [[nodiscard]] std::array<std::int32_t, kMaxAxes> true_counts() const noexcept;
    [[nodiscard]] double torque_of(std::size_t axis) const noexcept;
    void drive() noexcept;

    BoardPlant* plant_;
    Calibration machine_;
    OpenWiring wired_;
    board_facts facts_{};
    board board_{};
    bool stop_pressed_ = false;
    bool silent_ = false;
    bool skipped_ = false;
    bool enabled_ = false;
    double delay_ = 0.0;
    std::array<std::int16_t, kMaxAxes> duty_{};  ///< by channel
    std::array<std::int32_t, kMaxAxes> zero_{};  ///< true counts at the last set-up, by channel
    std::array<std::optional<double>, kMaxAxes> stuck_{};  ///< rad that unplugged encoders say
    std::deque<Letter> letters_{};
};

}  // namespace palpate::engine
