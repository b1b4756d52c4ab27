#include <cstdio>
#include <stdexcept>

#include <fmt/format.h>

#include "engine/device/emulator/emulated_haply.hpp"
#include "engine/device/emulator/guided_hand.hpp"
#include "engine/device/emulator/pty_board.hpp"
#include "ui/cli/commands.hpp"
#include "ui/cli/interrupt.hpp"

namespace palpate::ui {
namespace {

/// After a set-up, which takes the pose for home, the handle rests for so long before the hand explores.
constexpr double kRest = 3.0;  // s
constexpr int kStepUs = 250;

}  // namespace

int emulator_command(const EmulatorOptions& options) {
    const engine::Calibration machine = engine::emulated_calibration(options.preset);
    engine::GuidedHand hand(machine);
    engine::HaplyBoard board(hand, machine.pantograph, *machine.haply);
    catch_signals();
    engine::PtyBoard terminal(board, options.link);
    fmt::print("{}\n", terminal.path());
    std::fflush(stdout);

    int setups = 0;
    double explore_at = 0.0;
    while (!interrupted()) {
        terminal.step(kStepUs);
        if (const int now = board.journal().setups; now != setups) {
            setups = now;
            hand.lead(*machine.home);
            explore_at = board.time() + kRest;
        }
        if (explore_at > 0.0 && board.time() >= explore_at) {
            explore_at = 0.0;
            hand.begin({});
        }
    }
    return 0;
}

}  // namespace palpate::ui
