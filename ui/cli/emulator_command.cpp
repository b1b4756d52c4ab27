#include <cstdio>
#include <stdexcept>

#include <fmt/format.h>

#include "engine/device/emulator/desk_hand.hpp"
#include "engine/device/emulator/emulated_board.hpp"
#include "engine/device/emulator/pty_board.hpp"
#include "protocols/file/calibration_file.hpp"
#include "ui/command/command.hpp"
#include "ui/rig/interrupt.hpp"

namespace palpate::ui {
namespace {

struct EmulatorOptions {
    std::string link;                  ///< a symbolic link to the terminal; empty: none
    std::string preset = "2diy_gen3";  ///< a calibration file, or the name of a shipped machine
    double delay_ms = 0.0;             ///< from a packet to its answer
};

constexpr int kStepUs = 250;
constexpr int kDelayStepUs = 50;  ///< a delayed answer goes out at the end of a step

void declare(CommandWords& words, EmulatorOptions& options) {
    words.add("--link", options.link, "A symbolic link to its terminal, for --device haply:LINK");
    words.add("--preset", options.preset, "2diy_gen3, 2diy_gen2, haplet, or a calibration file")
        .with_default();
    words
        .add("--delay-ms", options.delay_ms,
             "How long after a packet its answer goes out, ms; a USB port needs about 1")
        .within(0.0, 1000.0)
        .with_default();
}

int run(const EmulatorOptions& options) {
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

}  // namespace

Command emulator_command() {
    return make_command<EmulatorOptions>(
        "haply-emulator", "A Haply board that is not there, on a pseudo-terminal, until Ctrl-C",
        declare, run);
}

}  // namespace palpate::ui
