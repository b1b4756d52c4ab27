#include "ui/rig/control_line.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <span>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <nlohmann/json.hpp>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include "engine/base/clock.hpp"
#include "data/store/disk_space.hpp"
#include "data/store/session_lock.hpp"
#include "ui/rig/json_line.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {
namespace {

constexpr std::string_view kPrefix = "palpate-control/";
constexpr const char* kNoFile = "/proc/self/exe";  ///< stands for a database that is not there yet
constexpr int kSessions = 8;                       ///< of one file
constexpr int kTries = 100;                        ///< at a session that many call at once
constexpr int kTryMs = 2;

std::string control_name(const FileIdentity& file, int k) {
    return fmt::format("{}{:x}-{:x}-{}", kPrefix, file.device, file.inode, k);
}

/// An abstract name: the first byte is 0.
std::pair<sockaddr_un, socklen_t> address_of(std::string_view name) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    name = name.substr(0, sizeof address.sun_path - 1);
    std::memcpy(address.sun_path + 1, name.data(), name.size());
    return {address, static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size())};
}

Descriptor control_socket() {
    return Descriptor(socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
}

/// Under a free name of the file; < 0: all are taken, nobody can call.
Descriptor listen_for(const FileIdentity& file) {
    for (int k = 0; k < kSessions; ++k) {
        Descriptor listening = control_socket();
        const auto [address, length] = address_of(control_name(file, k));
        const auto* at = reinterpret_cast<const sockaddr*>(&address);  // NOLINT
        if (listening.get() >= 0 && bind(listening.get(), at, length) == 0 &&
            listen(listening.get(), SOMAXCONN) == 0) {
            return listening;
        }
    }
    return Descriptor();
}

constexpr std::size_t kLongestLine = 8192;
constexpr std::size_t kCallers = 16;
constexpr std::chrono::seconds kSilence{10};

/// The open file is the database's log, and open for writing. Not the database: closing it here
/// would drop SQLite's locks on it, and another program would take the log away.
bool shows_right(const Descriptor& right, const std::string& database) {
    struct stat shown {};
    const std::string log = data::log_of(database);
    const auto file = log.empty() ? std::nullopt : identity_of(log);
    return file && right.get() >= 0 && fstat(right.get(), &shown) == 0 &&
           shown.st_dev == file->device && shown.st_ino == file->inode &&
           (fcntl(right.get(), F_GETFL) & O_ACCMODE) != O_RDONLY;
}

constexpr int kAnswerMs = 2000;  ///< a session's time to answer

/// A whole one until `end`, on the clock of monotonic_ns(), or none.
Received line_from(const Descriptor& from, std::int64_t end) {
    Received answer;
    while (!answer.ended && !answer.line.ends_with('\n')) {
        const std::int64_t left = (end - monotonic_ns()) / kMillisecond;
        if (!readable(from.get(), static_cast<int>(std::max<std::int64_t>(left, 0)))) {
            return {};
        }
        Received more = receive(from.get());
        answer.ended = more.ended;
        answer.line += more.line;
        if (more.file.get() >= 0) {
            answer.file = std::move(more.file);
        }
    }
    return answer;
}

}  // namespace

std::optional<FileIdentity> identity_of(const std::string& database) {
    struct stat file {};
    if (stat(database.empty() ? kNoFile : database.c_str(), &file) != 0) {
        return std::nullopt;
    }
    return FileIdentity{.device = file.st_dev, .inode = file.st_ino};
}

Descriptor connect_to(const std::string& name) {
    Descriptor line = control_socket();
    const auto [address, length] = address_of(name);
    const auto* at = reinterpret_cast<const sockaddr*>(&address);  // NOLINT
    for (int tries = 0; tries < kTries; ++tries) {
        if (connect(line.get(), at, length) == 0) {
            return line;
        }
        if (errno != EAGAIN) {
            break;
        }
        poll(nullptr, 0, kTryMs);
    }
    return Descriptor();
}

Descriptor listening_at(std::uint32_t address) {
    Descriptor listening(socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    sockaddr_in here{};
    here.sin_family = AF_INET;
    here.sin_addr.s_addr = address;
    const auto* at = reinterpret_cast<const sockaddr*>(&here);  // NOLINT
    return bind(listening.get(), at, sizeof here) == 0 && listen(listening.get(), SOMAXCONN) == 0
             ? std::move(listening)
             : Descriptor();
}

std::vector<std::string> session_names(const std::optional<std::string>& database) {
    std::vector<std::string> names;
    if (!database) {
        std::ifstream table("/proc/net/unix");
        for (std::string line; std::getline(table, line);) {
            const std::size_t at = line.find("@" + std::string(kPrefix));
            if (at != std::string::npos && line.find(" 00010000 ") != std::string::npos) {
                names.push_back(line.substr(at + 1));
            }
        }
        return names;
    }
    for (const std::string& of : {*database, std::string()}) {
        const auto file = identity_of(of);
        for (int k = 0; k < kSessions && file; ++k) {
            names.push_back(control_name(*file, k));
        }
    }
    return names;
}

void warn_of_unblinding(const std::string& database) {
    static bool said = false;
    if (!said && data::SessionLock::all_held(database) > 0) {
        said = true;
        warn("{}: a session runs on it, and this may tell you what its participant feels",
             database);
    }
}

bool readable(int descriptor, int wait_ms) {
    pollfd one{.fd = descriptor, .events = POLLIN, .revents = 0};
    return poll(&one, 1, wait_ms) > 0;
}

bool send_line(int to, std::string_view line, int file) noexcept {
    char end = '\n';
    char* const begun = const_cast<char*>(line.data());  // NOLINT: it is only read
    std::array parts{iovec{.iov_base = begun, .iov_len = line.size()},
                     iovec{.iov_base = &end, .iov_len = 1}};
    return send_with_file(to, parts, file, MSG_NOSIGNAL | MSG_DONTWAIT) ==
           static_cast<ssize_t>(line.size() + 1);
}

Received receive(int from) {
    std::array<char, 4096> bytes{};
    int file = -1;
    const ssize_t got = receive_with_file(from, std::as_writable_bytes(std::span(bytes)), file,
                                          MSG_DONTWAIT | MSG_CMSG_CLOEXEC);
    Received received;
    if (got <= 0) {
        received.ended = got == 0 || (errno != EAGAIN && errno != EINTR);
        return received;
    }
    received.line.assign(bytes.data(), static_cast<std::size_t>(got));
    received.file = Descriptor(file);
    return received;
}

bool Caller::gave_up() const noexcept {
    pollfd line{.fd = descriptor(), .events = 0, .revents = 0};
    return poll(&line, 1, 0) > 0;
}

void Caller::answer(bool ok, std::string_view text, std::string_view word) const noexcept {
    try {
        answer_line(answer_of(ok, text, word));
    } catch (const std::exception&) {  // no memory: whoever asked hears nothing
    }
}

ControlSocket::ControlSocket(const std::string& database) : database_(database) {
    if (const auto file = identity_of(database)) {
        listening_ = listen_for(*file);
    }
}

void ControlSocket::add_to(std::vector<pollfd>& lines) const {
    lines.push_back({.fd = listening_.get(), .events = POLLIN, .revents = 0});
    for (const Line& line : lines_) {
        lines.push_back({.fd = line.caller->descriptor(), .events = POLLIN, .revents = 0});
    }
}

void ControlSocket::accept_callers(const Obey& obey) {
    for (std::size_t i = 0; i < kCallers && listening_.get() >= 0; ++i) {  // then they are heard
        Descriptor one(accept4(listening_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
        if (one.get() < 0) {
            return;
        }
        ucred who{};
        socklen_t size = sizeof who;
        const bool trusted = getsockopt(one.get(), SOL_SOCKET, SO_PEERCRED, &who, &size) == 0 &&
                             (who.uid == geteuid() || who.uid == 0);
        if (lines_.size() == kCallers) {  // who said nothing for longest makes room, once heard
            const auto oldest = std::ranges::min_element(lines_, {}, &Line::heard);
            static_cast<void>(hear(*oldest, obey));
            lines_.erase(oldest);
        }
        lines_.push_back({.caller = std::make_shared<Caller>(std::move(one), trusted),
                          .may_speak = trusted,
                          .heard = std::chrono::steady_clock::now()});
    }
}

/// @return false: to be given up
bool ControlSocket::hear(Line& line, const Obey& obey) const {
    const Received received = receive(line.caller->descriptor());
    const auto now = std::chrono::steady_clock::now();
    if (received.line.empty()) {
        return !received.ended && now - line.heard < kSilence;
    }
    line.heard = now;
    line.may_speak = line.may_speak || shows_right(received.file, database_);
    if (!line.may_speak) {
        return false;
    }
    line.begun += received.line;
    for (std::size_t end = 0; (end = line.begun.find('\n')) != std::string::npos;) {
        const std::string whole = line.begun.substr(0, end);
        line.begun.erase(0, end + 1);
        try {
            obey(whole, line.caller);
        } catch (const std::exception&) {  // no memory for a sentence: what it asked was done first
            return false;
        }
    }
    return !received.ended && line.begun.size() < kLongestLine;
}

void ControlSocket::hear(const Obey& obey) {
    accept_callers(obey);
    std::erase_if(lines_, [&](Line& line) { return !hear(line, obey); });
}

StopResult stop_sessions(const std::optional<std::string>& database) {
    const Descriptor right(database ? open(data::log_of(*database).c_str(), O_RDWR | O_CLOEXEC)
                                    : -1);
    std::vector<Descriptor> lines;
    StopResult stopped;
    int of_file = database && identity_of(*database) ? kSessions : 0;  // its names come first
    for (const std::string& name : session_names(database)) {
        Descriptor line = connect_to(name);
        const bool is_there = line.get() >= 0 || errno == EAGAIN;
        stopped.on_file += of_file-- > 0 && is_there ? 1U : 0U;
        if (line.get() >= 0) {
            send_line(line.get(), database ? R"({"do":"stop"})" : R"({"do":"stop","people":true})",
                      right.get());
            lines.push_back(std::move(line));
        } else if (is_there) {
            ++stopped.uncalled;
        }
    }
    const std::int64_t end = monotonic_ns() + kAnswerMs * kMillisecond;
    for (const Descriptor& line : lines) {
        const Received said = line_from(line, end);
        const data::Json answer = object_in(said.line);
        const bool ok = answer.value("ok", false);
        const bool heard = said.ended || !said.line.empty();
        const bool off = ok && answer.value("proved", true);
        (off     ? stopped.sessions
         : ok    ? stopped.unproved
         : heard ? stopped.refused
                 : stopped.silent) += 1;
        (off ? stopped.labels : stopped.doubtful) += ok ? answer.value("text", "") : "";
    }
    return stopped;
}

Received ask_session(const std::string& name, const std::string& line) {
    const Descriptor to = connect_to(name);
    return to.get() >= 0 && send_line(to.get(), line)
             ? line_from(to, monotonic_ns() + kAnswerMs * kMillisecond)
             : Received();
}

}  // namespace palpate::ui
