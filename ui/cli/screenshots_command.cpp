#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "engine/base/files.hpp"
#include "protocols/design/adaptive_plan.hpp"
#include "protocols/design/plan.hpp"
#include "protocols/design/session_plan.hpp"
#include "protocols/protocol/protocol.hpp"
#include "protocols/session/progress.hpp"
#include "protocols/trial/trial_scene.hpp"
#include "ui/command/command.hpp"
#include "ui/rig/say.hpp"
#include "ui/session/load_study.hpp"
#include "ui/subject/font.hpp"
#include "ui/subject/stage.hpp"
#include "ui/subject/window.hpp"

namespace palpate::ui {
namespace {

/// Draws every subject screen that a session of the protocol can show off any display, with its
/// own question, hints and counts, and writes each as a PNG file into a folder that is there.
class Album {
public:
    Album(const std::string& directory,
          const protocols::Protocol& protocol,
          const protocols::Plan& plan,
          const WindowOptions& options)
        : directory_(directory),
          protocol_(protocol),
          stage_({.window = options}),
          pictures_(make_pictures(protocol, plan.picture_order)),
          intervals_(intervals_of(protocol)) {
        const protocols::PendingTrials all(plan);
        practice_ = all.left(true);
        trials_ = all.left(false);
        number_ = std::max<std::size_t>(1, trials_ / 4);
        by_pointer_ = protocol.apparatus.device == protocols::DeviceClass::mouse;
        breaks_ = std::ranges::any_of(plan.trials, &protocols::PlannedTrial::break_before);
    }

    std::vector<std::string> take_all() {
        take("welcome", WelcomeFace{.trials = trials_,
                                    .practice = practice_,
                                    .breaks = breaks_,
                                    .moves_pointer = by_pointer_,
                                    .asks = protocol_.response.kind});
        feeling();
        asking();
        take("pause", PauseFace{});
        trouble();
        take("end", EndFace{});
        return files_;
    }

private:
    template <class Face>
    void take(const std::string& name, const Face& face) {
        stage_.show(face);
        files_.push_back(directory_ + "/" + name + ".png");
        require_writable(files_.back(), "\x89PNG\r\n");
        stage_.window().save_png(files_.back());
    }

    void feeling() {
        const bool hold = protocol_.safety.dead_man;
        ReadyFace ready{
            .number = number_, .total = trials_, .dead_man = hold, .intervals = intervals_};
        take("ready", ready);
        if (protocol_.apparatus.start_radius > 0.0 && !by_pointer_) {  // it is put at the start
            ready.start = StartMark{.away = {0.012, 0.021, 0.008},
                                    .radius = protocol_.apparatus.start_radius,
                                    .in_space = protocol_.surface.has_value(),
                                    .open = false};
            take("ready_away", ready);
        }
        take("explore", ExploreFace{.number = number_,
                                    .total = trials_,
                                    .may_finish = true,
                                    .dead_man = hold,
                                    .interval = intervals_,
                                    .intervals = intervals_,
                                    .asks_shape = protocol_.response.kind ==
                                                  protocols::ResponseKind::identification});
    }

    void asking() {
        const protocols::Question question = question_of(protocol_, pictures_);
        take("choose", ChooseFace{.question = question, .selected = std::size_t{1}});
        if (question.confidence) {
            take("confidence",
                 ConfidenceFace{.selected = std::size_t{1}, .confirm = question.confirm});
        }
        if (protocol_.response.feedback != protocols::Feedback::none) {
            take("feedback_right", FeedbackFace{true});
            take("feedback_wrong", FeedbackFace{false});
        }
        if (breaks_) {
            take("break", BreakFace{.seconds_left = static_cast<int>(
                                        std::ceil(0.6 * protocol_.timing.break_min)),
                                    .next = number_ + 1,
                                    .total = trials_});
        }
    }

    void trouble() {
        const auto say = [&](const std::string& name, engine::Trip trip, bool solved) {
            take(name, TroubleFace{.sentence = std::string(explanation(trip)),
                                   .solved = solved,
                                   .by_chord = trip == engine::Trip::stopped});
        };
        say("trouble", engine::Trip::device_silent, false);
        say("trouble_solved", engine::Trip::over_speed, true);
        say("stopped", engine::Trip::stopped, true);
    }

    const std::string& directory_;
    const protocols::Protocol& protocol_;
    Stage stage_;
    std::vector<protocols::Picture> pictures_;
    std::size_t intervals_;
    std::size_t practice_ = 0;
    std::size_t trials_ = 0;  ///< main and catch trials
    std::size_t number_ = 1;
    bool breaks_ = false;
    bool by_pointer_ = false;
    std::vector<std::string> files_;
};

struct ScreenshotOptions {
    std::string protocol = "shape_friction";  ///< a file or a shipped one
    std::string directory = ".";
    std::string language;  ///< en, tr; empty: the protocol's
    int width = 1280;      ///< pixels
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
    words
        .add("--language", options.language,
             "Of the sentences: en or tr; without it the protocol's")
        .among({"en", "tr"});
}

int run(const ScreenshotOptions& options) {
    const Study study = load_study(options.protocol);
    const protocols::Plan plan =
        make_plan(study.protocol, study.hash, {"P1", 1}, study.protocol.seed);
    const auto language = options.language.empty() ? study.protocol.language
                        : options.language == "tr" ? protocols::Language::tr
                                                   : protocols::Language::en;
    static_cast<void>(find_font(options.font));
    make_folder(options.directory);
    setenv("SDL_VIDEODRIVER", "dummy", 1);
    Album album(
        options.directory, study.protocol, plan,
        {.width = options.width,
         .height = options.height,
         .font = options.font,
         .language = language,
         .instructions = study.protocol.instructions.at(static_cast<std::size_t>(language))});
    for (const std::string& file : album.take_all()) {
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
