#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <thread>

#include <termios.h>

#include "ui/rig/control_line.hpp"

namespace palpate::ui {

/// A button named for the rig, as a device of Linux's evdev (/dev/input/by-id/...), or a named pipe
/// into which another program writes such events. Any key of it stops. While this lives no other
/// program gets its presses (EVIOCGRAB); of a pipe nobody can promise that.
class StopButton {
public:
    /// What was seen since the last look.
    enum class ButtonState : std::uint8_t {
        nothing,
        pressed,  ///< now, or in between: also where the kernel says that it had to drop events
        gone,     ///< unplugged, or it cannot be read
    };

    /// @throws std::invalid_argument if it is not there, is no such device, is pressed, or belongs
    /// to another program
    explicit StopButton(std::string file);

    /// To be polled for reading; -1: gone.
    [[nodiscard]] int descriptor() const noexcept { return button_.get(); }
    /// Never waits. Of several, what matters most.
    [[nodiscard]] ButtonState look() noexcept;
    /// A key of it is held down.
    [[nodiscard]] bool down() const noexcept { return down_ > 0; }
    /// After gone: it is there again, and nobody presses it. Never waits.
    [[nodiscard]] bool reopen() noexcept;
    [[nodiscard]] const std::string& file() const noexcept { return file_; }

private:
    /// @return what is wrong; empty: it is open
    [[nodiscard]] std::string open_it();

    std::string file_;
    Descriptor button_{};
    int down_ = 0;  ///< keys that are
};

/// While one of these lives what is typed answers a question, and stops nothing.
class TypedAnswer {
public:
    /// Several may live at a time: the last one to go ends it.
    TypedAnswer() { ++living; }
    TypedAnswer(const TypedAnswer&) = delete;
    TypedAnswer& operator=(const TypedAnswer&) = delete;
    ~TypedAnswer() { --living; }

    static inline std::atomic<int> living{0};
};

inline constexpr std::string_view kStopButtonWords =
    "A button that switches the force off, as a file of /dev/input/by-id; palpate alone gets its "
    "presses, and without it there is no force";

/// @param file  empty: the rig has none   @throws as StopButton
[[nodiscard]] inline std::shared_ptr<StopButton> named_button(const std::string& file) {
    return file.empty() ? nullptr : std::make_shared<StopButton>(file);
}

inline constexpr char kEscapeByte = 27;  ///< as a terminal sends it

/// What stops a session's force without its window: Enter or Escape at the terminal of `run` (a
/// line, where standard input is a pipe), `palpate stop` from any shell, and a button. A thread of
/// its own waits for them, so that neither the screen nor the session's loop has to be quick.
///
/// The terminal stays as it is but for one thing: Escape ends a line as Enter does (VEOL), until
/// this is gone. A program that is killed leaves that behind, and no shell minds it.
class StopLines {
public:
    struct Acts {
        std::function<void(const char*)> stop;  ///< on the thread; by which way
        /// No force while this sentence stands; none: nothing any more.
        std::function<void(const char*)> bar = [](const char*) {
        };
        std::function<bool()> doubts{};  ///< nothing proves that the force is off; none: never
        bool types = true;           ///< somebody feels it: Enter and Escape at the terminal stop
        bool pipes = true;           ///< a line stops where standard input is a pipe, too
        ControlSocket::Obey obey{};  ///< hears all but "stop", on the thread; none: nobody does
    };

    /// @param database  see ControlSocket   @param label  of the session, for whoever stops it
    /// @param button    none: there is no button
    StopLines(const std::string& database,
              std::string label,
              std::shared_ptr<StopButton> button,
              Acts acts);
    ~StopLines();

private:
    void live() noexcept;
    void obey(const std::string& line, const std::shared_ptr<Caller>& caller);
    void look_at_terminal();
    void look_at_button();
    void await_button();

    ControlSocket control_;
    std::string label_;
    std::shared_ptr<StopButton> button_;
    Acts acts_;
    bool listens_ = false;  ///< to standard input
    bool terminal_ = false;
    termios before_{};
    std::atomic<bool> end_{false};
    std::thread thread_;
};

}  // namespace palpate::ui
