#include "engine/device/drivers/udp_link.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>

#include <netdb.h>
#include <sys/socket.h>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"

namespace palpate::engine {
namespace {

/// What a full queue, an interruption or a cable that comes back in a moment looks like.
bool passes(int error) noexcept {
    return error == EAGAIN || error == EINTR || error == ENOBUFS;
}

}  // namespace

UdpAddress udp_address(std::string_view text) {
    const std::string_view rest = text.substr(text.starts_with(kUdp) ? kUdp.size() : 0);
    const std::size_t colon = std::min(rest.rfind(':'), rest.size());
    std::string_view host = rest.substr(0, colon);
    const std::string_view port = rest.substr(std::min(colon + 1, rest.size()));
    const unsigned number = parsed<unsigned>(port).value_or(0);
    if (host.size() > 2 && host.front() == '[' && host.back() == ']') {
        host = host.substr(1, host.size() - 2);
    }
    refuse_if(host.empty() || number < 1 || number > 65535,
              "{}: give the machine and the port at which the device's program listens, as in "
              "udp:127.0.0.1:5000",
              text);
    return {.host = std::string(host), .port = std::to_string(number)};
}

std::string UdpLink::name() const {
    const bool colons = address_.host.find(':') != std::string::npos;
    return std::string(kUdp) + (colons ? "[" + address_.host + "]" : address_.host) + ":" +
           address_.port;
}

bool UdpLink::reopen() {
    close();
    addrinfo wanted{};
    wanted.ai_socktype = SOCK_DGRAM;
    addrinfo* first = nullptr;
    const int unknown = getaddrinfo(address_.host.c_str(), address_.port.c_str(), &wanted, &first);
    if (unknown != 0) {
        trouble_ = "there is no machine " + address_.host + " (" + gai_strerror(unknown) +
                   "): give its address, as in udp:127.0.0.1:5000";
        return false;
    }
    const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> all(first, &freeaddrinfo);
    int error = 0;
    for (const addrinfo* one = first; one != nullptr && port_.get() < 0; one = one->ai_next) {
        port_ = Descriptor(socket(one->ai_family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
        if (port_.get() < 0 || connect(port_.get(), one->ai_addr, one->ai_addrlen) != 0) {
            error = errno;
            close();
        }
    }
    const bool open = port_.get() >= 0;
    trouble_ = open ? "" : "there is no way to " + name() + ": " + std::strerror(error);
    return open;
}

bool UdpLink::send(std::span<const std::uint8_t> packet) noexcept {
    return ::send(port_.get(), packet.data(), packet.size(), MSG_NOSIGNAL) >= 0 || passes(errno);
}

bool UdpLink::is_gone(std::ptrdiff_t got, int error) const noexcept {
    return got < 0 && !passes(error);
}

}  // namespace palpate::engine
