#pragma once

#include <condition_variable>
#include <mutex>
#include <stop_token>

#include "stimuli/two_curve.hpp"
#include "ui/sdl/sdl.hpp"
#include "ui/subject/subject_screen.hpp"
#include "tests/support/std.hpp"

/// Hands at the subject's screen, through SDL's queue.
namespace palpate::tests {

/// Windows of this program are drawn into memory from now on: no display is needed, and none is
/// used.
inline void draw_into_memory() {
    setenv("SDL_VIDEODRIVER", "dummy", 1);
}

PALPATE_LATE(ui::Sdl, SDL_PushEvent);

/// Of the experimenter's keys.
inline constexpr auto kChord = static_cast<SDL_Keymod>(KMOD_LCTRL | KMOD_LSHIFT);

inline void press(SDL_Keycode key, SDL_Keymod modifiers = KMOD_NONE, bool repeat = false) {
    SDL_Event event{};
    event.type = SDL_KEYDOWN;
    event.key.keysym.sym = key;
    event.key.keysym.mod = static_cast<Uint16>(modifiers);
    event.key.repeat = repeat ? 1 : 0;
    SDL_PushEvent(&event);
}

inline void let_go(SDL_Keycode key) {
    SDL_Event event{};
    event.type = SDL_KEYUP;
    event.key.keysym.sym = key;
    SDL_PushEvent(&event);
}

inline void close_window() {
    SDL_Event event{};
    event.type = SDL_QUIT;
    SDL_PushEvent(&event);
}

inline void click(const engine::Vec2& at) {
    SDL_Event event{};
    event.type = SDL_MOUSEBUTTONDOWN;
    event.button.button = SDL_BUTTON_LEFT;
    event.button.x = static_cast<int>(at.x);
    event.button.y = static_cast<int>(at.y);
    SDL_PushEvent(&event);
}

inline void move(const engine::Vec2& at) {
    SDL_Event event{};
    event.type = SDL_MOUSEMOTION;
    event.motion.x = static_cast<int>(at.x);
    event.motion.y = static_cast<int>(at.y);
    SDL_PushEvent(&event);
}

/// Somebody who acts after the screen has appeared, also where drawing is slow (sanitizers), and
/// again where a busy machine had not shown it by then: what comes before a screen is no answer to
/// it.
class Later {
public:
    explicit Later(std::function<void()> act, int after_ms = 500)
        : thread_([act = std::move(act), after_ms](const std::stop_token& answered) {
              std::this_thread::sleep_for(std::chrono::milliseconds(after_ms));
              act();
              std::mutex alone;
              std::unique_lock lock(alone);
              std::condition_variable_any wake;
              while (!wake.wait_for(lock, answered, std::chrono::seconds(5),
                                    [&] { return answered.stop_requested(); })) {
                  act();
              }
          }) {}

private:
    std::jthread thread_;
};

inline ui::SubjectScreenOptions options() {
    draw_into_memory();
    ui::SubjectScreenOptions options;
    options.window.width = 1024;
    options.window.height = 768;
    options.guard_s = 0.0;  // tests of the guard time set it
    return options;
}

/// Without words of its own; of pictures, those of so many arcs.
inline protocols::Question question(protocols::ResponseKind kind,
                                    std::size_t answers = 2,
                                    bool confidence = false) {
    protocols::Question asked{.kind = kind,
                              .text = {},
                              .pictures = {},
                              .answers = answers,
                              .labels = {},
                              .confidence = confidence};
    static const std::vector<protocols::Picture> pictures = [] {
        std::vector<protocols::Picture> all;
        for (const double curvature : {-10.0, -7.0, -4.0, -1.0, 2.0, 5.0, 8.0, 11.0, 14.0}) {
            all.push_back({stimuli::silhouette({.curvature = curvature})});
        }
        return all;
    }();
    if (kind == protocols::ResponseKind::identification) {
        asked.pictures = std::span(pictures).first(answers);
    }
    return asked;
}

inline constexpr protocols::TrialView kTrial{.number = 3,
                                             .total = 10,
                                             .explore_min_s = 2.0,
                                             .explore_prompt_s = 30.0,
                                             .explore_timeout_s = 45.0};

}  // namespace palpate::tests
