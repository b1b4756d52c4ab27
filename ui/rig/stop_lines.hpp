#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <thread>

#include <termios.h>

#include "ui/rig/control_socket.hpp"
#include "ui/rig/stop_button.hpp"

namespace palpate::ui {

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
        std::function<void(const char*)>
            bar;            ///< no force while this sentence stands; none: nothing any more
        bool types = true;  ///< somebody feels it: Enter and Escape at the terminal stop
        bool pipes = true;  ///< a line stops where standard input is a pipe, too
        ControlSocket::Obey obey{};  ///< hears all but "stop", on the thread; none: nobody does
    };

    /// @param database  see ControlSocket   @param label  of the session, for whoever stops it
    /// @param button    none: there is no button
    StopLines(const std::string& database,
              std::string label,
              std::shared_ptr<StopButton> button,
              Acts acts);
    StopLines(const StopLines&) = delete;
    StopLines& operator=(const StopLines&) = delete;
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

/// While one of these lives what is typed answers a question, and stops nothing.
class TypedAnswer {
public:
    /// Several may live at a time: the last one to go ends it.
    TypedAnswer();
    TypedAnswer(const TypedAnswer&) = delete;
    TypedAnswer& operator=(const TypedAnswer&) = delete;
    ~TypedAnswer();
};

}  // namespace palpate::ui
