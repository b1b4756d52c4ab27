#include "engine/device/emulator/board_link.hpp"

namespace palpate::engine {
namespace {

constexpr std::int64_t kPollNs = 50'000;

}  // namespace

bool BoardLink::send(std::span<const std::uint8_t> packet) noexcept {
    if (!open_ || !plugged_) {
        return false;
    }
    const bool whole = cut_ < 0 || static_cast<std::size_t>(cut_) >= packet.size();
    const auto part = whole ? packet : packet.first(static_cast<std::size_t>(cut_));
    cut_ = -1;
    sent_.emplace_back(part.begin(), part.end());
    board_->receive(part);
    return whole;
}

std::ptrdiff_t BoardLink::receive(std::span<std::uint8_t> into, std::int64_t wait_ns) noexcept {
    const std::int64_t deadline = now_ns_ + wait_ns;
    while (true) {
        if (!open_ || !plugged_) {
            return -1;
        }
        const std::size_t got = board_->transmit(into);
        if (got > 0 || now_ns_ >= deadline) {
            return static_cast<std::ptrdiff_t>(got);
        }
        pass(std::min(kPollNs, deadline - now_ns_));
    }
}

void BoardLink::drain() noexcept {
    std::array<std::uint8_t, 64> old{};
    while (board_->transmit(old) > 0) {
    }
}

void BoardLink::pass(std::int64_t ns) noexcept {
    now_ns_ += ns;
    while (polled_ns_ + kPollNs <= now_ns_) {
        polled_ns_ += kPollNs;
        board_->poll();
    }
}

bool BoardLink::reopen() {
    open_ = plugged_;
    return open_;
}

void BoardLink::plug(bool in) {
    if (plugged_ && !in) {
        open_ = false;
        board_->power_cycle();
    }
    plugged_ = in;
}

}  // namespace palpate::engine
