#pragma once

#include <string>

#include "engine/device/emulator/board_pace.hpp"
#include "engine/device/emulator/port_board.hpp"

namespace palpate::engine {

/// A board behind a pseudo-terminal, in real time. Its bytes arrive as USB brings them: a packet
/// that the host wrote in one piece is one piece here.
class PtyBoard {
public:
    /// @param board  outlives this
    /// @param link   a symbolic link to the terminal, made anew at every plug(true) in place of an
    ///               older link, never of a file; empty: none
    /// @throws std::runtime_error if the system gives no terminal or the link cannot be made
    PtyBoard(PortBoard& board, std::string link);
    PtyBoard(const PtyBoard&) = delete;
    PtyBoard& operator=(const PtyBoard&) = delete;
    ~PtyBoard();

    /// Where the host opens it: the link, or the terminal itself.
    [[nodiscard]] std::string path() const { return link_.empty() ? terminal_ : link_; }
    /// Lets the board live up to now, after waiting at most `wait_us` for bytes.
    void step(int wait_us);
    /// Pulls the plug (the board loses its power, the host its terminal) or puts it in again.
    void plug(bool in);
    [[nodiscard]] bool plugged() const noexcept { return master_ >= 0; }

private:
    void open();
    void close() noexcept;

    PortBoard* board_;
    std::string link_;
    std::string terminal_;
    int master_ = -1;
    int slave_ = -1;  ///< held open: without a host the master would report a hang-up for ever
    BoardPace pace_;
};

}  // namespace palpate::engine
