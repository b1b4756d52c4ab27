#pragma once

#include <cstdint>
#include <string>
#include <vector>

struct SDL_Window;

/// The display behind the subject's window: is one there that a person sees, and is it still there?
namespace palpate::ui {

/// What was found of the display.
struct FoundDisplay {
    enum class State : std::uint8_t {
        none,    ///< nobody named one: sessions run without a window
        ready,   ///< a window can be opened there
        broken,  ///< one is named, and cannot be opened
    } state = State::none;
    std::string trouble{};                ///< of broken: what was named and what to do, a sentence
    std::vector<std::string> monitors{};  ///< of ready: "DP-1, 1920 x 1080 at (0, 0)"
};

/// Looks at DISPLAY, WAYLAND_DISPLAY and SDL_VIDEODRIVER, and tries what they name.
[[nodiscard]] FoundDisplay find_display();

/// SDL opens what DISPLAY and WAYLAND_DISPLAY name, or not: SDL_GetError() tells why. By itself it
/// would go on to drivers that draw into memory, where nobody sees the session: those are had by
/// SDL_VIDEODRIVER only.
[[nodiscard]] bool open_display();

/// A person sees (or hears) what this driver of SDL draws (or plays). @param driver may be null: no
[[nodiscard]] bool is_real(const char* driver) noexcept;

/// From now on neither the death of the X server nor the end of `window` by another program ends
/// this one (Xlib's own way is exit(1), wherever it is): display_lost() tells of it, and nobody may
/// draw any more. Where Xlib cannot be asked for this (before 1.8), it stays as it was.
void watch_display(SDL_Window* window);

/// Asks the watched display for a sign of life, which comes with the events behind all that
/// happened before; unless it still owes one, or was asked within the last 20 ms. Never waits. A
/// display that cannot be asked (other than X11) owes nothing.
void ask_display() noexcept;
/// It was asked and has not answered: it stands still, or is busy, and so are keys on their way to
/// us.
[[nodiscard]] bool display_owes_answer() noexcept;

/// What is typed does not come to the watched window now: another one has the keyboard, or another
/// program holds it. Asks the display, and waits for its answer. Where nobody sees what is drawn,
/// nobody types elsewhere.
[[nodiscard]] bool keyboard_is_elsewhere() noexcept;
/// The watched window lost the keyboard since this was asked last, for however short a time.
[[nodiscard]] bool keyboard_was_lost() noexcept;

/// The watched display is gone for good.
[[nodiscard]] bool display_lost() noexcept;

}  // namespace palpate::ui
