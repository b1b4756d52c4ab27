#pragma once

#include "tests/support/test_text.hpp"
#include "tests/support/x_hand.hpp"
#include "tests/support/xvfb.hpp"

namespace palpate::tests {

/// Environment of a program in a window on an X display.
[[nodiscard]] Words shown_on(const std::string& display);

/// Presses once what goes on from the screen that is shown, and gives the program a moment to show
/// another: the first answer at a question, the experimenter's chord at a pause and at a trouble
/// (which a busy machine may make at any time) that Space does not end, elsewhere Space.
void press_on(XHand& hand);
/// Goes on from a trouble or a pause, where there is one.
void leave_trouble(XHand& hand);

/// The program in a real window on a screen of its own, driven by keys and clicks, looked at
/// through its title, its output and its database. Every wait is for something to be seen, and is
/// generous: a machine under load is slow, not wrong.
class WindowSession {
public:
    static constexpr double kPatience = 150.0;  ///< s

    struct Screen {
        int width = 1280;
        int height = 800;
        bool second = false;  ///< a second screen, of 1024 x 768, and the program is on that
    };

    /// Starts `palpate ARGUMENTS...`, e.g. run; they name its database by --db, in a folder that
    /// outlives this.
    WindowSession(const Words& arguments, const Words& environment, const Screen& screen);
    explicit WindowSession(const Words& arguments) : WindowSession(arguments, {}, Screen{}) {}

    /// Waits until the program shows the screen `name` ("ready", "explore", ...) and the window has
    /// the keyboard.
    /// @throws std::runtime_error after kPatience, or when the program has ended: which screen it
    ///         was, and what it printed
    XHand::Window wait_for_screen(const std::string& name);
    /// Waits until it shows another one than `name`.
    XHand::Window wait_past(const std::string& name);
    /// The name of what it shows now; empty: no window.
    [[nodiscard]] std::string screen_name();

    /// Waits for `name`, presses `key` there until something else is shown. A press that comes too
    /// early for the screen is made again.
    void press_at(const std::string& name, const std::string& key);

    /// Presses Space at each of these screens, one after the other.
    void go_through(std::initializer_list<const char*> names);

    /// Waits until `name` or a trouble is shown, and leaves the trouble. @return it was `name`
    [[nodiscard]] bool comes_to(const std::string& name);
    /// Goes on from screen to screen, whatever a busy machine ends, and explores until `there`.
    /// @return it is, within kPatience
    [[nodiscard]] bool goes_on_until(const std::function<bool()>& there);

    /// The first column of the first row of `query`, as text, read from outside; empty: no row,
    /// NULL, or no such file yet.
    [[nodiscard]] std::string ask(const std::string& query) const;
    /// Waits until `query` gives `wanted`. @throws std::runtime_error after kPatience
    void wait_until(const std::string& query, const std::string& wanted);
    /// Waits until standard output or standard error holds `text`.
    void wait_for_text(const std::string& text);

    /// Waits to the program's end, however it comes.
    [[nodiscard]] Finished finish() { return program_.wait(); }

    [[nodiscard]] XHand& hand() { return hand_; }
    [[nodiscard]] Process& program() { return program_; }
    [[nodiscard]] Xvfb& screen() { return screen_; }
    [[nodiscard]] const std::string& database() const { return database_; }

private:
    template <class Seen>
    void wait(const std::string& what, const Seen& seen);

    Xvfb screen_;
    std::string display_;
    XHand hand_;
    std::string database_;
    Process program_;
    std::uint64_t focused_ = 0;  ///< the window that was given the keyboard
};

/// A pilot session of P1 with the pointer, of a study's text, in a folder of its own.
class PointerSession : private TemporaryFolder, public WindowSession {
public:
    explicit PointerSession(const std::string& study = four_trials(),
                            const Words& more = {},
                            const Screen& screen = Screen{});
};

}  // namespace palpate::tests
