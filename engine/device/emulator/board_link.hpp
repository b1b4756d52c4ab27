#pragma once

#include <vector>

#include "engine/device/drivers/byte_link.hpp"
#include "engine/device/emulator/haply_board.hpp"

namespace palpate::engine {

/// A board in memory behind the driver's seam, on a virtual clock: time passes only where the driver
/// waits, and where pass() says so. It remembers every packet.
class BoardLink : public ByteLink {
public:
    /// @param board  outlives the link
    explicit BoardLink(HaplyBoard& board) : board_(&board) {}

    [[nodiscard]] bool send(std::span<const std::uint8_t> packet) noexcept override;
    [[nodiscard]] std::ptrdiff_t receive(std::span<std::uint8_t> into,
                                         std::int64_t wait_ns) noexcept override;
    void drain() noexcept override;
    void pause(std::int64_t ns) noexcept override { pass(ns); }
    [[nodiscard]] std::int64_t now_ns() const noexcept override { return now_ns_; }
    [[nodiscard]] bool reopen() override;
    void close() noexcept override { open_ = false; }
    [[nodiscard]] std::string trouble() const override { return open_ ? "" : "no board is there"; }
    [[nodiscard]] std::string name() const override { return "a board in memory"; }

    void pass(std::int64_t ns) noexcept;
    /// Pulls the plug, which takes the board's power, or puts it in again.
    void plug(bool in);
    /// The next packet goes out short after this many bytes.
    void cut_next(std::size_t bytes) { cut_ = static_cast<std::ptrdiff_t>(bytes); }

    /// Everything that was sent, packet by packet, to boards that were there.
    [[nodiscard]] const std::vector<std::vector<std::uint8_t>>& sent() const { return sent_; }

private:
    HaplyBoard* board_;
    std::int64_t now_ns_ = 0;
    std::int64_t polled_ns_ = 0;
    bool open_ = false;
    bool plugged_ = true;
    std::ptrdiff_t cut_ = -1;
    std::vector<std::vector<std::uint8_t>> sent_;
};

}  // namespace palpate::engine
