#include <algorithm>
#include <filesystem>
#include <iterator>
#include <vector>

#include <fmt/format.h>

#include "engine/base/files.hpp"
#include "data/report/figure_list.hpp"
#include "ui/command/command.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {
namespace {

struct FigureOptions {
    std::string directory = "figures";  ///< made if it is not there
};

void declare(CommandWords& words, FigureOptions& options) {
    words.add("-o,--output", options.directory, "Folder for the files; made if not there")
        .with_default();
}

int run(const FigureOptions& options) {
    const std::filesystem::path directory(options.directory);
    make_folder(directory);
    std::vector<data::FigureFile> files;
    for (const data::NamedFigure& figure : data::thesis_figures()) {
        std::ranges::move(data::files_of(figure), std::back_inserter(files));
    }
    for (const data::FigureFile& file : files) {  // all of them, or none
        require_writable(directory / file.name, file.text);
    }
    for (const data::FigureFile& file : files) {
        const std::filesystem::path path = directory / file.name;
        write_whole(path, file.text);
        say("{}\n", path.string());
    }
    return 0;
}

}  // namespace

Command figures_command() {
    return make_command<FigureOptions>(
        "figures", "Compute the thesis' figures: SVG pictures and CSV tables", declare, run);
}

}  // namespace palpate::ui
