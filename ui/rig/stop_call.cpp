#include "ui/rig/stop_call.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "engine/base/clock.hpp"

namespace palpate::ui {
namespace {

constexpr std::string_view kPrefix = "palpate-stop/";
constexpr const char* kNoFile = "/proc/self/exe";  ///< stands for a database that is not there yet
constexpr int kSessions = 8;                       ///< of one file
constexpr int kCallerMs = 20;                      ///< a caller's time to show its right
constexpr int kAnswerMs = 2000;                    ///< a session's time to answer

class Descriptor {
public:
    explicit Descriptor(int number) : number_(number) {}
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    ~Descriptor() {
        if (number_ >= 0) {
            close(number_);
        }
    }
    [[nodiscard]] int get() const { return number_; }

private:
    int number_;
};

std::string name_of(const struct stat& file, int k) {
    return fmt::format("{}{:x}-{:x}-{}", kPrefix, file.st_dev, file.st_ino, k);
}

/// An abstract name: the first byte is 0.
std::pair<sockaddr_un, socklen_t> address_of(std::string_view name) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path + 1, name.data(), name.size());
    return {address, static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size())};
}

bool readable(int descriptor, int wait_ms) {
    pollfd one{.fd = descriptor, .events = POLLIN, .revents = 0};
    return poll(&one, 1, wait_ms) > 0;
}

/// One byte, and with it an open file (< 0: none).
void send_right(int to, int file) {
    char byte = 's';
    iovec part{.iov_base = &byte, .iov_len = 1};
    alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> room{};
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    if (file >= 0) {
        message.msg_control = room.data();
        message.msg_controllen = room.size();
        cmsghdr* head = CMSG_FIRSTHDR(&message);
        head->cmsg_level = SOL_SOCKET;
        head->cmsg_type = SCM_RIGHTS;
        head->cmsg_len = CMSG_LEN(sizeof file);
        std::memcpy(CMSG_DATA(head), &file, sizeof file);
    }
    static_cast<void>(sendmsg(to, &message, MSG_NOSIGNAL));
}

/// The open file that comes with a call; -1: none.
int received_right(int from) {
    char byte = 0;
    iovec part{.iov_base = &byte, .iov_len = 1};
    alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> room{};
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = room.data();
    message.msg_controllen = room.size();
    if (recvmsg(from, &message, MSG_DONTWAIT | MSG_CMSG_CLOEXEC) < 0) {
        return -1;
    }
    const cmsghdr* head = CMSG_FIRSTHDR(&message);
    if (head == nullptr || head->cmsg_type != SCM_RIGHTS) {
        return -1;
    }
    int file = -1;
    std::memcpy(&file, CMSG_DATA(head), sizeof file);
    return file;
}

/// Of every session on this machine.
std::vector<std::string> all_names() {
    std::vector<std::string> names;
    std::ifstream table("/proc/net/unix");
    for (std::string line; std::getline(table, line);) {
        const std::size_t at = line.find("@" + std::string(kPrefix));
        const bool listens = line.find(" 00010000 ") != std::string::npos;
        if (at != std::string::npos && listens) {
            names.push_back(line.substr(at + 1));
        }
    }
    return names;
}

/// Calls all before it hears any: one that hangs keeps nobody else's force on.
StopResult call(const std::vector<std::string>& names, int file) {
    std::vector<std::unique_ptr<Descriptor>> lines;
    for (const std::string& name : names) {
        auto line = std::make_unique<Descriptor>(
            socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
        const auto [address, length] = address_of(name);
        const auto* at = reinterpret_cast<const sockaddr*>(&address);  // NOLINT
        if (connect(line->get(), at, length) == 0) {
            send_right(line->get(), file);
            lines.push_back(std::move(line));
        }
    }
    StopResult stopped;
    const std::int64_t end = monotonic_ns() + kAnswerMs * kMillisecond;
    for (const auto& line : lines) {
        std::string label;
        std::array<char, 512> piece{};
        ssize_t got = -1;
        while (got != 0) {
            const std::int64_t left = (end - monotonic_ns()) / kMillisecond;
            if (!readable(line->get(), static_cast<int>(std::max<std::int64_t>(left, 0)))) {
                break;
            }
            got = std::max<ssize_t>(read(line->get(), piece.data(), piece.size()), 0);
            label.append(piece.data(), static_cast<std::size_t>(got));
        }
        (!label.empty() ? stopped.sessions : got == 0 ? stopped.refused : stopped.silent) += 1;
        stopped.labels += label;
    }
    return stopped;
}

}  // namespace

StopCall::StopCall(const std::string& database, std::string label) : label_(std::move(label)) {
    struct stat file {};
    if (stat(database.empty() ? kNoFile : database.c_str(), &file) != 0) {
        return;
    }
    device_ = file.st_dev;
    inode_ = file.st_ino;
    for (int k = 0; k < kSessions && descriptor_ < 0; ++k) {
        descriptor_ = socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
        const auto [address, length] = address_of(name_of(file, k));
        if (descriptor_ >= 0 && (bind(descriptor_, reinterpret_cast<const sockaddr*>(&address),
                                      length) != 0 ||  // NOLINT
                                 listen(descriptor_, 16) != 0)) {
            close(descriptor_);
            descriptor_ = -1;
        }
    }
}

StopCall::~StopCall() {
    if (descriptor_ >= 0) {
        close(descriptor_);
    }
}

int StopCall::allowed_caller() const noexcept {
    const int caller = accept4(descriptor_, nullptr, nullptr, SOCK_CLOEXEC);
    if (caller < 0) {
        return -1;
    }
    ucred who{};
    socklen_t size = sizeof who;
    const bool known = getsockopt(caller, SOL_SOCKET, SO_PEERCRED, &who, &size) == 0;
    if (known && (who.uid == geteuid() || who.uid == 0)) {
        return caller;
    }
    const Descriptor right(readable(caller, kCallerMs) ? received_right(caller) : -1);
    struct stat file {};
    const bool same = right.get() >= 0 && fstat(right.get(), &file) == 0 &&
                      file.st_dev == device_ && file.st_ino == inode_;
    if (same && (fcntl(right.get(), F_GETFL) & O_ACCMODE) != O_RDONLY) {
        return caller;
    }
    close(caller);
    return -1;
}

void StopCall::answer(int caller) const noexcept {
    static_cast<void>(send(caller, label_.data(), label_.size(), MSG_NOSIGNAL | MSG_DONTWAIT));
    close(caller);
}

StopResult stop_sessions(const std::optional<std::string>& database) {
    if (!database) {
        return call(all_names(), -1);
    }
    const Descriptor file(open(database->c_str(), O_RDWR | O_CLOEXEC));
    std::vector<std::string> names;
    for (const char* of : {database->c_str(), kNoFile}) {
        struct stat there {};
        for (int k = 0; k < kSessions && stat(of, &there) == 0; ++k) {
            names.push_back(name_of(there, k));
        }
    }
    return call(names, file.get());
}

}  // namespace palpate::ui
