#include "engine/device/emulator/pty_board.hpp"

#include <array>
#include <cerrno>
#include <ctime>
#include <stdexcept>

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

namespace palpate::engine {
namespace {

/// After this long the rest of a cut command does not come.
constexpr int kRestMs = 1;
constexpr int kMaxCommands = 64;  ///< a step

bool readable(int fd, std::int64_t wait_ns) noexcept {
    pollfd one{.fd = fd, .events = POLLIN, .revents = 0};
    const timespec wait{.tv_sec = wait_ns / 1'000'000'000, .tv_nsec = wait_ns % 1'000'000'000};
    return ppoll(&one, 1, &wait, nullptr) > 0 && (one.revents & POLLIN) != 0;
}

/// What a symbolic link says; empty for what is none.
std::string target_of(const std::string& link) {
    std::array<char, 256> target{};
    const ssize_t size = readlink(link.c_str(), target.data(), target.size());
    return size > 0 ? std::string(target.data(), static_cast<std::size_t>(size)) : std::string();
}

bool take(int fd, PortBoard& board) {
    std::array<std::uint8_t, 512> bytes{};
    const ssize_t got = read(fd, bytes.data(), bytes.size());
    if (got > 0) {
        board.receive({bytes.data(), static_cast<std::size_t>(got)});
    }
    return got > 0;
}

}  // namespace

PtyBoard::PtyBoard(PortBoard& board, std::string link)
    : board_(&board), link_(std::move(link)), pace_(board) {
    open();
}

PtyBoard::~PtyBoard() {
    close();
}

void PtyBoard::open() {
    master_ = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    std::array<char, 128> name{};
    if (master_ < 0 || grantpt(master_) != 0 || unlockpt(master_) != 0 ||
        ptsname_r(master_, name.data(), name.size()) != 0) {
        close();
        throw std::runtime_error("the system gives no pseudo-terminal: is /dev/pts mounted?");
    }
    terminal_ = name.data();
    slave_ = ::open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    termios raw{};
    tcgetattr(slave_, &raw);
    cfmakeraw(&raw);
    tcsetattr(slave_, TCSANOW, &raw);
    if (!link_.empty()) {
        if (!target_of(link_).empty()) {  // left by an emulator that was killed; a file stays
            unlink(link_.c_str());
        }
        if (symlink(terminal_.c_str(), link_.c_str()) != 0) {
            const bool taken = errno == EEXIST;
            close();
            if (taken) {
                throw std::runtime_error(
                    link_ + " is there already and is no link: give a name that is free");
            }
            throw std::runtime_error("the link " + link_ +
                                     " cannot be made: name a file in a folder that you may write");
        }
    }
}

void PtyBoard::close() noexcept {
    if (!link_.empty() && master_ >= 0 && target_of(link_) == terminal_) {  // not another's
        unlink(link_.c_str());
    }
    for (int* fd : {&slave_, &master_}) {
        if (*fd >= 0) {
            ::close(*fd);
            *fd = -1;
        }
    }
}

void PtyBoard::plug(bool in) {
    if (in && master_ < 0) {
        open();
    } else if (!in && master_ >= 0) {
        close();
        board_->power_cycle();
    }
}

void PtyBoard::step(int wait_us) {
    if (master_ < 0) {
        poll(nullptr, 0, 1);
        pace_.catch_up();
        return;
    }
    const bool something =
        readable(master_, std::int64_t{wait_us} * 1000) && take(master_, *board_);
    pace_.catch_up();
    for (int i = 0; something && board_->has_input() && i < kMaxCommands; ++i) {
        while (board_->command_is_cut() && readable(master_, kRestMs * 1'000'000) &&
               take(master_, *board_)) {
        }
        board_->poll();
    }
    std::array<std::uint8_t, 512> answer{};
    const std::size_t size = board_->transmit(answer);
    if (size > 0) {  // a host that does not listen loses the answer
        static_cast<void>(write(master_, answer.data(), size) < 0);
    }
}

}  // namespace palpate::engine
