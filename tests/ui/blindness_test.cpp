#include <type_traits>

#include "protocols/trial/servo_apparatus.hpp"
#include "tests/support/faulty.hpp"
#include "tests/support/short_text.hpp"
#include "tests/ui/keys.hpp"

using namespace palpate::protocols;

namespace {

Protocol shipped() {
    return parse_protocol(short_text("shape_friction_demo", {}), "p.toml");
}

/// A hash of what the screen shows.
std::string shown_on(ui::SubjectScreen& screen) {
    const std::vector<std::uint8_t> pixels = screen.stage().window().pixels();
    const std::string_view bytes(reinterpret_cast<const char*>(pixels.data()), pixels.size());
    return std::to_string(std::hash<std::string_view>{}(bytes));
}

ui::SubjectScreenOptions small_screen(bool dead_man,
                                      ResponseKind asks = ResponseKind::identification,
                                      double guard_s = 0.25) {
    ui::SubjectScreenOptions all = options();
    all.window.width = 640;  // hardly a pixel more than a screen needs: each is hashed
    all.window.height = 480;
    all.dead_man = dead_man;
    all.guard_s = guard_s;
    all.asks = asks;
    return all;
}

/// Presses a key again and again until `ask` has come back.
void press_until_done(SDL_Keycode key, const std::function<void()>& ask) {
    std::atomic<bool> answered{false};
    std::thread subject([&] {
        while (!answered) {
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
            press(key);
        }
    });
    ask();
    answered = true;
    subject.join();
}

/// Runs the real subject's screen in a session: begins and answers by itself, and keeps what the
/// screen showed while each object was felt.
class WatchedScreen : public Observer {
public:
    WatchedScreen() : screen_(small_screen(false, ResponseKind::identification, 0.0)) {}

    Signal welcome(const SessionView& /*session*/) override { return Signal::go_on; }
    Signal ready(const TrialView& trial) override {
        Signal signal = Signal::abort;
        press_until_done(SDLK_SPACE, [&] { signal = screen_.ready(trial); });
        return signal;
    }
    ExplorationStep explore(const TrialView& trial, double elapsed_s) override {
        // One and the same trial number for all: only the condition differs between the trials.
        TrialView view = trial;
        view.number = 1;
        view.total = 1;
        static_cast<void>(screen_.explore(view, elapsed_s));
        shown_.insert(frame());
        ++frames_;
        return {.signal = elapsed_s > 0.2 ? Signal::done : Signal::go_on, .at_s = elapsed_s};
    }
    Choice choose(const TrialView& /*trial*/, const Question& question) override {
        screen_.stage().show("question", [question](ui::Window& window) {
            draw(window, ui::ChooseFace{question, 0, false});
        });
        pictures_.insert(frame());
        return {};
    }
    Signal gap(double /*seconds*/) override { return Signal::go_on; }
    Signal rest(double /*seconds*/, const TrialView& /*next*/) override { return Signal::go_on; }
    void finish(const SessionView& /*session*/) override {}

    std::set<std::string> shown_;  ///< a hash of every frame
    std::set<std::string> pictures_;
    int frames_ = 0;

private:
    std::string frame() { return shown_on(screen_); }

    ui::SubjectScreen screen_;
};

/// The conditions of a session, which comes to its end.
std::set<Condition> conditions_felt(const Protocol& protocol,
                                    const Plan& plan,
                                    Apparatus& apparatus,
                                    Observer& observer) {
    struct Forgetful : protocols::Recorder {
        TrialId begin_trial(const PlannedTrial& planned) override {
            conditions.insert(planned.condition);
            return 1;
        }
        std::set<Condition> conditions;
    } recorder;
    const SessionEnd end = run_session(
        protocol, plan, {}, SessionProgress(protocol, plan, {}),
        {.apparatus = apparatus, .observer = observer, .recorder = recorder, .pause = [](double) {
         }});
    CHECK(end.why == SessionEnd::Why::finished);
    return recorder.conditions;
}

/// The same of a short session.
std::size_t conditions_felt(World world, Observer& observer) {
    const Protocol protocol = short_protocol();
    FaultyApparatus apparatus(world);
    return conditions_felt(protocol, plan_of(protocol), apparatus, observer).size();
}

}  // namespace

TEST_CASE(
    "while exploring, the subject's picture is the same to the pixel for all ten conditions") {
    draw_into_memory();
    Protocol protocol = shipped();
    protocol.timing.explore_min = 0.0;
    protocol.invalid = {
        .late_share = 1.0, .contact_min = 0.0, .path_min = 0.0};  // short looks count
    const std::string hash = protocol_hash(protocol);
    const SessionKey key{"P1", 1};
    const Plan plan = make_plan(protocol, hash, key, protocol.seed);
    SimulatedApparatus apparatus(protocol, DrawnHand(protocol, hash, key, protocol.seed));
    WatchedScreen screen;
    CHECK(conditions_felt(protocol, plan, apparatus, screen).size() == 10);
    CHECK(screen.frames_ >= 100);
    CHECK(screen.shown_.size() == 1);
    // The test sees differences where there are some: the pictures of the choice.
    CHECK(screen.pictures_.size() == 1);
    CHECK(*screen.pictures_.begin() != *screen.shown_.begin());
}

TEST_CASE("nothing of the condition is among what the explore screen is drawn from") {
    // Whoever adds a member to the face must come here and say why it cannot tell the shape.
    const auto [trial, may_finish, prompt, dead_man, asks_shape] = ui::ExploreFace{};
    // Every trial asks the same question; of TrialView below.
    CHECK(asks_shape);
    CHECK(std::is_same_v<std::remove_const_t<decltype(trial)>, TrialView>);
    CHECK_FALSE((may_finish || prompt || dead_man));
}

TEST_CASE(
    "where a trial may begin is the same for all conditions, and so is what ready says of it") {
    const auto [away, radius, in_space, open, inside, refused] = ui::StartMark{};
    CHECK((glm::length(away) == 0.0 && radius == 0.0 && !in_space && open && !inside && !refused));
}

TEST_CASE(
    "after a fault the screens are the same to the pixel for all conditions, dead-man key or not") {
    /// Shows the real faces of a session whose every trial faults once.
    class Shaken : public Patient {
    public:
        explicit Shaken(bool dead_man) : screen_(small_screen(dead_man)) {}
        ExplorationStep explore(const TrialView& trial, double elapsed_s) override {
            TrialView view = trial;
            view.number = 1;
            view.total = 1;  // of practice and of the others: distinguished by what is counted
            view.practice = false;
            if (looks_++ % 8 == 0) {
                static_cast<void>(screen_.explore(view, elapsed_s));
                explored.insert(frame());
            }
            return Patient::explore(trial, elapsed_s);
        }
        std::optional<Signal> trouble(const TroubleView& view) override {
            static_cast<void>(screen_.trouble(view));
            (view.solved ? solved : waiting).insert(frame());
            return Patient::trouble(view);
        }
        std::set<std::string> explored, waiting, solved;

    private:
        std::string frame() { return shown_on(screen_); }
        int looks_ = 0;
        ui::SubjectScreen screen_;
    };
    const bool dead_man = GENERATE(false, true);
    draw_into_memory();
    Shaken screen(dead_man);
    CHECK(conditions_felt({.fault_share = 1.0, .max_faults = 1, .away = 1}, screen) >= 6);
    CHECK(screen.explored.size() == 1);
    CHECK(screen.waiting.size() == 1);
    CHECK(screen.solved.size() == 1);
    CHECK(screen.waiting != screen.solved);
}

TEST_CASE("nothing of the condition is among what the trouble screen is drawn from") {
    // As above: what a new member says must be the same for every stimulus.
    const auto [sentence, solved, by_chord] = ui::TroubleFace{};
    CHECK((sentence.empty() && !solved && !by_chord));
    const auto [text, is_solved, tries, in_a_row, by_hand] = TroubleView{};
    CHECK((text.empty() && !is_solved && tries == 0 && in_a_row == 1 && !by_hand));
}

TEST_CASE(
    "every screen of a trial of two intervals is the same to the pixel for all conditions, the "
    "question too",
    "[long]") {
    /// Shows the real screens of both intervals for each trial of a session, and answers by itself.
    class TwoIntervals : public Patient {
    public:
        TwoIntervals() : screen_(small_screen(false, ResponseKind::two_interval)) {}
        Signal ready(const TrialView& trial) override {
            for (const std::size_t interval : {std::size_t{1}, std::size_t{2}}) {
                press_until_done(SDLK_SPACE,
                                 [&] { static_cast<void>(screen_.ready(of(trial, interval))); });
                see("ready", interval);
            }
            return Signal::go_on;
        }
        ExplorationStep explore(const TrialView& trial, double elapsed_s) override {
            if (looks_++ % 4 == 0) {
                const std::size_t interval = elapsed_s < 0.1 ? 1 : 2;
                static_cast<void>(screen_.explore(of(trial, interval), elapsed_s));
                see("explore", interval);
            }
            return Patient::explore(trial, elapsed_s);
        }
        Choice choose(const TrialView& trial, const Question& question) override {
            Question asked = question;
            asked.kind = ResponseKind::two_interval;
            asked.answers = 2;
            asked.confidence = true;
            press_until_done(SDLK_1,
                             [&] { static_cast<void>(screen_.choose(of(trial, 2), asked)); });
            see("confidence", 2);
            screen_.stage().show("question", [&](ui::Window& window) {
                draw(window, ui::ChooseFace{asked, 1, false});
            });
            see("question", 2);
            return {};
        }
        Signal gap(double /*seconds*/) override {
            static_cast<void>(screen_.gap(0.0));
            see("gap", 0);
            return Signal::go_on;
        }
        std::map<std::string, std::set<std::string>> seen;

    private:
        int looks_ = 0;
        /// One and the same number for all trials.
        static TrialView of(const TrialView& trial, std::size_t interval) {
            TrialView view = trial;
            view.number = 1;
            view.total = 9;
            view.practice = false;
            view.interval = interval;
            view.intervals = 2;
            return view;
        }
        void see(const std::string& screen, std::size_t interval) {
            seen[screen + std::to_string(interval)].insert(shown_on(screen_));
        }
        ui::SubjectScreen screen_;
    };
    draw_into_memory();
    TwoIntervals screen;
    CHECK(conditions_felt({}, screen) >= 6);
    std::set<std::string> all;
    for (const auto& [name, pictures] : screen.seen) {
        CAPTURE(name);
        CHECK(pictures.size() == 1);
        all.insert(pictures.begin(), pictures.end());
    }
    CHECK(screen.seen.size() == 7);
    CHECK(all.size() == 7);  // the test sees differences where there are some
}

TEST_CASE("nothing of the condition is among what the ready and answer screens are drawn from") {
    // As above. What a question says is the same for every trial of a session.
    const auto [trial, dead_man, start] = ui::ReadyFace{};
    CHECK((trial == TrialView{} && !dead_man && !start));
    const auto [question, selected, watched] = ui::ChooseFace{};
    const auto& [kind, text, pictures, answers, labels, confidence, confirm, limit_s] = question;
    CHECK((kind == ResponseKind::identification && text.empty() && pictures.empty() &&
           answers == 0 && labels.empty() && !confidence && !confirm && limit_s == 0.0 &&
           !selected && !watched));
    const auto [sure, may_change] = ui::ConfidenceFace{};
    CHECK((!sure && !may_change));
    const auto [shown, of, practising, done, missed, least_s, prompt_s, timeout_s, nth, in_all] =
        TrialView{};
    CHECK((shown == 0 && of == 0 && !practising && done == 0 && missed == 0 && least_s == 0.0 &&
           prompt_s == 0.0 && timeout_s == 0.0 && nth == 1 && in_all == 1));
}
