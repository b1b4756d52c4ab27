#include <cstdio>
#include <stdexcept>

#include <fmt/format.h>

#include "engine/device/emulator/desk_hand.hpp"
#include "engine/device/emulator/emulated_board.hpp"
#include "engine/device/emulator/pty_board.hpp"
#include "protocols/file/calibration_file.hpp"
#include "ui/cli/commands.hpp"
#include "ui/rig/interrupt.hpp"

namespace palpate::ui {
namespace {

constexpr int kStepUs = 250;
constexpr int kDelayStepUs = 50;  ///< a delayed answer goes out at the end of a step

}  // namespace

int emulator_command(const EmulatorOptions& options) {
    const engine::Calibration machine = protocols::load_calibration(options.preset);
    if (!machine.haply) {
        throw std::invalid_argument(fmt::format(
            "--preset {}: this machine has no Haply board; give 2diy_gen3, 2diy_gen2 or "
            "haplet",
            options.preset));
    }
    engine::DeskHand hand(machine);
    engine::HaplyBoard board(hand, machine.pantograph, *machine.haply);
    board.set_faults({.delay = 1e-3 * options.delay_ms});
    catch_signals();
    engine::run_like_a_board();
    engine::PtyBoard terminal(board, options.link);
    fmt::print("{}\n", terminal.path());
    std::fflush(stdout);
    while (!interrupted()) {
        terminal.step(options.delay_ms > 0.0 ? kDelayStepUs : kStepUs);
    }
    return 0;
}

}  // namespace palpate::ui
