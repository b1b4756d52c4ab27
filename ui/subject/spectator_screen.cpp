#include "ui/subject/spectator_screen.hpp"

#include <algorithm>

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

}  // namespace

SpectatorScreen::SpectatorScreen(protocols::Observer& observer, const SubjectScreenOptions& options)
    : observer_(observer),
      asks_(options.asks),
      stage_(
          options.window, options.watermark, options.interrupted, options.desk, options.on_stop) {}

Signal SpectatorScreen::welcome(const protocols::SessionView& session) {
    stage_.show(WelcomeFace{.trials = session.trials - session.next - session.practice,
                            .practice = session.practice,
                            .resumed = session.next > 0,
                            .breaks = session.breaks,
                            .asks = asks_});
    return or_abort(stage_.wait_or_abort(3.0 * kLook), observer_.welcome(session));
}

Signal SpectatorScreen::ready(const protocols::TrialView& trial) {
    exploring_.reset();
    in_trouble_.reset();
    stage_.show(ReadyFace{.number = trial.number,
                          .total = trial.total,
                          .practice = trial.practice,
                          .interval = trial.interval,
                          .intervals = trial.intervals});
    return or_abort(stage_.wait_or_abort(kLook), observer_.ready(trial));
}

ExplorationStep SpectatorScreen::explore(const protocols::TrialView& trial, double elapsed_s) {
    const ExploreFace face{.number = trial.number,
                           .total = trial.total,
                           .practice = trial.practice,
                           .may_finish = elapsed_s >= trial.explore_min_s,
                           .prompt = elapsed_s >= trial.explore_prompt_s,
                           .dead_man = false,
                           .interval = trial.interval,
                           .intervals = trial.intervals,
                           .asks_shape = asks_ == protocols::ResponseKind::identification};
    if (exploring_ != face) {
        exploring_ = face;
        stage_.show(face);
    }
    return stage_.next(0).kind == Input::Kind::abort ? ExplorationStep{.signal = Signal::abort}
                                                     : observer_.explore(trial, elapsed_s);
}

Choice SpectatorScreen::choose(const protocols::TrialView& trial,
                               const protocols::Question& question) {
    stage_.show(ChooseFace{.question = question, .selected = {}, .watched = true});
    bool stopped = stage_.wait_or_abort(2.0 * kLook);
    const Choice choice = observer_.choose(trial, question);
    stage_.show(ChooseFace{.question = question, .selected = choice.place, .watched = true});
    stopped = stopped || stage_.wait_or_abort(1.5 * kLook);
    if (choice.confidence) {
        stage_.show(ConfidenceFace{.selected = static_cast<std::size_t>(*choice.confidence - 1)});
        stopped = stopped || stage_.wait_or_abort(kLook);
    }
    return stopped ? Choice{.signal = Signal::abort} : choice;
}

Signal SpectatorScreen::feedback(const protocols::TrialView& trial, bool correct) {
    stage_.show(FeedbackFace{correct});
    return or_abort(stage_.wait_or_abort(kLook), observer_.feedback(trial, correct));
}

Signal SpectatorScreen::gap(double seconds) {
    stage_.show(GapFace{});
    return or_abort(stage_.wait_or_abort(std::min(seconds, kLongestPause)), observer_.gap(seconds));
}

Signal SpectatorScreen::rest(double seconds, const protocols::TrialView& next) {
    stage_.show(BreakFace{0, next.number, next.total, next.practice});
    return or_abort(stage_.wait_or_abort(std::min(seconds, kLongestPause)),
                    observer_.rest(seconds, next));
}

Signal SpectatorScreen::pause(const protocols::TrialView& /*next*/) {
    return or_abort(stage_.pause_or_abort(), Signal::go_on);
}

std::optional<Signal> SpectatorScreen::trouble(const protocols::TroubleView& view) {
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

void SpectatorScreen::finish(const protocols::SessionView& session) {
    observer_.finish(session);
    stage_.close_desk();
    stage_.show(EndFace{});
    static_cast<void>(stage_.wait_or_abort(3.0 * kLook));
}

}  // namespace palpate::ui
