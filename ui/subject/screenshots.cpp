#include "ui/subject/screenshots.hpp"

#include <cstdlib>

#include "ui/subject/faces.hpp"
#include "ui/subject/stage.hpp"

namespace palpate::ui {

std::vector<std::string> write_screenshots(const std::string& directory,
                                           std::span<const protocols::Picture> pictures,
                                           const WindowOptions& options) {
    setenv("SDL_VIDEODRIVER", "dummy", 1);
    Stage stage(options, "", {});
    std::vector<std::string> files;
    const auto take = [&](const std::string& name, auto face) {
        stage.show([face](Window& window) { draw(window, face); });
        files.push_back(directory + "/" + name + ".png");
        stage.window().save_png(files.back());
    };
    take("welcome", WelcomeFace{.trials = 114});
    take("ready", ReadyFace{.number = 27, .total = 114});
    take("ready_hold", ReadyFace{.number = 27, .total = 114, .dead_man = true});
    take("explore", ExploreFace{.number = 27, .total = 114, .may_finish = true});
    take("explore_hold",
         ExploreFace{.number = 27, .total = 114, .may_finish = true, .dead_man = true});
    take("choose", ChooseFace{.pictures = pictures, .selected = std::size_t{1}});
    take("break", BreakFace{.seconds_left = 18, .next = 31, .total = 114});
    take("trouble",
         TroubleFace{.sentence = "the device stopped answering: check its cable and power"});
    take("trouble_solved",
         TroubleFace{.sentence = "the handle was faster than the limit: move more slowly",
                     .solved = true});
    take("end", EndFace{});
    return files;
}

}  // namespace palpate::ui
