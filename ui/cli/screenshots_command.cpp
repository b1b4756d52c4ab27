#include <filesystem>

#include <fmt/format.h>

#include "engine/base/files.hpp"
#include "protocols/design/session_plan.hpp"
#include "ui/command/command.hpp"
#include "ui/rig/say.hpp"
#include "ui/session/load_study.hpp"
#include "ui/subject/screenshots.hpp"

namespace palpate::ui {
namespace {

struct ScreenshotOptions {
    std::string protocol = "shape_friction";  ///< a file or a shipped one
    std::string directory = ".";
    std::string language = "en";  ///< en, tr
    int width = 1280;             ///< pixels
    int height = 800;
    std::string font;
};

void declare(CommandWords& words, ScreenshotOptions& options) {
    words.add("-o,--output", options.directory, "Folder for the pictures").with_default();
    words.add("--protocol", options.protocol, "Whose screens: a protocol file or a shipped one")
        .with_default();
    words.add("--width", options.width, "Of the pictures, pixels").within(480, 7680).with_default();
    words.add("--height", options.height, "Of the pictures, pixels")
        .within(480, 7680)
        .with_default();
    words.add("--font", options.font, "A TrueType font");
    words.add("--language", options.language, "Of the sentences: en or tr")
        .among({"en", "tr"})
        .with_default();
}

int run(const ScreenshotOptions& options) {
    const Study study = load_study(options.protocol);
    const protocols::Plan plan =
        make_plan(study.protocol, study.hash, {"P1", 1}, study.protocol.seed);
    const auto language =
        options.language == "tr" ? protocols::Language::tr : protocols::Language::en;
    make_folder(options.directory);
    for (const std::string& file : write_screenshots(
             options.directory, study.protocol, plan,
             {.width = options.width,
             .height = options.height,
             .font = options.font,
             .language = language,
             .instructions = study.protocol.instructions.at(static_cast<std::size_t>(language))})) {
        say("{}\n", file);
    }
    return 0;
}

}  // namespace

Command screenshots_command() {
    return make_command<ScreenshotOptions>(
        "screenshots",
        "Write a picture of every subject screen that a session of a protocol can show (PNG)",
        declare, run);
}

}  // namespace palpate::ui
