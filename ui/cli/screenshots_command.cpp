#include <filesystem>

#include <fmt/format.h>

#include "protocols/design/session_plan.hpp"
#include "protocols/running/trial_scene.hpp"
#include "ui/cli/commands.hpp"
#include "ui/cli/load_study.hpp"
#include "ui/subject/screenshots.hpp"

namespace palpate::ui {

int screenshots_command(const ScreenshotOptions& options) {
    const Study study = load_study("shape_friction");
    const auto pictures = make_pictures(study.protocol, objects_of(study.protocol, true));
    std::filesystem::create_directories(options.directory);
    for (const std::string& file :
         write_screenshots(options.directory, pictures,
                           {.font = options.font,
                           .language = options.language == "tr" ? protocols::Language::tr
                                                                : protocols::Language::en})) {
        fmt::print("{}\n", file);
    }
    return 0;
}

}  // namespace palpate::ui
