#include "ui/subject/screenshots.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "engine/base/files.hpp"
#include "protocols/design/adaptive_plan.hpp"
#include "protocols/session/pending_trials.hpp"
#include "protocols/trial/trial_scene.hpp"
#include "ui/subject/stage.hpp"

namespace palpate::ui {
namespace {

/// A session's screens, one after the other.
class Album {
public:
    Album(const std::string& directory,
          const protocols::Protocol& protocol,
          const protocols::Plan& plan,
          const WindowOptions& options)
        : directory_(directory),
          protocol_(protocol),
          stage_(options, "", {}),
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

}  // namespace

std::vector<std::string> write_screenshots(const std::string& directory,
                                           const protocols::Protocol& protocol,
                                           const protocols::Plan& plan,
                                           const WindowOptions& options) {
    setenv("SDL_VIDEODRIVER", "dummy", 1);
    return Album(directory, protocol, plan, options).take_all();
}

}  // namespace palpate::ui
