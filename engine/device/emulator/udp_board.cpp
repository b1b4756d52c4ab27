#include "engine/device/emulator/udp_board.hpp"

#include <algorithm>
#include <array>
#include <ctime>
#include <stdexcept>

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace palpate::engine {
namespace {

constexpr int kMaxDatagrams = 64;  ///< a step

sockaddr* any(sockaddr_in& address) noexcept {
    return reinterpret_cast<sockaddr*>(&address);
}

}  // namespace

UdpBoard::UdpBoard(OpenBoard& board, std::uint16_t port)
    : board_(&board), pace_(board), socket_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in here{};
    here.sin_family = AF_INET;
    here.sin_port = htons(port);
    here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof here;
    if (socket_ < 0 || bind(socket_, any(here), size) != 0 ||
        getsockname(socket_, any(here), &size) != 0) {
        close(socket_);
        throw std::runtime_error("the UDP port " + std::to_string(port) +
                                 " is taken or not to be had: give another one, or 0 for any");
    }
    port_ = ntohs(here.sin_port);
}

UdpBoard::~UdpBoard() {
    close(socket_);
}

std::string UdpBoard::path() const {
    return "udp:127.0.0.1:" + std::to_string(port_);
}

/// What has come, each as a frame of its own.
void UdpBoard::take() {
    for (int i = 0; i < kMaxDatagrams; ++i) {
        OpenBytes body;
        sockaddr_in from{};
        socklen_t size = sizeof from;
        const ssize_t got = recvfrom(socket_, body.bytes.data(), body.bytes.size(),
                                     MSG_DONTWAIT | MSG_TRUNC, any(from), &size);
        if (got < 0) {
            return;
        }
        const bool hello = got > 0 && body.bytes[0] == static_cast<std::uint8_t>(OpenType::hello);
        if (hello && board_->state() != static_cast<int>(OpenState::armed)) {
            host_ = from;
        }
        const bool known =
            from.sin_port == host_.sin_port && from.sin_addr.s_addr == host_.sin_addr.s_addr;
        if (known && static_cast<std::size_t>(got) <= kOpenBody) {
            body.size = static_cast<std::size_t>(got);
            board_->receive(open_frame(body).view());
        }
    }
}

void UdpBoard::answer() {
    std::array<std::uint8_t, 512> frames{};
    const std::size_t size = board_->transmit(frames);
    for (std::size_t i = 0; i < size; ++i) {
        const auto body = reader_.take(frames[i]);
        if (!body.empty()) {  // a host that does not listen loses the answer
            static_cast<void>(sendto(socket_, body.data(), body.size(), MSG_NOSIGNAL, any(host_),
                                     sizeof host_) < 0);
        }
    }
}

void UdpBoard::step(int wait_us) {
    pollfd one{.fd = socket_, .events = POLLIN, .revents = 0};
    const timespec wait{.tv_sec = 0, .tv_nsec = 1000L * wait_us};
    if (ppoll(&one, 1, &wait, nullptr) > 0) {
        take();
    }
    pace_.catch_up();
    while (board_->has_input()) {
        board_->poll();
    }
    answer();
}

}  // namespace palpate::engine
