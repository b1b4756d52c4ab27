#pragma once

#include <memory>
#include <string_view>

#include "engine/device/drivers/guard_process.hpp"
#include "engine/device/drivers/haply_device.hpp"
#include "engine/device/emulator/emulated_board.hpp"

namespace palpate::engine {

/// A Haply machine that exists only here. Links, counts and wiring as its makers publish them
/// (HaplyHAPI README and examples); the object frame lies in the middle of the workspace: a 2DIY gives
/// 1.65 N or more in every direction for objects of +-40 mm by 0 to 40 mm, with the start above them at
/// (0, 60) mm, which is home.
/// @param preset  "gen3", "gen2" or "haplet"
/// @throws std::invalid_argument for another
[[nodiscard]] Calibration emulated_calibration(std::string_view preset = "gen3");

/// A port, its driver and its guard: what `--device haply:PATH` is.
/// @throws as HaplyDevice
[[nodiscard]] std::unique_ptr<HaplyDevice> open_haply(const std::string& path,
                                                      const Calibration& calibration,
                                                      const HaplyTiming& timing = {},
                                                      const GuardTiming& guard = {});

/// An emulated board with a simulated hand on it, and the driver that speaks to it over a real port:
/// two processes beside this one, board and guard. Make it before threads.
class EmulatedHaply {
public:
    /// @param hand  makes the plant in the board's process; its linkage and frame are those of
    ///              `calibration`
    EmulatedHaply(const Calibration& calibration,
                  const MakeHand& hand,
                  const HaplyTiming& timing = {},
                  const GuardTiming& guard = {})
        : board_(calibration, hand),
          device_(open_haply(board_.path(), calibration, timing, guard)) {}

    /// Before a trial: the handle is at the start, and the hand sets off.
    /// @throws std::invalid_argument if the start is out of reach
    void begin(const Exploration& plan) {
        board_.begin(plan);
        device_->expect_move();
    }
    [[nodiscard]] bool hand_is_done() const noexcept { return board_.hand_is_done(); }
    [[nodiscard]] HaplyDevice& device() noexcept { return *device_; }
    [[nodiscard]] const HaplyDevice& device() const noexcept { return *device_; }
    [[nodiscard]] EmulatedBoard& board() noexcept { return board_; }

private:
    EmulatedBoard board_;
    std::unique_ptr<HaplyDevice> device_;
};

}  // namespace palpate::engine
