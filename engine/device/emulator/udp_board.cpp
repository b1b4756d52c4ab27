#include "engine/device/emulator/udp_board.hpp"

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

/// What has come. Each datagram takes the board a moment: no two answers bear the same time.
void UdpBoard::take() {
    for (int i = 0; i < kMaxDatagrams; ++i) {
        std::array<std::uint8_t, 512> datagram{};
        sockaddr_in from{};
        socklen_t size = sizeof from;
        const ssize_t got =
            recvfrom(socket_, datagram.data(), datagram.size(), MSG_DONTWAIT, any(from), &size);
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
        static_cast<void>(sendto(socket_, datagram.bytes.data(), datagram.size, MSG_NOSIGNAL,
                                 any(to), sizeof to) < 0);
    }
}

void UdpBoard::step(int wait_us) {
    pollfd one{.fd = socket_, .events = POLLIN, .revents = 0};
    const timespec wait{.tv_sec = 0, .tv_nsec = 1000L * wait_us};
    if (ppoll(&one, 1, &wait, nullptr) > 0) {
        take();
    }
    pace_.catch_up();
    answer();
}

}  // namespace palpate::engine
