#pragma once

#include <netinet/in.h>
#include <sys/socket.h>

#include "tests/support/std.hpp"

namespace palpate::tests {

/// A port of this machine that was free just now, of UDP or, with SOCK_STREAM, of TCP.
inline std::uint16_t free_port(int type = SOCK_DGRAM) {
    sockaddr_in here{};
    here.sin_family = AF_INET;
    here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof here;
    auto* const any = reinterpret_cast<sockaddr*>(&here);
    const int one = socket(AF_INET, type | SOCK_CLOEXEC, 0);
    const bool good = bind(one, any, size) == 0 && getsockname(one, any, &size) == 0;
    close(one);
    return good ? ntohs(here.sin_port) : throw std::runtime_error("no port is free");
}

/// The port of the first program of this machine that speaks to `port` alone; 0: there is none.
inline std::uint16_t host_of(std::uint16_t port) {
    std::ifstream sockets("/proc/net/udp");
    unsigned from = 0;
    unsigned to = 0;
    for (std::string line; std::getline(sockets, line);) {
        if (std::sscanf(line.c_str(), " %*d: %*8x:%4x %*8x:%4x", &from, &to) == 2 && to == port) {
            return static_cast<std::uint16_t>(from);
        }
    }
    return 0;
}

/// Sends a datagram as though it came from another program's port.
/// @return false: that is for root alone
inline bool send_as(std::uint16_t from, std::uint16_t to, std::span<const std::uint8_t> bytes) {
    const int raw = socket(AF_INET, SOCK_RAW | SOCK_CLOEXEC, IPPROTO_UDP);
    std::vector<std::uint8_t> packet;
    const auto put = [&](std::size_t number) {
        packet.push_back(static_cast<std::uint8_t>(number >> 8U));
        packet.push_back(static_cast<std::uint8_t>(number & 0xFFU));
    };
    for (const std::size_t word : {std::size_t{from}, std::size_t{to}, 8 + bytes.size()}) {
        put(word);
    }
    put(0);  // no checksum
    packet.insert(packet.end(), bytes.begin(), bytes.end());
    sockaddr_in there{};
    there.sin_family = AF_INET;
    there.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const bool sent = sendto(raw, packet.data(), packet.size(), 0,
                             reinterpret_cast<sockaddr*>(&there), sizeof there) > 0;
    close(raw);
    return sent;
}

}  // namespace palpate::tests
