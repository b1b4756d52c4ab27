#include "protocols/session/trouble.hpp"
#include "ui/rig/operator_log.hpp"
#include "tests/support/catch.hpp"
#include "tests/ui/keys.hpp"

using namespace palpate::protocols;
using namespace palpate::ui;

namespace {

/// A screen with a dead-man key, and what it said to the apparatus.
struct Rig {
    explicit Rig(bool dead_man = true) : screen(with(dead_man)) {}

    SubjectScreenOptions with(bool dead_man) {
        SubjectScreenOptions all = options();
        all.dead_man = dead_man;
        all.on_hold = [this](bool held) {
            holds.push_back(held);
        };
        all.on_stop = [this](engine::Trip why, const char* /*way*/) {
            ++stops;
            cause = why;
        };
        return all;
    }
    void begin() {
        const Later subject([] { press(SDLK_SPACE); });
        REQUIRE(screen.ready(kTrial) == Signal::go_on);
    }
    ExplorationStep explore_until_quiet(double elapsed_s) {
        ExplorationStep last;
        for (int i = 0; i < 20; ++i) {
            const ExplorationStep now = screen.explore(kTrial, elapsed_s);
            last = now.signal != Signal::go_on ? now : last;
        }
        return last;
    }

    std::vector<bool> holds;
    int stops = 0;
    engine::Trip cause = engine::Trip::none;
    SubjectScreen screen;
};

void happens_to_window(SDL_WindowEventID what) {
    SDL_Event event{};
    event.type = SDL_WINDOWEVENT;
    event.window.event = static_cast<Uint8>(what);
    tests::SDL_PushEvent(&event);
}

/// Those that say numbers, and how many.
constexpr std::pair<std::string_view ui::Words::*, int> kNumbers[] = {
    {&ui::Words::trials, 1},
    {&ui::Words::practice_first, 2},
    {&ui::Words::trial, 2},
    {&ui::Words::practice_trial, 2},
    {&ui::Words::choose, 1},
    {&ui::Words::choose_level, 1},
    {&ui::Words::next_trial, 2},
    {&ui::Words::next_practice, 2},
    {&ui::Words::wait, 1},
    {&ui::Words::marked, 2},
    {&ui::Words::practice_marked, 2},
};

/// Every sentence: the words are nothing else.
auto sentences_of(const ui::Words& words) {
    return std::bit_cast<
        std::array<std::string_view, sizeof(ui::Words) / sizeof(std::string_view)>>(words);
}

}  // namespace

TEST_CASE("a trial with a dead-man key begins when Space goes down, and not before") {
    Rig rig;
    {
        const Later subject([] {
            press(SDLK_RETURN);                  // Enter begins nothing here
            press(SDLK_SPACE, KMOD_NONE, true);  // held since before: not a press
            press(SDLK_SPACE);
        });
        CHECK(rig.screen.ready(kTrial) == Signal::go_on);
    }
    CHECK(rig.holds == std::vector<bool>{false, true});
    CHECK(rig.explore_until_quiet(3.0).signal == Signal::go_on);
    CHECK(rig.holds == std::vector<bool>{false, true});  // still held: nothing to say
    press(SDLK_SPACE);                                   // done is another key
    CHECK(rig.explore_until_quiet(3.5).signal == Signal::go_on);
    press(SDLK_RETURN);
    CHECK(rig.explore_until_quiet(4.0).signal == Signal::done);
}

TEST_CASE("whoever lets go of the dead-man key has let go, in whatever way and however early") {
    EACH(way, 0, 1, 2, 3);
    Rig rig;
    rig.begin();
    if (way == 0) {  // before the screen changed
        let_go(SDLK_SPACE);
    }
    static_cast<void>(rig.screen.explore(kTrial, 0.0));
    if (way == 1) {
        let_go(SDLK_SPACE);
    } else if (way == 2) {  // another window took the keyboard: nobody can tell any more
        happens_to_window(SDL_WINDOWEVENT_FOCUS_LOST);
    } else if (way == 3) {  // while the stop question is open
        press(SDLK_q, kChord);
        let_go(SDLK_SPACE);
    }
    CHECK(rig.explore_until_quiet(1.0).signal == Signal::go_on);
    CHECK(rig.holds == std::vector<bool>{false, true, false});
    press(SDLK_SPACE);  // too late for this trial: the next one begins with a new press
    static_cast<void>(rig.explore_until_quiet(1.5));
    CHECK(rig.holds.back() == false);
}

TEST_CASE("without a dead-man key Space is done as ever, and nobody hears of it") {
    Rig rig(false);
    rig.begin();
    static_cast<void>(rig.screen.explore(kTrial, 0.0));
    let_go(SDLK_SPACE);
    CHECK(rig.explore_until_quiet(1.0).signal == Signal::go_on);
    press(SDLK_SPACE);
    CHECK(rig.explore_until_quiet(3.0).signal == Signal::done);
    CHECK(rig.holds.empty());
}

TEST_CASE("Escape says on every screen, once and at once, that no force is wanted") {
    Rig rig(false);
    int pressed = 0;
    const auto escape = [&pressed] {
        press(SDLK_ESCAPE);
        ++pressed;
    };
    const auto on = [&](const char* name, const std::function<void()>& show) {
        CAPTURE(name);
        {
            const Later subject([&] {
                escape();
                press(SDLK_ESCAPE, KMOD_NONE, true);  // held on
                press(SDLK_SPACE);
                press(SDLK_1);
            });
            show();
        }
        CHECK(rig.stops == pressed);
    };
    on("welcome", [&] { CHECK(rig.screen.welcome(SessionView{}) == Signal::go_on); });
    on("ready", [&] { CHECK(rig.screen.ready(kTrial) == Signal::go_on); });
    escape();  // before the screen of the exploration: it forgets what was not meant for it
    press(SDLK_ESCAPE, KMOD_NONE, true);
    CHECK(rig.screen.explore(kTrial, 0.0).signal == Signal::go_on);
    CHECK(rig.stops == pressed);
    escape();
    CHECK(rig.explore_until_quiet(0.5).signal == Signal::go_on);
    CHECK(rig.stops == pressed);
    press(SDLK_q, kChord);
    escape();  // also instead of an answer to the stop question, which it takes back
    press(SDLK_y);
    CHECK(rig.explore_until_quiet(1.0).signal == Signal::go_on);
    CHECK(rig.stops == pressed);
    on("question", [&] {
        const auto pictures = question(ResponseKind::identification);
        CHECK(rig.screen.choose(kTrial, pictures).signal == Signal::done);
    });
    on("feedback", [&] { CHECK(rig.screen.feedback(kTrial, true) == Signal::go_on); });
    on("gap", [&] { CHECK(rig.screen.gap(1.0) == Signal::go_on); });
    on("break", [&] { CHECK(rig.screen.rest(0.0, kTrial) == Signal::go_on); });
    CHECK_FALSE(rig.screen.trouble({.sentence = "the device is gone"}).has_value());
    escape();
    CHECK_FALSE(rig.screen.trouble({.sentence = "the device is gone"}).has_value());
    CHECK(rig.stops == pressed);
}

TEST_CASE(
    "a window that loses the keyboard, is hidden, minimised or to be closed has the force off") {
    EACH(what, as<int>{}, SDL_WINDOWEVENT_FOCUS_LOST, SDL_WINDOWEVENT_HIDDEN,
         SDL_WINDOWEVENT_MINIMIZED, SDL_WINDOWEVENT_NONE);
    Rig rig(false);
    rig.begin();
    static_cast<void>(rig.screen.explore(kTrial, 0.0));
    CHECK(rig.stops == 0);
    if (what == SDL_WINDOWEVENT_NONE) {
        close_window();
    } else {
        happens_to_window(static_cast<SDL_WindowEventID>(what));
    }
    CHECK(rig.explore_until_quiet(1.0).signal == Signal::go_on);
    CHECK(rig.stops == 1);
    CHECK((rig.cause == engine::Trip::focus_lost));
}

TEST_CASE("in trouble the screen waits, and goes on with a press after the device is back") {
    Rig rig(false);
    TroubleView view{.sentence = "the device is gone: check its cable and power"};
    for (int i = 0; i < 3; ++i) {
        press(SDLK_SPACE);
        CHECK_FALSE(rig.screen.trouble(view).has_value());
    }
    press(SDLK_SPACE);  // seen only by the next screen: it was meant for this one
    view.solved = true;
    CHECK_FALSE(rig.screen.trouble(view).has_value());
    press(SDLK_SPACE);
    CHECK(rig.screen.trouble(view) == Signal::go_on);
    view.solved = false;
    press(SDLK_q, kChord);
    press(SDLK_y);
    CHECK_FALSE(rig.screen.trouble({.sentence = "another"}).has_value());  // too early
    press(SDLK_q, kChord);
    press(SDLK_y);
    CHECK(rig.screen.trouble({.sentence = "another"}) == Signal::abort);
}

TEST_CASE("the console says what happened, what to do, and what follows") {
    CHECK(fault_text({.cause = engine::Trip::over_speed, .text = {}, .last = {}}) ==
          "fault: " + std::string(explanation(engine::Trip::over_speed)));
    CHECK_THAT(fault_text({.cause = engine::Trip::device_lost, .text = "It is gone.", .last = {}}),
               EndsWith("fault: It is gone"));
    for (const engine::Trip cause : {engine::Trip::stopped, engine::Trip::focus_lost}) {
        CHECK(explanation(cause).find("Ctrl") == std::string_view::npos);  // the screen shows it
    }
    CHECK_THAT(trouble_text({.sentence = "", .solved = true, .by_hand = true}),
               Has("Ctrl+Shift+P"));
}

TEST_CASE("every sentence of every language is there and says its numbers") {
    const Language language = GENERATE(Language::en, Language::tr);
    const ui::Words& words = ui::words_in(language);
    for (const std::string_view sentence : sentences_of(words)) {
        const auto* row = std::ranges::find_if(kNumbers, [&](const auto& one) {
            return (words.*one.first).data() == sentence.data();
        });
        const int numbers = row == std::end(kNumbers) ? 0 : row->second;
        const std::string text = fmt::format(fmt::runtime(sentence), 1997, 2000);
        CAPTURE(text);
        CHECK_FALSE(text.empty());
        CHECK((text.find("1997") != std::string::npos) == (numbers > 0));
        CHECK((text.find("2000") != std::string::npos) == (numbers > 1));
    }
    CHECK(ui::words_in(Language::en).welcome != ui::words_in(Language::tr).welcome);
}

TEST_CASE("what a trip says is said in the screen's language, and other sentences as they are") {
    for (int i = 1; i <= static_cast<int>(engine::Trip::stopped); ++i) {
        const std::string_view english = explanation(static_cast<engine::Trip>(i));
        const std::string_view turkish = ui::trip_in(Language::tr, english);
        CAPTURE(english, turkish);
        CHECK(ui::trip_in(Language::en, english) == english);
        CHECK(turkish != english);
        CHECK(turkish.find(": ") != std::string_view::npos);  // what happened, and what to do
        for (const std::string_view as_it_is :
             {"stiffness_n_per_m", "rate_hz", "explore_timeout_s", "palpate doctor"}) {
            const bool said = english.find(as_it_is) != std::string_view::npos;
            CHECK((!said || turkish.find(as_it_is) != std::string_view::npos));
        }
        for (int k = 1; k < i; ++k) {
            CHECK(turkish != ui::trip_in(Language::tr, explanation(static_cast<engine::Trip>(k))));
        }
    }
    for (const char* rig : {protocols::kAnother, protocols::kNotProved, protocols::kProofComes,
                            protocols::kButtonGone, protocols::kButtonDown}) {
        CHECK(ui::trip_in(Language::tr, rig) != rig);
        CHECK(ui::trip_in(Language::en, rig) == rig);
    }
    CHECK(ui::trip_in(Language::tr, "the board at /dev/one is gone") ==
          "the board at /dev/one is gone");
}

TEST_CASE("no sentence of the participant's screen gives away the experimenter's chords") {
    const Language language = GENERATE(Language::en, Language::tr);
    const auto words = sentences_of(ui::words_in(language));
    std::vector<std::string_view> sentences(words.begin(), words.end());
    for (int i = 1; i <= static_cast<int>(engine::Trip::stopped); ++i) {
        sentences.push_back(ui::trip_in(language, explanation(static_cast<engine::Trip>(i))));
    }
    for (const std::string_view sentence : sentences) {
        CAPTURE(sentence);
        for (const std::string_view key : {"Ctrl", "Shift", "ctrl", "shift"}) {
            CHECK(sentence.find(key) == std::string_view::npos);
        }
    }
    CHECK(ui::words_in(language).end_of_pause.find("terminal") != std::string_view::npos);
}
