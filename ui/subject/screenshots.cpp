#include "ui/subject/screenshots.hpp"

#include <cstdlib>

#include "engine/base/files.hpp"
#include "engine/safety/trip.hpp"
#include "ui/subject/stage.hpp"

namespace palpate::ui {

std::vector<std::string> write_screenshots(const std::string& directory,
                                           std::span<const protocols::Picture> pictures,
                                           const WindowOptions& options) {
    setenv("SDL_VIDEODRIVER", "dummy", 1);
    Stage stage(options, "", {});
    std::vector<std::string> files;
    const auto take = [&](const std::string& name, auto face) {
        stage.show(face);
        files.push_back(directory + "/" + name + ".png");
        require_writable(files.back(), "\x89PNG\r\n");
        stage.window().save_png(files.back());
    };
    take("welcome", WelcomeFace{.trials = 114});
    take("ready", ReadyFace{.number = 27, .total = 114});
    take("ready_hold", ReadyFace{.number = 27, .total = 114, .dead_man = true});
    take("explore", ExploreFace{.number = 27, .total = 114, .may_finish = true});
    take("explore_hold",
         ExploreFace{.number = 27, .total = 114, .may_finish = true, .dead_man = true});
    using protocols::Question;
    using protocols::ResponseKind;
    const std::size_t second = 1;
    const auto ask = [&](const std::string& name, const Question& question) {
        take(name, ChooseFace{.question = question, .selected = second});
    };
    ask("choose", which_of(pictures));
    take("welcome_two", WelcomeFace{.trials = 96, .asks = ResponseKind::two_interval});
    take("ready_two", ReadyFace{.number = 27, .total = 114, .interval = 1, .intervals = 2});
    take("explore_two", ExploreFace{.number = 27,
                                    .total = 114,
                                    .may_finish = true,
                                    .interval = 2,
                                    .intervals = 2,
                                    .asks_shape = false});
    const bool turkish = options.language == protocols::Language::tr;
    const auto ask_for = [&](const std::string& name, ResponseKind kind, std::size_t answers,
                             const char* text) {
        ask(name, {.kind = kind, .text = text, .pictures = {}, .answers = answers, .labels = {}});
    };
    ask_for("choose_two", ResponseKind::two_interval, 2, "");
    ask_for("choose_yes_no", ResponseKind::yes_no, 2,
            turkish ? "Yüzey elinizi tuttu mu?" : "Did the surface hold you back?");
    ask_for("choose_rating", ResponseKind::rating, 7,
            turkish ? "Yüzey ne kadar pürüzlüydü?" : "How rough was the surface?");
    take("confidence", ConfidenceFace{.selected = second});
    take("feedback_right", FeedbackFace{true});
    take("feedback_wrong", FeedbackFace{false});
    take("break", BreakFace{.seconds_left = 18, .next = 31, .total = 114});
    take("pause", PauseFace{});
    take("trouble",
         TroubleFace{.sentence = "the device stopped answering: check its cable and power",
                     .solved = false,
                     .by_chord = false});
    take("trouble_solved",
         TroubleFace{.sentence = "the handle was faster than the limit: move more slowly",
                     .solved = true,
                     .by_chord = false});
    take("stopped", TroubleFace{.sentence = std::string(explanation(engine::Trip::stopped)),
                                .solved = true,
                                .by_chord = true});
    take("end", EndFace{});
    return files;
}

}  // namespace palpate::ui
