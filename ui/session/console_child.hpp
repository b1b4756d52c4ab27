#pragma once

#include <string>

#include <sys/types.h>

namespace palpate::ui {

/// `palpate console` beside a session, as a process of its own: whatever becomes of it, the session
/// goes on. It ends by itself after the session.
class ConsoleChild {
public:
    /// @param session  its uuid; empty: there is to be none
    explicit ConsoleChild(std::string session);
    ConsoleChild(const ConsoleChild&) = delete;
    ConsoleChild& operator=(const ConsoleChild&) = delete;
    ~ConsoleChild() = default;

    /// Starts it again, once, if it is gone. Waits for nothing.
    void look();

private:
    void start();

    std::string session_;
    pid_t pid_ = -1;
    bool again_ = false;
};

}  // namespace palpate::ui
