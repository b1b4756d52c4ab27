#include "ui/subject/subject_screen.hpp"

#include <cmath>
#include <utility>

#include "engine/realtime/servo.hpp"
#include "protocols/design/plan_summary.hpp"
#include "ui/subject/display.hpp"

namespace palpate::ui {
namespace {

using protocols::Choice;
using protocols::ExplorationStep;
using protocols::Signal;

/// explore() looks for presses this long, ms: often enough for 1 ms times, and the force goes on by
/// itself.
constexpr int kExploreWaitMs = 1;
constexpr int kIdleWaitMs = 50;
/// The dot of the handle follows it this often, ms, and from so far on, m.
constexpr int kFollowMs = 25;
constexpr double kFollow = 0.0002;
constexpr std::int64_t kNoPlaceNs = 2'000'000'000;  ///< a handle out of sight is looked for so long

bool looks_other(const std::optional<StartMark>& a, const std::optional<StartMark>& b) {
    return a.has_value() != b.has_value() ||
           (a && (a->open != b->open || a->inside != b->inside || a->refused != b->refused ||
                  !(glm::length(a->away - b->away) < kFollow)));
}

}  // namespace

SubjectScreen::SubjectScreen(SubjectScreenOptions options)
    : options_(std::move(options)), stage_(options_) {}

Signal SubjectScreen::wait_for_go() {
    guard(monotonic_ns());
    for (;;) {
        const Input input = stage_.next(kIdleWaitMs);
        if (input.kind == Input::Kind::abort) {
            return Signal::abort;
        }
        if (input.kind == Input::Kind::go || input.kind == Input::Kind::enter) {
            return Signal::go_on;
        }
    }
}

std::optional<StartMark> SubjectScreen::look_at_start(bool refused) const {
    const auto place = options_.place ? options_.place() : std::nullopt;
    if (!place) {
        return std::nullopt;
    }
    const protocols::StartGate& gate = options_.gate;
    const bool open = gate.lets_begin(*place);
    return StartMark{.away = *place - gate.start(),
                     .radius = gate.radius(),
                     .in_space = gate.in_space(),
                     .open = open,
                     .inside = !open && glm::length(*place - gate.start()) <= gate.radius(),
                     .refused = refused && !open};
}

/// Also of a device that falls silent meanwhile.
/// @param checks_desk  returns as well when the experimenter wants something
Signal SubjectScreen::wait_at_start(ReadyFace face, bool checks_desk) {
    face.start = look_at_start(false);
    stage_.show(face);
    guard(monotonic_ns());
    std::int64_t seen_ns = monotonic_ns();
    for (bool refused = false;;) {
        const Input input = stage_.next(options_.place ? kFollowMs : kIdleWaitMs);
        if (input.kind == Input::Kind::abort) {
            return Signal::abort;
        }
        if (checks_desk && options_.desk != nullptr && options_.desk->wants()) {
            return Signal::held_up;
        }
        const bool begins = input.kind == Input::Kind::go ||
                            (input.kind == Input::Kind::enter && !options_.dead_man);
        const std::optional<StartMark> start = look_at_start(refused || begins);
        if (begins && (!start || start->open)) {
            return Signal::go_on;
        }
        refused = start && start->refused;
        const std::int64_t now = monotonic_ns();
        seen_ns = start && !std::isfinite(start->away.x) ? seen_ns : now;
        if (now - seen_ns > kNoPlaceNs) {
            return Signal::no_place;
        }
        if (looks_other(face.start, start)) {
            face.start = start;
            stage_.show(face);
        }
    }
}

bool SubjectScreen::guard(std::int64_t shown_ns) {
    stage_.guard_until(shown_ns + static_cast<std::int64_t>(options_.guard_s * 1e9));
    return stage_.forget_earlier();
}

void SubjectScreen::hold(bool held) {
    if (options_.dead_man && options_.on_hold) {
        options_.on_hold(held);
    }
}

Signal SubjectScreen::welcome(const protocols::SessionView& session) {
    stage_.show(WelcomeFace{.trials = session.trials - session.next - session.practice,
                            .practice = session.practice,
                            .resumed = session.next > 0,
                            .breaks = session.breaks,
                            .moves_pointer = static_cast<bool>(options_.on_pointer),
                            .asks = options_.asks});
    return wait_for_go();
}

Signal SubjectScreen::ready(const protocols::TrialView& trial) {
    exploring_.reset();
    in_trouble_.reset();
    hold(false);
    const bool first = trial.interval == 1;  // a trial that has begun goes on to its answer
    stage_.in_trial(!first);
    stage_.need_keyboard(true);
    const Signal signal = wait_at_start({.trial = trial, .dead_man = options_.dead_man}, first);
    stage_.need_keyboard(false);
    hold(signal == Signal::go_on);
    return signal;
}

PointerMap SubjectScreen::pointer_map() {
    return {stage_.window().size(), stage_.window().scale()};
}

void SubjectScreen::begin_exploring() {
    in_trouble_.reset();
    stage_.in_trial(true);
    stage_.window().show_pointer(false);
    if (guard(monotonic_ns())) {
        hold(false);
    }
    if (keyboard_is_elsewhere()) {
        stage_.stop(engine::Trip::focus_lost, protocols::kKeyboardElsewhere);
    }
    if (options_.on_pointer) {
        stage_.window().put_pointer(pointer_map().to_pixel(engine::Vec2(options_.gate.start())));
    }
}

/// To the apparatus: where the pointer is, whether someone holds the key, and is still there.
void SubjectScreen::pass_on(const Input& input) {
    if (input.kind == Input::Kind::motion && options_.on_pointer) {
        options_.on_pointer(pointer_map().to_object(input.pixel));
    } else if (input.kind == Input::Kind::release) {
        hold(false);
    } else if (input.kind == Input::Kind::lost) {
        stage_.stop(engine::Trip::focus_lost, input.way);
        hold(false);  // nobody can tell any more
    }
}

ExplorationStep SubjectScreen::explore(const protocols::TrialView& trial, double elapsed_s) {
    const std::int64_t entered = monotonic_ns();
    const ExploreFace face = explore_face(trial, elapsed_s, options_.asks, options_.dead_man);
    if (!exploring_) {
        begin_exploring();
    }
    if (exploring_ != face) {
        exploring_ = face;
        stage_.show(face);
    }
    ask_display();
    for (;;) {
        const Input input = stage_.next(kExploreWaitMs);
        pass_on(input);
        if (input.kind == Input::Kind::abort) {
            return {.signal = Signal::abort};
        }
        const bool alive = !display_owes_answer();
        // The key that is held cannot say done as well.
        const bool space = input.kind == Input::Kind::go && !options_.dead_man;
        if (space || input.kind == Input::Kind::enter) {
            return {.signal = Signal::done,
                    .at_s = elapsed_s + static_cast<double>(input.seen_ns - entered) * 1e-9,
                    .uncertainty_s = input.uncertainty_s};
        }
        if (input.kind != Input::Kind::motion || monotonic_ns() - entered > 4'000'000) {
            return {.alive = alive};
        }
    }
}

std::optional<Signal> SubjectScreen::trouble(const protocols::TroubleView& view) {
    const bool by_chord = view.by_hand && options_.desk != nullptr;
    TroubleFace face{.sentence = view.sentence, .solved = view.solved, .by_chord = by_chord};
    if (in_trouble_ != face) {
        exploring_.reset();
        stage_.in_trial(false);
        stage_.window().show_pointer(true);
        stage_.show(face);
        guard(monotonic_ns());  // a press while nothing worked asked for nothing
        if (by_chord) {
            static_cast<void>(options_.desk->take_pause());
            stage_.drop_bar();
        }
        in_trouble_ = std::move(face);
    }
    for (;;) {
        const Input input = stage_.next(0);
        if (by_chord && view.solved && options_.desk->take_pause()) {
            stage_.drop_bar();
            return Signal::go_on;
        }
        if (input.kind == Input::Kind::none) {
            return std::nullopt;
        }
        if (input.kind == Input::Kind::abort) {
            return Signal::abort;
        }
        if (view.solved && !by_chord &&
            (input.kind == Input::Kind::go || input.kind == Input::Kind::enter)) {
            return Signal::go_on;
        }
    }
}

Choice SubjectScreen::pick(const std::function<std::vector<Card>()>& cards,
                           const protocols::Question& question,
                           const std::function<std::int64_t(std::optional<std::size_t>)>& show) {
    const std::int64_t shown = show(std::nullopt);
    guard(shown);  // a press while the answers were being drawn was not one of them
    Picker picking(shown, question.confirm);
    double away_s = 0.0;
    for (std::int64_t seen_ns = shown; !picking.chosen();) {
        const Input input = stage_.next(kIdleWaitMs);
        const std::int64_t now = monotonic_ns();
        away_s += keyboard_is_elsewhere() ? static_cast<double>(now - seen_ns) * 1e-9 : 0.0;
        seen_ns = now;
        if (input.kind == Input::Kind::abort) {
            return {.signal = Signal::abort};
        }
        const double waited = static_cast<double>(now - shown) * 1e-9;
        if (question.timeout_s > 0.0 && waited > question.timeout_s) {
            return {.signal = Signal::too_late};
        }
        if (picking.handle(input, cards())) {
            show(picking.marked());
        }
    }
    Choice choice = *picking.chosen();
    choice.early_presses = stage_.early_presses();
    choice.away_s = away_s;
    return choice;
}

Choice SubjectScreen::choose(const protocols::TrialView& /*trial*/,
                             const protocols::Question& question) {
    stage_.window().show_pointer(true);
    Window& window = stage_.window();
    const auto answers = [&] {
        return lay_out_answers(question, window.size());
    };
    const auto levels = [&] {
        return lay_out_scale(protocols::kMaxConfidence, window.size());
    };
    Choice choice = pick(answers, question, [&](auto selected) {
        return stage_.show(ChooseFace{question, selected, false});
    });
    if (question.confidence && choice.signal == Signal::done) {
        const Choice sure = pick(levels, question, [&](auto selected) {
            return stage_.show(ConfidenceFace{selected, question.confirm});
        });
        if (sure.signal != Signal::done) {
            return {.signal = sure.signal};
        }
        choice.confidence = static_cast<int>(sure.place) + 1;
        choice.confidence_reaction_s = sure.reaction_s;
        choice.confidence_confirmation = sure.confirmation;
        choice.early_presses += sure.early_presses;
        choice.away_s += sure.away_s;
    }
    stage_.in_trial(false);
    return choice;
}

Signal SubjectScreen::feedback(const protocols::TrialView& /*trial*/, bool correct) {
    stage_.show(FeedbackFace{correct});
    return stage_.wait_or_abort(protocols::kFeedbackSeconds) ? Signal::abort : Signal::go_on;
}

Signal SubjectScreen::gap(double seconds) {
    stage_.show(GapFace{});
    return stage_.wait_or_abort(seconds) ? Signal::abort : Signal::go_on;
}

Signal SubjectScreen::rest(double seconds, const protocols::TrialView& next) {
    const std::int64_t until = monotonic_ns() + static_cast<std::int64_t>(seconds * 1e9);
    BreakFace shown{.seconds_left = -1};
    for (;;) {
        const double left = static_cast<double>(until - monotonic_ns()) * 1e-9;
        const BreakFace face{
            .seconds_left = left > 0.0 ? static_cast<int>(std::ceil(left)) : 0,
            .next = next,
            .awaits_handle = options_.desk != nullptr && options_.desk->awaits_handle()};
        if (face != shown) {
            stage_.show(face);
        }
        if (face.seconds_left == 0 && shown.seconds_left != 0) {
            guard(monotonic_ns());
        }
        shown = face;
        const Input input = stage_.next(kIdleWaitMs);
        if (input.kind == Input::Kind::abort) {
            return Signal::abort;
        }
        if (options_.desk != nullptr && options_.desk->wants_stop()) {
            return Signal::go_on;  // no rest: the experimenter comes
        }
        if (shown.seconds_left == 0 &&
            (input.kind == Input::Kind::go || input.kind == Input::Kind::enter)) {
            return Signal::go_on;  // also where the handle is away: the experimenter is called then
        }
    }
}

Signal SubjectScreen::pause(const protocols::TrialView& /*next*/) {
    return stage_.pause_or_abort() ? Signal::abort : Signal::go_on;
}

void SubjectScreen::finish(const protocols::SessionView& /*session*/) {
    stage_.close_desk();
    stage_.show(EndFace{});
    static_cast<void>(wait_for_go());
}

}  // namespace palpate::ui
