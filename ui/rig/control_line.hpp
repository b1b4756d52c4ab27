#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <poll.h>
#include <unistd.h>

#include "engine/base/descriptor.hpp"

/// Names and lines of the sockets by which running sessions are called: in Linux's abstract names,
/// which end with their process, so that nothing is left of a crash. One is named for its
/// database's file system and inode; several sessions on one file have one each.
namespace palpate::ui {

/// What a file is, whatever it is called.
struct FileIdentity {
    unsigned long long device = 0;
    unsigned long long inode = 0;
};
/// @param database  empty: what stands for one that is not there yet. @return none: no such file
[[nodiscard]] std::optional<FileIdentity> identity_of(const std::string& database);

/// < 0: nobody listens there, or too many call (errno EAGAIN).
[[nodiscard]] Descriptor connect_to(const std::string& name);
/// At a free port of an address of this machine (IPv4, network order), for many who call at once.
/// < 0: errno says why.
[[nodiscard]] Descriptor listening_at(std::uint32_t address);
/// Where sessions of a file may listen; without one, of every session on this machine.
[[nodiscard]] std::vector<std::string> session_names(const std::optional<std::string>& database);

/// Of a command that shows stimuli and answers of a file: says once where a session runs on it.
void warn_of_unblinding(const std::string& database);

/// Whether something can be read within `wait_ms`.
[[nodiscard]] bool readable(int descriptor, int wait_ms);
/// A line and its end, and with it an open file (< 0: none). Waits for nobody. @return all of it
/// went out
bool send_line(int to, std::string_view line, int file = -1) noexcept;

/// What came from the other side.
struct Received {
    std::string line;
    Descriptor file{};   ///< that came with it
    bool ended = false;  ///< nothing more will
};
/// What has come so far; waits for nothing.
[[nodiscard]] Received receive(int from);

/// Somebody who asks a session for something.
class Caller {
public:
    Caller(Descriptor line, bool trusted) : line_(std::move(line)), trusted_(trusted) {}

    /// The same user or root: may ask for anything. Else: for no force, and nothing more.
    [[nodiscard]] bool trusted() const noexcept { return trusted_; }
    [[nodiscard]] int descriptor() const noexcept { return line_.get(); }
    /// Hung up: nobody waits for the answer. Who only ends what they say is still there.
    [[nodiscard]] bool gave_up() const noexcept;
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
/// runs as the same user or as root may call, and whoever can open the database's log for writing:
/// its open file comes with their first line. Everybody else is hung up on, unheard.
class ControlSocket {
public:
    /// Hears a line, without its end.
    using Obey = std::function<void(const std::string&, const std::shared_ptr<Caller>&)>;

    /// @param database  a file that is there; empty: of none yet
    explicit ControlSocket(const std::string& database);

    /// False: so many sessions run on the file that nobody can call this one.
    [[nodiscard]] bool listens() const noexcept { return listening_.get() >= 0; }
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
    void accept_callers(const Obey& obey);
    [[nodiscard]] bool hear(Line& line, const Obey& obey) const;

    std::string database_;
    Descriptor listening_;
    std::vector<Line> lines_;
};

// The other side of a session's control socket: whoever asks for something.

/// What became of those that were asked to stop.
struct StopResult {
    std::size_t sessions = 0;  ///< without force
    std::string labels{};      ///< of these, a line each
    std::size_t unproved = 0;  ///< obeyed, and nothing proves that the motors are off
    std::string doubtful{};    ///< labels of these, a line each
    std::size_t refused = 0;
    std::size_t silent = 0;    ///< hang, and did not answer within 2 s
    std::size_t uncalled = 0;  ///< hang, and so many call that one more does not get through
    std::size_t on_file = 0;   ///< of all these: sessions on the database, not before one
};

/// Stops the sessions that run on a database, or, without one, every session that this user may
/// stop. Calls all before it hears any: one that hangs keeps nobody else's force on.
[[nodiscard]] StopResult stop_sessions(const std::optional<std::string>& database);

/// @param name  of session_names()   @param line  JSON, without its end
/// @return a line of JSON; empty: it hung up, or did not answer within 2 s
[[nodiscard]] Received ask_session(const std::string& name, const std::string& line);

}  // namespace palpate::ui
