#include "tests/support/catch.hpp"
#include "tests/ui/keys.hpp"

using namespace palpate::protocols;
using namespace palpate::ui;

namespace {

struct DeskRig {
    SubjectScreenOptions with() {
        SubjectScreenOptions all = options();
        all.desk = &desk;
        return all;
    }
    /// What the screen shows now.
    std::string words() {
        std::string all;
        for (const TextExtent& line : screen.stage().window().written()) {
            all += line.text + " ";
        }
        return all;
    }
    OperatorDesk desk;
    SubjectScreen screen{with()};
};

}  // namespace

TEST_CASE("no key of the participant marks a trial or asks for a pause, whatever is pressed") {
    DeskRig rig;
    const Later participant([] {
        for (const SDL_Keycode key : {SDLK_m, SDLK_p, SDLK_y, SDLK_m, SDLK_y}) {
            press(key);
            press(key, KMOD_CTRL);
            press(key, KMOD_SHIFT);
            press(key, KMOD_ALT);
        }
        press(SDLK_m, kChord);  // the question alone does nothing
        press(SDLK_n);
        press(SDLK_y);
        press(SDLK_SPACE);
    });
    CHECK(rig.screen.ready(kTrial) == Signal::go_on);
    CHECK_FALSE(rig.desk.wants());
}

TEST_CASE("a mark at the screen keeps the reason of one that was asked for before") {
    DeskRig rig;
    rig.desk.mark("the phone rang");
    press(SDLK_m, kChord);
    press(SDLK_y);
    static_cast<void>(rig.screen.explore(kTrial, 0.0));
    rig.desk.mark("they said so, too");
    CHECK(rig.desk.take_mark() == "the phone rang; they said so, too");
    CHECK_FALSE(rig.desk.take_mark());
}

TEST_CASE("what became of a mark stands at the lower edge, until something else is asked") {
    DeskRig rig;
    const auto says = [&](const std::string& sentence) {
        static_cast<void>(rig.screen.gap(0.1));
        CHECK_THAT(rig.words(), Has(sentence));
    };
    rig.desk.reply({.found = true, .runs_again = true, .number = {false, 3, 10}, .trial = 7});
    says("trial 3 of 10 does not count and runs again");
    rig.desk.reply({.found = true, .runs_again = false, .number = {true, 2, 4}, .trial = 8});
    says("practice 2 of 4 does not count and is not run again");
    rig.desk.reply({});
    says("nothing to mark");
}

TEST_CASE("the question of a mark names the trial that runs, or the last one") {
    DeskRig rig;
    const auto asks = [&](const std::string& which) {
        CHECK_THAT(rig.words(), Has("press Y if " + which + " trial"));
        press(SDLK_n);
        static_cast<void>(rig.screen.gap(0.1));
    };
    press(SDLK_m, kChord);
    static_cast<void>(rig.screen.gap(0.1));
    asks("the last");
    static_cast<void>(rig.screen.explore(kTrial, 0.0));
    press(SDLK_m, kChord);
    for (int i = 0; i < 20; ++i) {
        static_cast<void>(rig.screen.explore(kTrial, 0.1));
    }
    asks("this");
    {
        const Later subject([] { press(SDLK_2); });
        static_cast<void>(rig.screen.choose(kTrial, question(ResponseKind::two_interval)));
    }
    press(SDLK_m, kChord);
    static_cast<void>(rig.screen.gap(0.1));
    asks("the last");
}

TEST_CASE("a break asks for the handle before it asks for Space") {
    DeskRig rig;
    std::atomic<bool> awaited{true};
    std::string before;
    rig.desk.await_handle([&] {
        before = awaited ? rig.words() : before;  // of the screen that was shown until now
        return awaited.load();
    });
    const Later participant(
        [&] {
            awaited = false;
            std::this_thread::sleep_for(std::chrono::milliseconds(300));
            press(SDLK_SPACE);
        },
        500);
    CHECK(rig.screen.rest(0.0, kTrial) == Signal::go_on);
    CHECK_THAT(before, Has("First bring the handle home") && !Has("Space"));
    CHECK_THAT(rig.words(), Has("Press Space to go on"));
}

TEST_CASE("a break and a pause end with a stop, which is still to be shown") {
    DeskRig rig;
    const Later somebody([&] { rig.desk.stop("shell"); }, 500);
    const bool rests = GENERATE(true, false);
    CHECK((rests ? rig.screen.rest(3600.0, kTrial) : rig.screen.pause(kTrial)) == Signal::go_on);
    CHECK(rig.desk.wants_stop());
}

TEST_CASE("a mark or a pause does not begin the second interval of a trial, Space does") {
    DeskRig rig;
    TrialView second = kTrial;
    second.interval = second.intervals = 2;
    std::atomic<bool> pressed{false};
    const Later both(
        [&] {
            press(SDLK_p, kChord);
            std::this_thread::sleep_for(std::chrono::milliseconds(300));
            pressed = true;
            press(SDLK_SPACE);
        },
        300);
    CHECK(rig.screen.ready(second) == Signal::go_on);
    CHECK(pressed);
    CHECK(rig.desk.take_pause());  // it comes after the trial
}

TEST_CASE("after the experimenter's stop only the experimenter's chord goes on") {
    DeskRig rig;
    TroubleView view{.sentence = "the experimenter switched the force off", .by_hand = true};
    const auto press_all = [] {
        press(SDLK_SPACE);
        press(SDLK_RETURN);
        press(SDLK_p);
    };
    CHECK_FALSE(rig.screen.trouble(view).has_value());
    press_all();
    press(SDLK_p, kChord);  // the device is not ready yet: this asks for nothing
    CHECK_FALSE(rig.screen.trouble(view).has_value());
    view.solved = true;
    CHECK_FALSE(rig.screen.trouble(view).has_value());
    press_all();
    for (int i = 0; i < 10; ++i) {
        CHECK_FALSE(rig.screen.trouble(view).has_value());
    }
    press(SDLK_p, kChord);
    CHECK(rig.screen.trouble(view) == Signal::go_on);
    CHECK_FALSE(rig.desk.wants());  // and no pause follows
}
