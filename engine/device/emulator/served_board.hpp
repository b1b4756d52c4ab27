#pragma once

#include <cmath>
#include <cstdint>
#include <string>

#include <netinet/in.h>

#include "engine/base/clock.hpp"
#include "engine/base/descriptor.hpp"
#include "engine/device/emulator/open_board.hpp"
#include "engine/device/emulator/port_board.hpp"
#include "engine/device/open/open_wire.hpp"

namespace palpate::engine {

/// Keeps a board in memory up with the wall's clock.
class BoardPace {
public:
    /// A board that was kept from running for longer (a stopped process) has not lived meanwhile.
    static constexpr double kLongestGap = 0.05;  ///< s

    /// @param board  outlives this; its time goes on from now
    explicit BoardPace(PortBoard& board)
        : board_(&board),
          start_ns_(monotonic_ns() - static_cast<std::int64_t>(board.time() * 1e9)) {}

    /// The board lives up to now.
    void catch_up() {
        const double now = static_cast<double>(monotonic_ns() - start_ns_) * 1e-9;
        const double gap = now - board_->time() - kLongestGap;
        if (gap > 0.0) {
            start_ns_ += static_cast<std::int64_t>(gap * 1e9);
        }
        while (board_->time() + PortBoard::kPollPeriod <= now - std::fmax(gap, 0.0)) {
            board_->pass();
        }
    }

private:
    PortBoard* board_;
    std::int64_t start_ns_;  ///< when the board's time was 0
};

/// A board behind a pseudo-terminal, in real time. Its bytes arrive as USB brings them: a packet
/// that the host wrote in one piece is one piece here.
class PtyBoard {
public:
    /// @param board  outlives this
    /// @param link   a symbolic link to the terminal, made anew at every plug(true) in place of an
    ///               older link, never of a file; empty: none
    /// @throws std::runtime_error if the system gives no terminal or the link cannot be made
    PtyBoard(PortBoard& board, std::string link);
    ~PtyBoard();

    /// Where the host opens it: the link, or the terminal itself.
    [[nodiscard]] std::string path() const { return link_.empty() ? terminal_ : link_; }
    /// Lets the board live up to now, after waiting at most `wait_us` for bytes.
    void step(int wait_us);
    /// Pulls the plug (the board loses its power, the host its terminal) or puts it in again.
    void plug(bool in);
    [[nodiscard]] bool plugged() const noexcept { return master_.get() >= 0; }

private:
    void open();
    void close() noexcept;

    PortBoard* board_;
    std::string link_;
    std::string terminal_;
    Descriptor master_{};
    Descriptor slave_{};  ///< held open: without a host the master would report a hang-up for ever
    BoardPace pace_;
};

/// An open board behind a UDP port of this machine, in real time: see board_datagram().
class UdpBoard {
public:
    /// @param board  outlives this
    /// @param port   0: any that is free
    /// @throws std::runtime_error if the port is taken
    UdpBoard(OpenBoard& board, std::uint16_t port);

    /// As --device has it behind "board:", "udp:127.0.0.1:5000".
    [[nodiscard]] std::string path() const;
    /// Lets the board live up to now, after waiting at most `wait_us` for a datagram.
    void step(int wait_us);

private:
    void take();
    void answer();

    OpenBoard* board_;
    BoardPace pace_;
    std::uint16_t port_ = 0;
    Descriptor socket_;
};

}  // namespace palpate::engine
