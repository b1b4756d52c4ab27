#pragma once

#include <cstdint>
#include <memory>
#include <string>

namespace palpate::tests {

/// A hand at the real X server: moves the pointer, presses keys and buttons through XTest.
class XHand {
public:
    /// @throws std::runtime_error if the display cannot be opened or has no XTest
    explicit XHand(const std::string& display);
    XHand(const XHand&) = delete;
    XHand& operator=(const XHand&) = delete;
    ~XHand();

    struct Window {
        std::uint64_t id = 0;
        int x = 0;  ///< of the content, on the screen
        int y = 0;
        int width = 0;
        int height = 0;
    };

    /// Waits for a mapped top-level window with this title, and gives it the keyboard.
    /// @throws std::runtime_error after `seconds`
    Window wait_for_window(const std::string& title, double seconds);

    void move(int x, int y);
    void click();
    void key(const std::string& name);  ///< X keysym name: "space", "1", "Right", ...
    /// Checksum of the window's pixels as the screen shows them.
    [[nodiscard]] std::uint64_t pixels(const Window& window);

private:
    struct Connection;
    std::unique_ptr<Connection> x_;
};

}  // namespace palpate::tests
