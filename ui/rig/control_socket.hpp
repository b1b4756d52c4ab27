#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <poll.h>

#include "ui/rig/control_line.hpp"

namespace palpate::ui {

/// Somebody who asks a session for something.
class Caller {
public:
    Caller(Descriptor line, bool trusted) : line_(std::move(line)), trusted_(trusted) {}

    /// The same user or root: may ask for anything. Else: for no force, and nothing more.
    [[nodiscard]] bool trusted() const noexcept { return trusted_; }
    [[nodiscard]] int descriptor() const noexcept { return line_.get(); }
    /// One line of JSON, and with it an open file (< 0: none). Any thread; waits for nobody.
    void answer(bool ok, std::string_view text, std::string_view word = {}) const noexcept;
    void answer_line(std::string_view line, int file = -1) const noexcept {
        send_line(line_.get(), line, file);
    }

private:
    Descriptor line_;
    bool trusted_;
};

/// The session's side of its control socket: one JSON object a line, one answer a line. Whoever
/// runs as the same user or as root may call, and whoever can open the database for writing: its
/// open file comes with their first line. Everybody else is hung up on, unheard.
class ControlSocket {
public:
    /// Hears a line, without its end.
    using Obey = std::function<void(const std::string&, const std::shared_ptr<Caller>&)>;

    /// @param database  a file that is there; empty: of none yet
    explicit ControlSocket(const std::string& database);

    /// Adds what is to be polled.
    void add_to(std::vector<pollfd>& lines) const;
    /// Takes callers and hears what they ask by now; waits for nobody. A line that is too long, and
    /// a caller that is silent for long, are given up.
    void hear(const Obey& obey);

private:
    struct Line {
        std::shared_ptr<Caller> caller;
        bool may_speak = false;  ///< it showed its right
        std::string begun{};     ///< of a line
        std::chrono::steady_clock::time_point heard{};
    };
    void accept_callers();
    [[nodiscard]] bool hear(Line& line, const Obey& obey) const;

    FileIdentity file_;
    Descriptor listening_;
    std::vector<Line> lines_;
};

}  // namespace palpate::ui
