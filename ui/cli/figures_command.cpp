#include <cerrno>
#include <cstring>

#include <unistd.h>

#include "ui/command/command.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {
namespace {

struct FigureOptions {
    std::string directory = "figures";  ///< made if it is not there
};

void declare(CommandWords& words, FigureOptions& options) {
    words.add("-o,--output", options.directory, "Folder for the files; made if not there");
}

/// A program of its own computes them, in the place of this one.
int run(const FigureOptions& options) {
    const std::string program = beside_program("palpate-figures", "palpate_figures").string();
    execl(program.c_str(), program.c_str(), options.directory.c_str(), nullptr);
    warn("{}: cannot be started: {}", program, std::strerror(errno));
    return kExitFailure;
}

}  // namespace

Command figures_command() {
    return make_command<FigureOptions>(
        "figures", "Compute the thesis' figures: SVG pictures and CSV tables", declare, run);
}

}  // namespace palpate::ui
