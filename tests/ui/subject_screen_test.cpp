#include <atomic>

#include "stimuli/two_curve.hpp"
#include "tests/support/catch.hpp"
#include "tests/ui/keys.hpp"

using namespace palpate;
using namespace palpate::protocols;
using namespace palpate::ui;
using namespace palpate::tests;

namespace {

std::vector<Picture> pictures(std::size_t n) {
    std::vector<Picture> all;
    for (std::size_t i = 0; i < n; ++i) {
        all.push_back({stimuli::silhouette({.curvature = -10.0 + 3.0 * static_cast<double>(i)})});
    }
    return all;
}

}  // namespace

TEST_CASE("a number key chooses the picture of that number, and says how it was given",
          "[screen]") {
    SubjectScreen screen(options());
    const auto five = pictures(5);
    for (int digit = 1; digit <= 5; ++digit) {
        const Later subject([digit] {
            press(SDLK_6);  // no such picture
            press(SDLK_1 + digit - 1);
        });
        const Choice choice = screen.choose(kTrial, which_of(five));
        CHECK(choice.signal == Signal::done);
        CHECK(choice.place == static_cast<std::size_t>(digit - 1));
        CHECK(choice.input == InputKind::key);
        CHECK(choice.reaction_s > 0.0);
        CHECK(choice.reaction_s < 5.0);
        CHECK(choice.uncertainty_s >= 0.0);
        CHECK(choice.uncertainty_s < 1.0);
    }
}

TEST_CASE("a click on a card chooses it, for 2 to 9 pictures, a click beside them does nothing",
          "[screen]") {
    SubjectScreen screen(options());
    for (std::size_t n = 2; n <= 9; ++n) {
        const auto shown = pictures(n);
        const auto cards = lay_out_cards(n, screen.stage().window().size());
        const std::size_t wanted = (3 * n) % n + (n > 4 ? 3 : 1);
        const Later subject([&] {
            click({3.0, 3.0});
            click(cards[wanted].centre());
        });
        const Choice choice = screen.choose(kTrial, which_of(shown));
        CHECK(choice.place == wanted);
        CHECK(choice.input == InputKind::mouse);
    }
}

TEST_CASE("arrows move the mark without wrapping round, and Enter takes it", "[screen]") {
    SubjectScreen screen(options());
    const auto five = pictures(5);
    const auto chosen = [&](std::vector<SDL_Keycode> keys) {
        const Later subject([keys] {
            for (const SDL_Keycode key : keys) {
                press(key);
            }
        });
        return screen.choose(kTrial, which_of(five));
    };
    CHECK(chosen({SDLK_RETURN, SDLK_RIGHT, SDLK_RETURN}).place ==
          0);  // Enter alone chooses nothing
    CHECK(chosen({SDLK_RIGHT, SDLK_RIGHT, SDLK_RIGHT, SDLK_RETURN}).place == 2);
    CHECK(chosen({SDLK_LEFT, SDLK_RETURN}).place == 4);
    CHECK(chosen({SDLK_LEFT, SDLK_RIGHT, SDLK_RIGHT, SDLK_KP_ENTER}).place == 4);
    CHECK(chosen({SDLK_RIGHT, SDLK_LEFT, SDLK_LEFT, SDLK_RETURN}).place == 0);
    CHECK(chosen({SDLK_RIGHT, SDLK_RETURN}).input == InputKind::arrows);
}

TEST_CASE("what was pressed before a screen, or is held down, does not answer it",
          "[screen][law]") {
    SubjectScreen screen(options());
    press(SDLK_1);  // too early
    const Later subject([] {
        press(SDLK_2, KMOD_NONE, true);  // held down
        press(SDLK_3);
    });
    CHECK(screen.choose(kTrial, which_of(pictures(5))).place == 2);
}

TEST_CASE("no key of the subject ends a session, the experimenter's two steps do",
          "[screen][law]") {
    SubjectScreen screen(options());
    {
        const Later subject([] {
            press(SDLK_ESCAPE);
            press(SDLK_q);
            press(SDLK_q, KMOD_CTRL);
            press(SDLK_F4, KMOD_ALT);
            press(SDLK_y);
            press(SDLK_q, static_cast<SDL_Keymod>(KMOD_CTRL | KMOD_SHIFT));
            press(SDLK_n);  // anything but Y takes the question back
            press(SDLK_y);
            press(SDLK_SPACE);
        });
        CHECK(screen.ready(kTrial) == Signal::go_on);
    }
    {
        const Later experimenter([] {
            press(SDLK_q, static_cast<SDL_Keymod>(KMOD_LCTRL | KMOD_LSHIFT));
            press(SDLK_y);
        });
        CHECK(screen.ready(kTrial) == Signal::abort);
    }
    {
        const Later window_closed([] {
            close_window();
            press(SDLK_y);
            press(SDLK_SPACE);
        });
        CHECK(screen.ready(kTrial) == Signal::go_on);
    }
}

TEST_CASE("a signal of the operating system ends any screen", "[screen]") {
    std::atomic<bool> arrived{false};
    SubjectScreenOptions with_signal = options();
    with_signal.interrupted = [&] {
        return arrived.load();
    };
    SubjectScreen screen(with_signal);
    const Later system([&] { arrived = true; });
    CHECK(screen.ready(kTrial) == Signal::abort);
    CHECK(screen.choose(kTrial, which_of(pictures(2))).signal == Signal::abort);
    CHECK(screen.gap(5.0) == Signal::abort);
    CHECK(screen.explore(kTrial, 0.0).signal == Signal::abort);
}

TEST_CASE("done is stamped on the servo's clock, and a call returns within a few ms", "[screen]") {
    SubjectScreen screen(options());
    CHECK(screen.explore(kTrial, 3.0).signal == Signal::go_on);
    press(SDLK_SPACE);
    const ExplorationStep done = screen.explore(kTrial, 7.0);
    CHECK(done.signal == Signal::done);
    CHECK(done.at_s >= 7.0);
    CHECK(done.at_s < 7.5);
    CHECK(done.uncertainty_s >= 0.0);
}

TEST_CASE("the pointer is the handle: its place goes to the device, starting at the start pose",
          "[screen]") {
    std::vector<engine::Vec2> seen;
    SubjectScreenOptions as_handle = options();
    as_handle.on_pointer = [&](const engine::Vec2& p) {
        seen.push_back(p);
    };
    SubjectScreen screen(as_handle);
    static_cast<void>(screen.explore(kTrial, 0.0));
    REQUIRE_FALSE(seen.empty());
    CHECK(seen.front() == engine::Vec2{0.0, 0.060});
    move({600.0, 500.0});
    for (int i = 0; i < 5; ++i) {
        static_cast<void>(screen.explore(kTrial, 0.1 * i));
    }
    CHECK(glm::length(seen.back() - PointerMap{{1024.0, 768.0}}.to_object({600.0, 500.0})) < 1e-12);
}

TEST_CASE("Space begins with the handle at the start alone, where there is a handle",
          "[screen][gate][law]") {
    protocols::Protocol protocol;
    protocol.apparatus.start = {0.0, 0.060};
    std::atomic<double> x{0.010};
    std::atomic<bool> there{true};
    SubjectScreenOptions at = options();
    at.gate = protocols::StartGate(protocol);
    at.place = [&]() -> std::optional<engine::Vec3> {
        return there ? std::optional(engine::Vec3{x.load(), 0.060, 0.0}) : std::nullopt;
    };
    SubjectScreen screen(at);
    std::atomic<int> presses{0};
    {
        const Later subject([&] {
            for (int i = 0; i < 4; ++i) {
                press(SDLK_SPACE);
                press(SDLK_RETURN);
                std::this_thread::sleep_for(std::chrono::milliseconds(100));
                ++presses;
            }
            x = 0.004;
            std::this_thread::sleep_for(std::chrono::milliseconds(200));
            press(SDLK_SPACE);
        });
        CHECK(screen.ready(kTrial) == Signal::go_on);
        CHECK(presses >= 4);  // none of them began it
    }
    x = 1.0;
    there = false;
    const Later subject([] { press(SDLK_SPACE); });
    CHECK(screen.ready(kTrial) == Signal::go_on);
}

TEST_CASE("a question ends unanswered after its time and not before, the confidence too",
          "[screen][law]") {
    SubjectScreen screen(options());
    Question question{.kind = ResponseKind::two_interval,
                      .text = {},
                      .pictures = {},
                      .answers = 2,
                      .labels = {},
                      .confidence = true,
                      .timeout_s = 1.5};
    {
        const Later too_late([] { press(SDLK_1); }, 2500);
        CHECK(screen.choose(kTrial, question).signal == Signal::too_late);
    }
    {
        const Later subject([] { press(SDLK_1); });
        CHECK(screen.choose(kTrial, question).signal == Signal::too_late);
    }
    question.confidence = false;
    question.timeout_s = 60.0;
    const Later subject([] { press(SDLK_1); });
    CHECK(screen.choose(kTrial, question).signal == Signal::done);
}
