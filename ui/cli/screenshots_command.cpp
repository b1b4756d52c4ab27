#include <filesystem>

#include <fmt/format.h>

#include "engine/base/files.hpp"
#include "protocols/design/session_plan.hpp"
#include "protocols/trial/trial_scene.hpp"
#include "ui/cli/commands.hpp"
#include "ui/cli/load_study.hpp"
#include "ui/rig/say.hpp"
#include "ui/subject/screenshots.hpp"

namespace palpate::ui {

int screenshots_command(const ScreenshotOptions& options) {
    const Study study = load_study(options.protocol);
    const auto pictures = make_pictures(study.protocol, objects_of(study.protocol, true));
    const auto language =
        options.language == "tr" ? protocols::Language::tr : protocols::Language::en;
    make_folder(options.directory);
    for (const std::string& file : write_screenshots(
             options.directory, pictures,
             {.width = options.width,
             .height = options.height,
             .font = options.font,
             .language = language,
             .instructions = study.protocol.instructions.at(static_cast<std::size_t>(language))})) {
        say("{}\n", file);
    }
    return 0;
}

}  // namespace palpate::ui
