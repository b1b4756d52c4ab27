#include "engine/device/drivers/byte_link.hpp"

#include <array>
#include <cerrno>
#include <ctime>

#include <poll.h>
#include <unistd.h>

#include "engine/base/clock.hpp"

namespace palpate::engine {

std::ptrdiff_t DescriptorLink::receive(std::span<std::uint8_t> into,
                                       std::int64_t wait_ns) noexcept {
    const std::int64_t deadline = now_ns() + wait_ns;
    while (true) {
        const ssize_t got = ::read(port_.get(), into.data(), into.size());
        if (got > 0) {
            return got;
        }
        if (is_gone(got, errno)) {
            return -1;
        }
        const std::int64_t left = deadline - now_ns();
        if (left <= 0) {
            return 0;
        }
        pollfd port{.fd = port_.get(), .events = POLLIN, .revents = 0};
        const timespec patience = timespec_of(left);
        if (ppoll(&port, 1, &patience, nullptr) < 0 && errno != EINTR) {
            return -1;
        }
    }
}

void DescriptorLink::drain() noexcept {
    std::array<std::uint8_t, 256> old{};
    for (int i = 0; i < 64 && receive(old, 0) > 0; ++i) {
    }
}

void DescriptorLink::pause(std::int64_t ns) noexcept {
    const timespec while_long = timespec_of(ns);
    clock_nanosleep(CLOCK_MONOTONIC, 0, &while_long, nullptr);
}

std::int64_t DescriptorLink::now_ns() const noexcept {
    return monotonic_ns();
}

}  // namespace palpate::engine
