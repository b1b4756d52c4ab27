#pragma once

#include <cstdint>
#include <vector>

#include "engine/device/drivers/board_device.hpp"
#include "engine/device/emulator/port_board.hpp"

namespace palpate::tests {

/// A guard that only says what it is given to say, and counts what it hears.
class ScriptedGuard : public engine::MotorGuard {
public:
    struct Script {
        bool there = true;  ///< watch() works
        bool alive = true;
        bool tripped = false;
        bool force = false;    ///< what the driver said last
        bool repeats = false;  ///< zeros
        int watches = 0;
        int releases = 0;
        std::vector<std::uint8_t> zero{};  ///< the packet that switches the motors off
    };

    explicit ScriptedGuard(Script& script) : script_(&script) {}

    [[nodiscard]] bool watch(int /*port*/, const engine::GuardPackets& packets) override {
        ++script_->watches;
        const auto zero = packets.zero.view();
        script_->zero.assign(zero.begin(), zero.end());
        script_->tripped = false;
        script_->alive = script_->alive || script_->there;
        return script_->there;
    }
    void release() noexcept override { ++script_->releases; }
    void force_on() noexcept override { script_->force = true; }
    void force_off() noexcept override { script_->force = false; }
    void repeat_zeros(bool on) noexcept override { script_->repeats = on; }
    [[nodiscard]] bool alive() const noexcept override { return script_->alive; }
    [[nodiscard]] bool tripped() const noexcept override { return script_->tripped; }

private:
    Script* script_;
};

/// The cable to a board in memory, and the clock that both ends live on: time passes only where the
/// driver waits and where pass() says so. It remembers every packet.
class BoardCable {
public:
    using Packet = std::vector<std::uint8_t>;

    /// @param board  outlives the cable
    explicit BoardCable(engine::PortBoard& board) : board_(&board) {}

    void pass(std::int64_t ns);
    /// Pulls the plug, which takes the board's power, or puts it in again.
    void plug(bool in);
    /// Of the next packet only so many bytes go out.
    void cut_next(std::size_t bytes) { cut_ = bytes; }

    /// Of the next packet's first byte these bits are wrong.
    void spoil_next(std::uint8_t bits) { spoilt_ = bits; }

    [[nodiscard]] bool plugged() const noexcept { return plugged_; }
    /// How often the plug was pulled: a link opened before is dead.
    [[nodiscard]] int pulls() const noexcept { return pulls_; }
    [[nodiscard]] std::int64_t now_ns() const noexcept { return now_ns_; }
    /// Everything that was sent to a board that was there; an empty packet where it lost its power.
    [[nodiscard]] const std::vector<Packet>& sent() const noexcept { return sent_; }

    /// @return false if it went out short
    bool send(std::span<const std::uint8_t> packet);
    [[nodiscard]] std::size_t receive(std::span<std::uint8_t> into) {
        return board_->transmit(into);
    }

private:
    engine::PortBoard* board_;
    std::int64_t now_ns_ = 0;
    std::int64_t polled_ns_ = 0;
    bool plugged_ = true;
    int pulls_ = 0;
    std::optional<std::size_t> cut_{};
    std::uint8_t spoilt_ = 0;
    std::vector<Packet> sent_;
};

/// The driver's end of such a cable.
class BoardLink : public engine::ByteLink {
public:
    /// @param cable  outlives the link
    explicit BoardLink(BoardCable& cable) : cable_(&cable) {}

    [[nodiscard]] bool send(std::span<const std::uint8_t> packet) noexcept override;
    [[nodiscard]] std::ptrdiff_t receive(std::span<std::uint8_t> into,
                                         std::int64_t wait_ns) noexcept override;
    void drain() noexcept override;
    void pause(std::int64_t ns) noexcept override { cable_->pass(ns); }
    [[nodiscard]] std::int64_t now_ns() const noexcept override { return cable_->now_ns(); }
    [[nodiscard]] bool reopen() override;
    void close() noexcept override { opened_ = -1; }
    [[nodiscard]] std::string trouble() const override;
    [[nodiscard]] std::string name() const override { return "the end of a cable"; }

private:
    [[nodiscard]] bool open() const noexcept {
        return cable_->plugged() && opened_ == cable_->pulls();
    }

    BoardCable* cable_;
    int opened_ = -1;  ///< pulls of the plug when it was opened
};

/// A board in memory, its driver, and the clock that both live on.
class BoardDesk {
public:
    /// @param board  outlives the desk; need not live yet
    BoardDesk(engine::PortBoard& board, engine::MakeLine line) : cable(board), line_(line) {}

    /// @throws std::runtime_error as the driver does
    void open(const engine::Calibration& machine, const engine::BoardTiming& timing = {});
    /// To the next millisecond of a servo, and a tenth of one at least.
    void pass_tick();
    engine::Reading tick(const engine::Vec2& force);
    /// @return the last of so many
    engine::Reading ticks(const engine::Vec2& force, int number);

    BoardCable cable;
    ScriptedGuard::Script guard;
    std::unique_ptr<engine::BoardDevice> device;

private:
    engine::MakeLine line_;
    std::int64_t next_ = 0;  ///< deadline, ns
};

}  // namespace palpate::tests
