#pragma once

#include "tests/support/std.hpp"

namespace palpate::tests {

/// What a screen shows, from its upper left corner, row by row.
struct ScreenImage {
    int width = 0;
    int height = 0;
    std::vector<std::uint32_t> pixels{};  ///< 0xRRGGBB

    [[nodiscard]] std::uint32_t at(int x, int y) const {
        return pixels.at(static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                         static_cast<std::size_t>(x));
    }

    friend bool operator==(const ScreenImage&, const ScreenImage&) = default;
};

/// @throws std::runtime_error if it is no picture
[[nodiscard]] ScreenImage read_png(const std::string& file);

/// A hand at the real X server: moves the pointer, presses keys and buttons through XTest.
///
/// A window that is gone when it is asked for, and a server that dies, are no end of the test:
/// Xlib's own handlers would exit.
class XHand {
public:
    /// @throws std::runtime_error if the display cannot be opened or has no XTest
    explicit XHand(const std::string& display);
    XHand(const XHand&) = delete;
    XHand& operator=(const XHand&) = delete;
    ~XHand();

    struct Window {
        std::uint64_t id = 0;  ///< 0: there is none
        int x = 0;             ///< of the content, on the screen
        int y = 0;
        int width = 0;
        int height = 0;
        std::string title{};
    };

    /// The mapped top-level window whose title begins with `title`, as it is now.
    [[nodiscard]] Window find_window(const std::string& title);
    /// Waits for one, and gives it the keyboard. A program may make its window anew while it
    /// starts: the one that has the keyboard and is still there a moment later is taken.
    /// @throws std::runtime_error after `seconds`
    Window wait_for_window(const std::string& title, double seconds);
    /// Gives it the keyboard again, where it may have lost it.
    void focus(const Window& window);

    void move(int x, int y);
    /// Where the pointer is, on the screen.
    [[nodiscard]] std::pair<int, int> place();
    void click();
    /// @param name  X keysym name: "space", "1", "Right", ...; or the number of a key of Linux's
    ///              evdev and 8, as "#33": the place on the keyboard, whatever layout it has
    void key(const std::string& name);
    /// With the control and the shift key held.
    void chord(const std::string& name);
    void press(const std::string& name);  ///< and holds it
    void release(const std::string& name);
    /// Another program's window takes the keyboard, as a dialog does; for as long as this lives.
    void take_keyboard_away();
    /// Asks a window to close, as its frame's button and Alt+F4 do.
    void ask_to_close(const Window& window);
    /// Takes it off the screen, as a window manager does that makes it small; and back.
    void hide(const Window& window);
    void show(const Window& window);
    /// Tells it of a frame around it as window managers do: so many pixels at each side.
    void frame(const Window& window, long left, long right, long top, long bottom);
    /// Checksum of the window's pixels as the screen shows them; 0: it is gone.
    /// @param from  share of its height above what is looked at
    [[nodiscard]] std::uint64_t pixels(const Window& window, double from = 0.0);
    /// What the window shows; empty: it is gone.
    [[nodiscard]] ScreenImage image(const Window& window);

private:
    struct Connection;
    std::unique_ptr<Connection> x_;
};

}  // namespace palpate::tests
