#include <filesystem>

#include <fmt/format.h>

#include "data/csv/whole_file.hpp"
#include "data/report/figures/figure_list.hpp"
#include "ui/cli/commands.hpp"
#include "ui/cli/say.hpp"

namespace palpate::ui {

int figures_command(const FigureOptions& options) {
    const std::filesystem::path directory(options.directory);
    data::make_folder(directory);
    for (const data::NamedFigure& figure : data::thesis_figures()) {
        for (const data::FigureFile& file : data::files_of(figure)) {
            const std::filesystem::path path = directory / file.name;
            data::write_whole(path, file.text);
            say("{}\n", path.string());
        }
    }
    return 0;
}

}  // namespace palpate::ui
