#include "tests/support/catch.hpp"
#include "tests/ui/keys.hpp"

using namespace palpate::protocols;
using namespace palpate::ui;

TEST_CASE("what was pressed before a screen, or is held down, does not answer it") {
    SubjectScreen screen(options());
    press(SDLK_1);  // too early
    const Later subject([] {
        press(SDLK_1, KMOD_NONE, true);  // held down
        press(SDLK_2);
    });
    CHECK(screen.choose(kTrial, question(ResponseKind::yes_no)).place == 1);
}

TEST_CASE("no key of the subject ends a session, the experimenter's two steps do") {
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
            press(SDLK_q, kChord);
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

TEST_CASE("a signal of the operating system ends any screen") {
    std::atomic<bool> arrived{false};
    SubjectScreenOptions with_signal = options();
    with_signal.interrupted = [&] {
        return arrived.load();
    };
    SubjectScreen screen(with_signal);
    const Later system([&] { arrived = true; });
    CHECK(screen.ready(kTrial) == Signal::abort);
    CHECK(screen.choose(kTrial, question(ResponseKind::yes_no)).signal == Signal::abort);
    CHECK(screen.gap(5.0) == Signal::abort);
    CHECK(screen.explore(kTrial, 0.0).signal == Signal::abort);
}

TEST_CASE("done is stamped on the servo's clock, and a call returns within a few ms") {
    SubjectScreen screen(options());
    CHECK(screen.explore(kTrial, 3.0).signal == Signal::go_on);
    press(SDLK_SPACE);
    const ExplorationStep done = screen.explore(kTrial, 7.0);
    CHECK(done.signal == Signal::done);
    CHECK(done.at_s >= 7.0);
    CHECK(done.at_s < 7.5);
    CHECK(done.uncertainty_s >= 0.0);
}

TEST_CASE("the pointer is the handle: its place goes to the device, starting at the start pose") {
    std::vector<engine::Vec2> seen;
    protocols::Protocol protocol;
    protocol.apparatus.start = {0.0, 0.060};
    SubjectScreenOptions as_handle = options();
    as_handle.gate = protocols::StartGate(protocol);
    as_handle.on_pointer = [&](const engine::Vec2& p) {
        seen.push_back(p);
    };
    SubjectScreen screen(as_handle);
    static_cast<void>(screen.explore(kTrial, 0.0));
    REQUIRE_FALSE(seen.empty());
    CHECK(glm::length(seen.front() - engine::Vec2{0.0, 0.060}) < 0.0005);  // a pixel
    move({600.0, 500.0});
    for (int i = 0; i < 5; ++i) {
        static_cast<void>(screen.explore(kTrial, 0.1 * i));
    }
    CHECK(glm::length(seen.back() - PointerMap{{1024.0, 768.0}}.to_object({600.0, 500.0})) < 1e-12);
}

TEST_CASE("Space begins with the handle at the start alone, where there is a handle") {
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

TEST_CASE("a question ends unanswered after its time and not before, the confidence too") {
    SubjectScreen screen(options());
    Question asked = question(ResponseKind::yes_no, 2, true);
    asked.timeout_s = 1.5;
    {
        const Later too_late([] { press(SDLK_1); }, 2500);
        CHECK(screen.choose(kTrial, asked).signal == Signal::too_late);
    }
    {
        const Later subject([] { press(SDLK_1); });
        CHECK(screen.choose(kTrial, asked).signal == Signal::too_late);
    }
    asked.confidence = false;
    asked.timeout_s = 60.0;
    const Later subject([] { press(SDLK_1); });
    CHECK(screen.choose(kTrial, asked).signal == Signal::done);
}
