#pragma once

#include <cmath>

#include "engine/base/clock.hpp"
#include "engine/device/emulator/port_board.hpp"

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

}  // namespace palpate::engine
