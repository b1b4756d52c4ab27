#include "tests/support/board_link.hpp"

#include <algorithm>
#include <utility>

namespace palpate::tests {
namespace {

constexpr std::int64_t kPollNs = 50'000;

}  // namespace

void BoardCable::pass(std::int64_t ns) {
    now_ns_ += ns;
    while (polled_ns_ + kPollNs <= now_ns_) {
        polled_ns_ += kPollNs;
        board_->poll();
    }
}

void BoardCable::plug(bool in) {
    if (plugged_ && !in) {
        ++pulls_;
        sent_.emplace_back();
        board_->power_cycle();
    }
    plugged_ = in;
}

bool BoardCable::send(std::span<const std::uint8_t> packet) {
    const std::size_t size = std::min(cut_.value_or(packet.size()), packet.size());
    cut_.reset();
    sent_.emplace_back(packet.begin(), packet.end());
    std::vector<std::uint8_t> arrives(packet.begin(),
                                      packet.begin() + static_cast<std::ptrdiff_t>(size));
    if (!arrives.empty()) {
        arrives.front() ^= std::exchange(spoilt_, std::uint8_t{0});
    }
    board_->receive(arrives);
    return size == packet.size();
}

bool BoardLink::send(std::span<const std::uint8_t> packet) noexcept {
    return open() && cable_->send(packet);
}

std::ptrdiff_t BoardLink::receive(std::span<std::uint8_t> into, std::int64_t wait_ns) noexcept {
    const std::int64_t deadline = now_ns() + wait_ns;
    while (open()) {
        const std::size_t got = cable_->receive(into);
        if (got > 0 || now_ns() >= deadline) {
            return static_cast<std::ptrdiff_t>(got);
        }
        cable_->pass(std::min(kPollNs, deadline - now_ns()));
    }
    return -1;
}

void BoardLink::drain() noexcept {
    std::array<std::uint8_t, 64> old{};
    while (open() && cable_->receive(old) > 0) {
    }
}

bool BoardLink::reopen() {
    opened_ = cable_->plugged() ? cable_->pulls() : -1;
    return open();
}

std::string BoardLink::trouble() const {
    return open() ? "" : "the cable is not plugged in: plug it in";
}

void BoardDesk::open(const engine::Calibration& machine, const engine::BoardTiming& timing) {
    device =
        std::make_unique<engine::BoardDevice>(machine, std::make_unique<BoardLink>(cable), line_,
                                              std::make_unique<ScriptedGuard>(guard), timing);
}

void BoardDesk::pass_tick() {
    next_ = std::max(next_ + kMillisecond, cable.now_ns());
    cable.pass(std::max(next_ - cable.now_ns(), kMillisecond / 10));
}

engine::Reading BoardDesk::tick(const engine::Vec2& force) {
    const engine::Reading reading = device->read();
    device->write(engine::Vec3(force, 0.0));
    pass_tick();
    return reading;
}

engine::Reading BoardDesk::ticks(const engine::Vec2& force, int number) {
    engine::Reading reading;
    for (int i = 0; i < number; ++i) {
        reading = tick(force);
    }
    return reading;
}

}  // namespace palpate::tests
