#include <filesystem>

#include <fmt/format.h>

#include "engine/base/files.hpp"
#include "data/report/figure_list.hpp"
#include "ui/cli/commands.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {

int figures_command(const FigureOptions& options) {
    const std::filesystem::path directory(options.directory);
    make_folder(directory);
    for (const data::NamedFigure& figure : data::thesis_figures()) {
        for (const data::FigureFile& file : data::files_of(figure)) {
            const std::filesystem::path path = directory / file.name;
            write_whole(path, file.text);
            say("{}\n", path.string());
        }
    }
    return 0;
}

}  // namespace palpate::ui
