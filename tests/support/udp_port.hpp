#pragma once

#include <cstdint>
#include <stdexcept>

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace palpate::tests {

/// A UDP port of this machine that was free just now.
inline std::uint16_t free_udp_port() {
    sockaddr_in here{};
    here.sin_family = AF_INET;
    here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof here;
    auto* const any = reinterpret_cast<sockaddr*>(&here);
    const int one = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    const bool good = bind(one, any, size) == 0 && getsockname(one, any, &size) == 0;
    close(one);
    return good ? ntohs(here.sin_port) : throw std::runtime_error("no UDP port is free");
}

}  // namespace palpate::tests
