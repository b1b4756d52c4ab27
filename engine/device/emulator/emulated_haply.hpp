#pragma once

#include <memory>
#include <string>

#include "engine/device/drivers/board_device.hpp"
#include "engine/device/drivers/guard_process.hpp"
#include "engine/device/emulator/emulated_board.hpp"

namespace palpate::engine {

/// A port, its driver and its guard: what `--device haply:PATH` is.
/// @throws as BoardDevice
[[nodiscard]] std::unique_ptr<BoardDevice> open_haply(const std::string& path,
                                                      const Calibration& calibration,
                                                      const BoardTiming& timing = {},
                                                      const GuardTiming& guard = {});

/// The same of an open board: what `--device board:PATH` is.
[[nodiscard]] std::unique_ptr<BoardDevice> open_board(const std::string& path,
                                                      const Calibration& calibration,
                                                      const BoardTiming& timing = {},
                                                      const GuardTiming& guard = {});

/// An emulated board with a simulated hand on it, and the driver that speaks to it over a real
/// port: two processes beside this one, board and guard. Make it before threads.
class EmulatedHaply {
public:
    /// @param hand  makes the plant in the board's process; its linkage and frame are those of
    ///              `calibration`
    /// @param link  see PtyBoard; needed to unplug the board
    EmulatedHaply(const Calibration& calibration,
                  const MakeHand& hand,
                  const BoardTiming& timing = {},
                  const GuardTiming& guard = {},
                  const std::string& link = {})
        : board_(calibration, hand, link),
          device_(open_haply(board_.path(), calibration, timing, guard)) {}

    /// Before a trial: the handle is at the start, and the hand sets off.
    /// @throws std::invalid_argument if the start is out of reach
    void begin(const Exploration& plan) {
        board_.begin(plan);
        device_->expect_move();
    }
    [[nodiscard]] bool hand_is_done() const noexcept { return board_.hand_is_done(); }
    [[nodiscard]] BoardDevice& device() noexcept { return *device_; }
    [[nodiscard]] const BoardDevice& device() const noexcept { return *device_; }
    [[nodiscard]] EmulatedBoard& board() noexcept { return board_; }

private:
    EmulatedBoard board_;
    std::unique_ptr<BoardDevice> device_;
};

}  // namespace palpate::engine
