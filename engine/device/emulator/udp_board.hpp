#pragma once

#include <cstdint>
#include <string>

#include <netinet/in.h>

#include "engine/device/emulator/board_pace.hpp"
#include "engine/device/emulator/open_board.hpp"
#include "engine/device/open/open_wire.hpp"

namespace palpate::engine {

/// An open board behind a UDP port of this machine, in real time: see board_datagram().
class UdpBoard {
public:
    /// @param board  outlives this
    /// @param port   0: any that is free
    /// @throws std::runtime_error if the port is taken
    UdpBoard(OpenBoard& board, std::uint16_t port);
    UdpBoard(const UdpBoard&) = delete;
    UdpBoard& operator=(const UdpBoard&) = delete;
    ~UdpBoard();

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
    int socket_ = -1;
};

}  // namespace palpate::engine
