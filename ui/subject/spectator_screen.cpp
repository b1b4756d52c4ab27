#include <algorithm>

#include "ui/subject/subject_screen.hpp"

namespace palpate::ui {
namespace {

using protocols::Choice;
using protocols::ExplorationStep;
using protocols::Signal;

/// How long each screen stays for those who look on, s.
constexpr double kLook = 0.6;
/// Longest gap and break, s: nobody needs to rest.
constexpr double kLongestPause = 0.5;

Signal or_abort(bool aborted, Signal signal) {
    return aborted ? Signal::abort : signal;
}

/// A window onto a simulated session: another observer answers, people look on. Shows what a
/// participant would see, at a pace that can be followed.
class SpectatorScreen : public protocols::Observer {
public:
    SpectatorScreen(protocols::Observer& observer, const SubjectScreenOptions& options)
        : observer_(observer), asks_(options.asks), stage_(options) {}

    [[nodiscard]] Signal welcome(const protocols::SessionView& session) override {
        stage_.show(WelcomeFace{.trials = session.trials - session.next - session.practice,
                                .practice = session.practice,
                                .resumed = session.next > 0,
                                .breaks = session.breaks,
                                .asks = asks_});
        return or_abort(stage_.wait_or_abort(3.0 * kLook), observer_.welcome(session));
    }

    [[nodiscard]] Signal ready(const protocols::TrialView& trial) override {
        exploring_.reset();
        in_trouble_.reset();
        stage_.show(ReadyFace{.number = trial.number,
                              .total = trial.total,
                              .practice = trial.practice,
                              .interval = trial.interval,
                              .intervals = trial.intervals});
        return or_abort(stage_.wait_or_abort(kLook), observer_.ready(trial));
    }

    [[nodiscard]] ExplorationStep explore(const protocols::TrialView& trial,
                                          double elapsed_s) override {
        const ExploreFace face = explore_face(trial, elapsed_s, asks_);
        if (exploring_ != face) {
            exploring_ = face;
            stage_.show(face);
        }
        return stage_.next(0).kind == Input::Kind::abort ? ExplorationStep{.signal = Signal::abort}
                                                         : observer_.explore(trial, elapsed_s);
    }

    [[nodiscard]] Choice choose(const protocols::TrialView& trial,
                                const protocols::Question& question) override {
        stage_.show(ChooseFace{.question = question, .selected = {}, .watched = true});
        bool stopped = stage_.wait_or_abort(2.0 * kLook);
        const Choice choice = observer_.choose(trial, question);
        stage_.show(ChooseFace{.question = question, .selected = choice.place, .watched = true});
        stopped = stopped || stage_.wait_or_abort(1.5 * kLook);
        if (choice.confidence) {
            stage_.show(
                ConfidenceFace{.selected = static_cast<std::size_t>(*choice.confidence - 1)});
            stopped = stopped || stage_.wait_or_abort(kLook);
        }
        return stopped ? Choice{.signal = Signal::abort} : choice;
    }

    [[nodiscard]] Signal feedback(const protocols::TrialView& trial, bool correct) override {
        stage_.show(FeedbackFace{correct});
        return or_abort(stage_.wait_or_abort(kLook), observer_.feedback(trial, correct));
    }

    [[nodiscard]] Signal gap(double seconds) override {
        stage_.show(GapFace{});
        return or_abort(stage_.wait_or_abort(std::min(seconds, kLongestPause)),
                        observer_.gap(seconds));
    }

    [[nodiscard]] Signal rest(double seconds, const protocols::TrialView& next) override {
        stage_.show(BreakFace{0, next.number, next.total, next.practice});
        return or_abort(stage_.wait_or_abort(std::min(seconds, kLongestPause)),
                        observer_.rest(seconds, next));
    }

    [[nodiscard]] Signal pause(const protocols::TrialView& /*next*/) override {
        return or_abort(stage_.pause_or_abort(), Signal::go_on);
    }

    [[nodiscard]] std::optional<Signal> trouble(const protocols::TroubleView& view) override {
        TroubleFace face{.sentence = view.sentence, .solved = view.solved, .by_chord = false};
        if (in_trouble_ != face) {
            stage_.show(face);
            in_trouble_ = std::move(face);
        }
        if (stage_.wait_or_abort(view.solved ? 3.0 * kLook : 0.0)) {
            return Signal::abort;
        }
        return stage_.next(0).kind == Input::Kind::abort ? Signal::abort : observer_.trouble(view);
    }

    void finish(const protocols::SessionView& session) override {
        observer_.finish(session);
        stage_.close_desk();
        stage_.show(EndFace{});
        static_cast<void>(stage_.wait_or_abort(3.0 * kLook));
    }
    void feel(std::span<const engine::TickRecord> ticks) override { observer_.feel(ticks); }

private:
    protocols::Observer& observer_;
    protocols::ResponseKind asks_;
    Stage stage_;
    std::optional<ExploreFace> exploring_;
    std::optional<TroubleFace> in_trouble_;
};

}  // namespace

std::unique_ptr<protocols::Observer> spectator_screen(protocols::Observer& observer,
                                                      const SubjectScreenOptions& options) {
    return std::make_unique<SpectatorScreen>(observer, options);
}

}  // namespace palpate::ui
