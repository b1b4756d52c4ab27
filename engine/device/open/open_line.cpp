#include "engine/device/open/open_line.hpp"

#include <cmath>

#include "engine/base/refuse.hpp"

namespace palpate::engine {

using Type = OpenType;

constexpr std::int64_t kPatience = 100 * kMillisecond;  ///< for an answer between trials
constexpr double kMicro = 1e6;
constexpr double kJump = 0.3;   ///< rad: no joint turns so far between two answers
constexpr double kLeap = 0.02;  ///< m: nor moves a straight axis
constexpr int kMaxNews = 8;     ///< answers looked at in a millisecond
constexpr int kDisarms = 3;
// STATE with the guard's number, in a frame and bare.
constexpr BoardBytes kDisarmed{.bytes = {0x02, 0x90, 0x01}, .size = 3};
constexpr std::size_t kStateBody = 13;  ///< bytes of a STATE's body, and 4 for each axis
constexpr BoardBytes kDisarmedBody{.bytes = {0x90, 0x00, 0x00}, .size = 3};

OpenLine::OpenLine(ByteLink& link, const OpenWiring& wiring, const Calibration& machine)
    : BoardLine(link),
      wiring_(wiring),
      axes_(machine.axes()),
      bare_(link.keeps_packets()),
      disarm_(packed(open_bare(Type::disarm, kGuardSeq))) {
    check(machine);
    for (std::size_t i = 0; i < axes_; ++i) {
        const Axis& axis = machine.axis(i);
        const std::size_t channel = wiring.channel[i] - 1U;
        counts_per_turn_[channel] =
            static_cast<std::int32_t>(std::floor(axis.counts_per_turn + 0.5));
        jump_[i] =
            (machine.gantry ? kLeap / machine.gantry->axes[i].radius : kJump) / axis.count_angle();
        limit_[channel] = static_cast<std::int32_t>(std::floor(kMicro * axis.torque_limit + 0.5));
    }
}

std::unique_ptr<BoardLine> open_line(ByteLink& link, const Calibration& calibration) {
    refuse_if(!calibration.board,
              "the calibration of {} does not say how an open board is wired: add [board]",
              calibration.name());
    return std::make_unique<OpenLine>(link, *calibration.board, calibration);
}

std::uint16_t OpenLine::next_seq() noexcept {
    ++seq_;
    if (seq_ == kGuardSeq) {
        ++seq_;
    }
    return seq_;
}

BoardBytes OpenLine::packed(const BoardBytes& body) const noexcept {
    return bare_ ? open_datagram(nonce_, body) : open_frame(body);
}

bool OpenLine::send(const BoardBytes& body) noexcept {
    asked_ns_ = link_->now_ns();
    return link_->send(packed(body).view());
}

/// What was asked before is not waited for any more.
void OpenLine::forget() noexcept {
    heard_ = seq_;
    owed_ = 0;
}

void OpenLine::start_over() noexcept {
    set_up_ = false;
    reported_ = false;
    lost_ = false;
    came_at_ = came_size_ = 0;
    reader_.start_over();
    forget();
}

/// The next whole answer, whatever it answers.
std::optional<OpenAnswer> OpenLine::next_answer(std::int64_t wait_ns) noexcept {
    const std::int64_t deadline = link_->now_ns() + wait_ns;
    while (!lost_) {
        while (came_at_ < came_size_) {
            if (const auto answer = read_open(reader_.take(came_[came_at_++]))) {
                return answer;
            }
        }
        const std::ptrdiff_t got =
            link_->receive(came_, std::max<std::int64_t>(deadline - link_->now_ns(), 0));
        lost_ = got < 0;
        came_at_ = 0;
        came_size_ = got > 0 ? static_cast<std::size_t>(got) : 0;
        noise_ = noise_ || got > 0;
        if (got == 0) {
            break;
        }
        if (bare_) {
            const std::span<const std::uint8_t> datagram(came_.data(), came_size_);
            came_size_ = 0;
            if (const auto answer = opened(datagram)) {
                return answer;
            }
        }
    }
    return std::nullopt;
}

/// The answer in a datagram. The nonce comes with IDENT; whoever does not know it is not heard, but
/// for a board that says no, which it may do to somebody else as well.
std::optional<OpenAnswer> OpenLine::opened(std::span<const std::uint8_t> datagram) noexcept {
    if (datagram.size() <= kOpenNonce) {
        return std::nullopt;
    }
    OpenNonce nonce{};
    std::copy_n(datagram.begin(), kOpenNonce, nonce.begin());
    const auto answer = read_open(datagram.subspan(kOpenNonce));
    if (!answer) {
        return std::nullopt;
    }
    if (answer->type == Type::ident && answer->seq == seq_) {
        nonce_ = nonce;
    }
    if (answer->type == Type::nak && answer->why == kOpenOtherHost) {
        problem_ = Problem::other_host;
    }
    return nonce == nonce_ || answer->type == Type::nak ? answer : std::nullopt;
}

/// A question and its answer; what answers older questions is dropped.
std::optional<OpenAnswer> OpenLine::call(const BoardBytes& body, std::int64_t wait_ns) noexcept {
    forget();
    if (!send(body)) {
        lost_ = true;
        return std::nullopt;
    }
    const std::int64_t deadline = link_->now_ns() + wait_ns;
    while (auto answer = next_answer(deadline - link_->now_ns())) {
        if (answer->seq == seq_) {
            heard_ = seq_;
            return answer;
        }
    }
    return std::nullopt;
}

OpenLine::Answer OpenLine::fail(Problem problem, Answer answer) noexcept {
    problem_ = problem;
    return answer;
}

/// Counts of a report, of pivots and in their sense; whether they can be.
OpenLine::Answer OpenLine::take(const OpenReport& report) noexcept {
    if (report.state == OpenState::boot || report.state == OpenState::identified) {
        return fail(Problem::was_reset, Answer::lost);
    }
    if ((report.flags & kOpenStopPressed) != 0) {
        return fail(Problem::stop_pressed, Answer::stopped);
    }
    if ((report.flags & kOpenSkippedEdge) != 0) {
        return fail(Problem::skipped_edge, Answer::lost);
    }
    if (report.axes != axes_) {
        return fail(Problem::axes, Answer::garbage);
    }
    for (std::size_t pivot = 0; pivot < axes_; ++pivot) {
        const std::size_t channel = wiring_.channel[pivot] - 1U;
        const std::int32_t count = report.counts[channel];
        reply_.counts[pivot] = wiring_.encoder_clockwise[pivot] ? -count : count;
    }
    report_ = report;
    reported_ = true;
    return Answer::complete;
}

OpenLine::Answer OpenLine::probe(std::int64_t wait_ns) noexcept {
    const auto answer = call(open_bare(Type::peek, next_seq()), wait_ns);
    if (!answer || answer->type != Type::state) {
        return lost_                           ? Answer::lost
             : problem_ == Problem::other_host ? Answer::garbage
                                               : Answer::pending;
    }
    return take(answer->report);
}

bool OpenLine::silence() noexcept {
    if (!set_up_) {
        return false;
    }
    static_cast<void>(send(open_torque(next_seq(), {}, axes_)));
    forget();
    for (int i = 0; i < kDisarms; ++i) {
        static_cast<void>(link_->send(disarm_.view()));
        link_->pause(kMillisecond);
    }
    const std::int64_t deadline = link_->now_ns() + kPatience;
    while (const auto answer = next_answer(deadline - link_->now_ns())) {
        if (answer->type == Type::state && answer->seq == kGuardSeq) {
            const OpenState state =
                answer->report.state;  // a board that was reset has to begin anew
            problem_ = Problem::none;  // what was wrong before explains no later fault
            return state == OpenState::configured || state == OpenState::stopped;
        }
    }
    return false;
}

/// What a guard's DISARM brings is no news.
void OpenLine::keep_off() noexcept {
    bool unasked = false;
    for (int i = 0; i < kMaxNews; ++i) {
        const auto answer = next_answer(0);
        unasked = unasked || (answer && answer->seq != kGuardSeq);
    }
    if (unasked || link_->now_ns() - asked_ns_ >= kAgain) {
        asked_ns_ = link_->now_ns();
        static_cast<void>(link_->send(disarm_.view()));
    }
}

/// What a board says after an order with our token: its answer to that was measured before.
/// One that does not know the token was set up by somebody else, as another board is.
OpenLine::Answer OpenLine::obeys(Type order, std::int64_t wait_ns) noexcept {
    const auto answer = call(open_token(order, next_seq(), config_.token), wait_ns);
    if (answer && answer->type == Type::nak && answer->why == kOpenOtherToken) {
        set_up_ = false;
        return fail(Problem::was_reset, Answer::lost);
    }
    return answer ? probe(wait_ns) : Answer::pending;
}

bool OpenLine::forgive() noexcept {
    if (obeys(Type::clear, kPatience) != Answer::complete || report_.state == OpenState::stopped) {
        return false;
    }
    problem_ = Problem::none;
    return true;
}

OpenLine::Answer OpenLine::wake(std::int64_t wait_ns) noexcept {
    if (!waking_) {
        owed_since_ns_ = link_->now_ns();
    }
    waking_ = true;
    Answer answer = probe(wait_ns);
    if (answer == Answer::complete && report_.state == OpenState::stopped) {
        answer = obeys(Type::clear, wait_ns);
    }
    if (answer == Answer::complete && report_.state == OpenState::configured) {
        answer = obeys(Type::arm, wait_ns);
    }
    if (answer == Answer::complete && report_.state != OpenState::armed) {
        answer = fail(Problem::watchdog_fired, Answer::stopped);
    }
    waking_ = answer == Answer::pending;
    return lost_ ? Answer::lost : answer;
}

bool OpenLine::ask(const std::array<double, kMaxAxes>& torque) noexcept {
    OpenAxes wanted{};
    for (std::size_t pivot = 0; pivot < axes_; ++pivot) {
        const std::size_t channel = wiring_.channel[pivot] - 1U;
        const double micro =
            kMicro * (wiring_.motor_clockwise[pivot] ? -torque[pivot] : torque[pivot]);
        if (!std::isfinite(micro)) {
            return false;
        }
        const double max = limit_[channel];
        wanted[channel] =
            static_cast<std::int32_t>(std::floor(std::fmin(std::fmax(micro, -max), max) + 0.5));
    }
    if (!set_up_ || !send(open_torque(next_seq(), wanted, axes_))) {
        return false;
    }
    if (owed_ == 0) {
        owed_since_ns_ = asked_ns_;
    }
    ++owed_;
    return true;
}

OpenLine::Answer OpenLine::hear(std::int64_t wait_ns, std::size_t leave) noexcept {
    const std::int64_t deadline = link_->now_ns() + wait_ns;
    while (owed_ > 0) {
        const auto answer = next_answer(owed_ > leave ? deadline - link_->now_ns() : 0);
        if (!answer) {
            break;
        }
        if (problem_ == Problem::other_host) {
            return Answer::garbage;
        }
        const auto behind = static_cast<std::uint16_t>(seq_ - answer->seq);
        if (answer->type != Type::state || behind >= owed_) {
            continue;  // an old one: a cut frame may be completed by the zero of the next
        }
        const BoardReply before = reply_;
        const std::uint32_t passed = answer->report.time_us - report_.time_us;
        const Answer taken = take(answer->report);
        if (taken != Answer::complete) {
            return taken;
        }
        if (report_.state != OpenState::armed) {
            return fail(Problem::watchdog_fired, Answer::stopped);
        }
        for (std::size_t pivot = 0; pivot < axes_; ++pivot) {
            const double turned = std::fabs(static_cast<double>(reply_.counts[pivot]) -
                                            static_cast<double>(before.counts[pivot]));
            if (turned > jump_[pivot] || passed == 0) {
                return fail(Problem::jump, Answer::garbage);
            }
        }
        owed_ = behind;
        owed_since_ns_ = link_->now_ns();
    }
    if (lost_) {
        return Answer::lost;
    }
    return owed_ <= leave ? Answer::complete : Answer::pending;
}

GuardPackets OpenLine::guard_packets() const noexcept {
    return {.zero = disarm_,
            .setup = {},
            .answer = bare_ ? kDisarmedBody : kDisarmed,
            .answer_size = kStateBody + 4 * axes_ + (bare_ ? 0 : 1)};  // its frame without zeros
}

}  // namespace palpate::engine
