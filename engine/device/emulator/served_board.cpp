#include "engine/device/emulator/served_board.hpp"

#include <array>
#include <cerrno>
#include <ctime>
#include <stdexcept>

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include "engine/base/refuse.hpp"

namespace palpate::engine {
namespace {

/// After this long the rest of a cut command does not come.
constexpr int kRestMs = 1;
constexpr int kMaxCommands = 64;  ///< a step

bool readable(int fd, std::int64_t wait_ns) noexcept {
    pollfd one{.fd = fd, .events = POLLIN, .revents = 0};
    const timespec wait = timespec_of(wait_ns);
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

constexpr int kMaxDatagrams = 64;  ///< a step

sockaddr* any(sockaddr_in& address) noexcept {
    return reinterpret_cast<sockaddr*>(&address);
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
    master_ = Descriptor(posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
    const int master = master_.get();
    std::array<char, 128> name{};
    if (master < 0 || grantpt(master) != 0 || unlockpt(master) != 0 ||
        ptsname_r(master, name.data(), name.size()) != 0) {
        close();
        throw std::runtime_error("the system gives no pseudo-terminal: is /dev/pts mounted?");
    }
    terminal_ = name.data();
    slave_ = Descriptor(::open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC));
    termios raw{};
    tcgetattr(slave_.get(), &raw);
    cfmakeraw(&raw);
    tcsetattr(slave_.get(), TCSANOW, &raw);
    if (!link_.empty()) {
        if (!target_of(link_).empty()) {  // left by an emulator that was killed; a file stays
            unlink(link_.c_str());
        }
        if (symlink(terminal_.c_str(), link_.c_str()) != 0) {
            const bool taken = errno == EEXIST;
            close();
            refuse_if<std::runtime_error>(
                taken, "{} is there already and is no link: give a name that is free", link_);
            throw std::runtime_error("the link " + link_ +
                                     " cannot be made: name a file in a folder that you may write");
        }
    }
}

void PtyBoard::close() noexcept {
    if (!link_.empty() && plugged() && target_of(link_) == terminal_) {  // not another's
        unlink(link_.c_str());
    }
    slave_ = Descriptor();
    master_ = Descriptor();
}

void PtyBoard::plug(bool in) {
    if (in && !plugged()) {
        open();
    } else if (!in && plugged()) {
        close();
        board_->power_cycle();
    }
}

void PtyBoard::step(int wait_us) {
    if (!plugged()) {
        poll(nullptr, 0, 1);
        pace_.catch_up();
        return;
    }
    const int host = master_.get();
    const bool something = readable(host, std::int64_t{wait_us} * 1000) && take(host, *board_);
    pace_.catch_up();
    for (int i = 0; something && board_->has_input() && i < kMaxCommands; ++i) {
        while (board_->command_is_cut() && readable(host, kRestMs * 1'000'000) &&
               take(host, *board_)) {
        }
        board_->poll();
    }
    std::array<std::uint8_t, 512> answer{};
    const std::size_t size = board_->transmit(answer);
    if (size > 0) {  // a host that does not listen loses the answer
        static_cast<void>(write(host, answer.data(), size) < 0);
    }
}

UdpBoard::UdpBoard(OpenBoard& board, std::uint16_t port)
    : board_(&board), pace_(board), socket_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in here{};
    here.sin_family = AF_INET;
    here.sin_port = htons(port);
    here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof here;
    refuse_if<std::runtime_error>(
        socket_.get() < 0 || bind(socket_.get(), any(here), size) != 0 ||
            getsockname(socket_.get(), any(here), &size) != 0,
        "the UDP port {} is taken or not to be had: give another one, or 0 for any", port);
    port_ = ntohs(here.sin_port);
}

std::string UdpBoard::path() const {
    return "udp:127.0.0.1:" + std::to_string(port_);
}

/// What has come. Each datagram takes the board a moment: no two answers bear the same time.
void UdpBoard::take() {
    for (int i = 0; i < kMaxDatagrams; ++i) {
        std::array<std::uint8_t, 512> datagram{};
        sockaddr_in from{};
        socklen_t size = sizeof from;
        const ssize_t got = recvfrom(socket_.get(), datagram.data(), datagram.size(), MSG_DONTWAIT,
                                     any(from), &size);
        if (got < 0) {
            return;
        }
        board_->post(std::uint64_t{from.sin_addr.s_addr} << 16U | from.sin_port,
                     {datagram.data(), static_cast<std::size_t>(got)});
        board_->pass();
    }
}

void UdpBoard::answer() {
    while (const auto letter = board_->letter()) {  // a host that does not listen loses the answer
        sockaddr_in to{};
        to.sin_family = AF_INET;
        to.sin_addr.s_addr = static_cast<in_addr_t>(letter->to >> 16U);
        to.sin_port = static_cast<in_port_t>(letter->to);
        const auto& datagram = letter->datagram;
        static_cast<void>(sendto(socket_.get(), datagram.bytes.data(), datagram.size, MSG_NOSIGNAL,
                                 any(to), sizeof to) < 0);
    }
}

void UdpBoard::step(int wait_us) {
    pollfd one{.fd = socket_.get(), .events = POLLIN, .revents = 0};
    const timespec wait = timespec_of(std::int64_t{wait_us} * 1000);
    if (ppoll(&one, 1, &wait, nullptr) > 0) {
        take();
    }
    pace_.catch_up();
    answer();
}

}  // namespace palpate::engine
