#include "ui/rig/control_socket.hpp"

#include <algorithm>
#include <utility>

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <sys/socket.h>
#include <sys/stat.h>

#include "data/csv/json_text.hpp"

namespace palpate::ui {
namespace {

constexpr std::size_t kLongestLine = 8192;
constexpr std::size_t kCallers = 16;
constexpr std::chrono::seconds kSilence{10};

/// The open file is the database, and open for writing.
bool shows_right(const Descriptor& right, const FileIdentity& file) {
    struct stat shown {};
    return right.get() >= 0 && fstat(right.get(), &shown) == 0 && shown.st_dev == file.device &&
           shown.st_ino == file.inode && (fcntl(right.get(), F_GETFL) & O_ACCMODE) != O_RDONLY;
}

}  // namespace

void Caller::answer(bool ok, std::string_view text, std::string_view word) const noexcept {
    try {
        data::Json answer{{"ok", ok}, {"text", text}};
        if (!word.empty()) {
            answer["word"] = word;
        }
        answer_line(answer.dump(-1, ' ', true, data::Json::error_handler_t::replace));
    } catch (const std::exception&) {  // no memory: whoever asked hears nothing
    }
}

ControlSocket::ControlSocket(const std::string& database) {
    if (const auto file = identity_of(database)) {
        file_ = *file;
        listening_ = listen_for(file_);
    }
}

void ControlSocket::add_to(std::vector<pollfd>& lines) const {
    lines.push_back({.fd = listening_.get(), .events = POLLIN, .revents = 0});
    for (const Line& line : lines_) {
        lines.push_back({.fd = line.caller->descriptor(), .events = POLLIN, .revents = 0});
    }
}

void ControlSocket::accept_callers() {
    while (listening_.get() >= 0) {
        Descriptor one(accept4(listening_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
        if (one.get() < 0) {
            return;
        }
        ucred who{};
        socklen_t size = sizeof who;
        const bool trusted = getsockopt(one.get(), SOL_SOCKET, SO_PEERCRED, &who, &size) == 0 &&
                             (who.uid == geteuid() || who.uid == 0);
        if (lines_.size() == kCallers) {  // who said nothing for longest makes room
            lines_.erase(std::ranges::min_element(lines_, {}, &Line::heard));
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
    if (received.bytes.empty()) {
        return !received.ended && now - line.heard < kSilence;
    }
    line.heard = now;
    line.may_speak = line.may_speak || shows_right(received.file, file_);
    if (!line.may_speak) {
        return false;
    }
    line.begun += received.bytes;
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
    accept_callers();
    std::erase_if(lines_, [&](Line& line) { return !hear(line, obey); });
}

}  // namespace palpate::ui
