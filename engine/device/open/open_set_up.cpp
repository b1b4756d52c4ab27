#include <cmath>
#include <cstdlib>

#include "engine/device/open/open_line.hpp"

// The opening of an open board: who is there, is it the board of the calibration, limits, a first
// look.
namespace palpate::engine {
namespace {

using Type = OpenType;

constexpr std::int64_t kHelloEvery = 100 * kMillisecond;
constexpr int kHellos = 30;  ///< opening the port resets many boards, which boot for seconds
constexpr std::int64_t kLook = 200 * kMillisecond;
constexpr int kLooks = 3;
constexpr std::int64_t kLookEvery = 10 * kMillisecond;
constexpr double kClock = 0.01;                           ///< that the clocks may differ by
constexpr int kStillCounts = 1;                           ///< an encoder at rest may flicker by one
constexpr std::int64_t kAnswerWait = 100 * kMillisecond;  ///< for an answer between trials

/// Any number that the board had from nobody else.
std::uint16_t new_token(std::int64_t now_ns) noexcept {
    auto bits = static_cast<std::uint64_t>(now_ns) * 0x9E3779B97F4A7C15U;
    bits ^= bits >> 29U;
    const auto token = static_cast<std::uint16_t>(bits >> 16U);
    return token == 0 ? std::uint16_t{1} : token;
}

}  // namespace

bool OpenLine::greet() noexcept {
    constexpr std::array<std::uint8_t, 2> kZeros{};
    noise_ = false;
    reader_.start_over();
    lost_ = lost_ || (!bare_ && !link_->send(kZeros));
    for (int i = 0; i < kHellos && !lost_; ++i) {
        problem_ = Problem::none;
        const auto answer = call(open_hello(next_seq()), kHelloEvery);
        if (problem_ == Problem::other_host) {  // in a second it may be gone
            link_->pause(kHelloEvery);
        } else if (answer && (answer->type == Type::ident || answer->type == Type::nak)) {
            ident_ = answer->ident;  // of a NAK: version 0, which is none
            return true;
        }
    }
    return false;
}

/// Is it the board of the calibration?
OpenLine::Problem OpenLine::wrong_board() const noexcept {
    const double watchdog_ms = 1e3 * wiring_.watchdog;
    if (ident_.major != kOpenMajor) {
        return Problem::version;
    }
    if (wiring_.id && *wiring_.id != ident_.id) {
        return Problem::id;
    }
    if (ident_.axes != axes_) {
        return Problem::axes;
    }
    for (std::size_t i = 0; i < axes_; ++i) {
        if (counts_per_turn_[i] != ident_.counts_per_turn[i]) {
            return Problem::counts;
        }
        if (ident_.torque_full[i] < limit_[i]) {
            return Problem::torque;
        }
    }
    if (!(watchdog_ms >= ident_.watchdog_min && watchdog_ms <= ident_.watchdog_max)) {
        return Problem::watchdog;
    }
    return Problem::none;
}

/// Limits and watchdog, which the board repeats to the byte. A host that died may have left it
/// armed.
OpenLine::Problem OpenLine::agree() noexcept {
    static_cast<void>(link_->send(disarm_.view()));
    config_ = {.token = new_token(link_->now_ns()),
               .watchdog_ms = static_cast<std::uint8_t>(std::floor(1e3 * wiring_.watchdog + 0.5)),
               .zero_counts = true,
               .limit = limit_,
               .axes = axes_};
    const auto answer = call(open_config(next_seq(), config_), kAnswerWait);
    const bool same = answer && answer->type == Type::configured && answer->config == config_;
    return same ? Problem::none : Problem::config;
}

/// The board's clock runs as the host's does, within what the way of the questions leaves open.
OpenLine::Problem OpenLine::look_once() noexcept {
    if (probe(kAnswerWait) != Answer::complete) {
        return problem_ == Problem::none ? Problem::silent : problem_;
    }
    const OpenReport first = report_;
    const std::int64_t first_asked = asked_ns_;
    const std::int64_t first_heard = link_->now_ns();
    while (link_->now_ns() - first_asked < kLook) {
        link_->pause(kLookEvery);
        if (probe(kAnswerWait) != Answer::complete) {
            return problem_ == Problem::none ? Problem::silent : problem_;
        }
        for (std::size_t i = 0; i < axes_; ++i) {
            if (std::abs(report_.counts[i] - first.counts[i]) > kStillCounts) {
                return Problem::moves;
            }
        }
    }
    const double passed = 1e3 * static_cast<double>(report_.time_us - first.time_us);
    const auto least = static_cast<double>(asked_ns_ - first_heard);
    const auto max = static_cast<double>(link_->now_ns() - first_asked);
    const bool right = passed >= (1.0 - kClock) * least && passed <= (1.0 + kClock) * max;
    return right ? Problem::none : Problem::clock;
}

OpenLine::Problem OpenLine::look() noexcept {
    Problem found = Problem::clock;
    for (int i = 0; i < kLooks && found == Problem::clock; ++i) {
        found = look_once();
    }
    return found;
}

OpenLine::Answer OpenLine::set_up() noexcept {
    problem_ = Problem::none;
    Problem found = greet()                         ? wrong_board()
                  : problem_ == Problem::other_host ? problem_
                  : noise_                          ? Problem::other_device
                                                    : Problem::silent;
    found = found == Problem::none ? agree() : found;
    found = found == Problem::none ? look() : found;
    set_up_ = found == Problem::none;
    waking_ = false;
    return fail(found, set_up_ ? Answer::complete : lost_ ? Answer::lost : Answer::garbage);
}

}  // namespace palpate::engine
