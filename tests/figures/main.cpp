// palpate-figures FOLDER: what `palpate figures -o FOLDER` becomes.
#include "engine/base/files.hpp"
#include "ui/command/command.hpp"
#include "tests/figures/figure_list.hpp"

namespace {

using namespace palpate;

void write_figures(const std::filesystem::path& folder) {
    make_folder(folder);
    std::vector<figures::FigureFile> files;
    for (const figures::NamedFigure& figure : figures::thesis_figures()) {
        std::ranges::move(figures::files_of(figure), std::back_inserter(files));
    }
    for (const figures::FigureFile& file : files) {  // all of them, or none
        require_writable(folder / file.name, file.text);
    }
    for (const figures::FigureFile& file : files) {
        const std::filesystem::path path = folder / file.name;
        write_whole(path, file.text);
        ui::say("{}\n", path.string());
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        ui::warn("give the folder for the figures alone, or use palpate figures");
        return ui::kExitUsage;
    }
    try {
        write_figures(argv[1]);
        return ui::heard(0);
    } catch (const std::invalid_argument& e) {
        ui::warn("{}", e.what());
        return ui::kExitUsage;
    } catch (const std::exception& e) {
        ui::warn("{}", e.what());
        return ui::kExitFailure;
    }
}
