#include "engine/device/drivers/haply_line.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/refuse.hpp"

namespace palpate::engine {

/// The board takes one command each 50 us and fills what is missing with 0xFF: after this pause it
/// has finished whatever it was at, and the next byte begins a command.
constexpr std::int64_t kSettle = 5 * kMillisecond;
constexpr std::int64_t kPatience = 100 * kMillisecond;  ///< for an answer between trials
constexpr std::int64_t kUnderWay = 12 * kMillisecond;   ///< longer than answers may take
/// So long an id may wait for the rest of its answer, which the firmware writes in one piece.
constexpr std::int64_t kAlone = 3 * kMillisecond;
/// Of the makers' examples, and of motors that were not set up.
constexpr std::array<std::uint8_t, 3> kOtherIds{3, 5, 0};
constexpr int kSilences = 5;
constexpr int kBuffers = 64;  ///< of the system; more than that is a board that talks unasked
/// Together more than half a second: on a busy machine the first answers may come late, and nothing
/// is felt yet.
constexpr int kIntroductions = 3;
constexpr int kProofs = 3;

HaplyLine::HaplyLine(ByteLink& link, const HaplyWiring& wiring, const PantographSpec& pantograph)
    : BoardLine(link),
      wiring_(wiring),
      setup_(haply_setup(wiring, pantograph)),
      reset_packet_(reset_packet(setup_.id)),
      setup_packet_(setup_packet(setup_)),
      zero_(*torque_packet(setup_.id, {0.0, 0.0})),
      reply_size_(reply_size(setup_.sensor_pin.has_value())) {}

std::unique_ptr<BoardLine> haply_line(ByteLink& link, const Calibration& calibration) {
    refuse_if(!calibration.haply,
              "the calibration of {} does not say how a Haply board is wired: add [haply]",
              calibration.pantograph.name);
    return std::make_unique<HaplyLine>(link, *calibration.haply, calibration.pantograph);
}

std::string HaplyLine::refusal() const {
    return last_set_up_ == Answer::garbage
             ? "what is at " + link_->name() + " answers, but not as a Haply board with id " +
                   std::to_string(setup_.id) + ": is it another device's port?"
             : "the board at " + link_->name() +
                   " does not answer: is it a Haply board, and has it power? Unplug it, "
                   "plug it in again";
}

GuardPackets HaplyLine::guard_packets() const noexcept {
    return {.zero = zero_,
            .setup = setup_packet_,
            .answer = {.bytes = {setup_.id}, .size = 1},
            .answer_size = reply_size_};
}

void HaplyLine::forget() noexcept {
    link_->drain();
    kept_size_ = 0;
    owed_ = 0;
}

/// And what follows: a guard that spoke for long has filled the system's buffers with answers, and
/// they come up one by one.
void HaplyLine::forget_backlog() noexcept {
    for (int i = 0; i < kBuffers; ++i) {
        forget();
        link_->pause(kMillisecond);
        if (link_->receive(kept_, 0) <= 0) {
            return;
        }
    }
    forget();
}

void HaplyLine::start_over() noexcept {
    set_up_ = false;
    kept_size_ = 0;
    owed_ = 0;
}

bool HaplyLine::ask(const std::array<double, kMaxAxes>& torque) noexcept {
    std::array<double, 2> by_port{};
    by_port[wiring_.port[0] - 1U] = torque[0];
    by_port[wiring_.port[1] - 1U] = torque[1];
    const auto packet = torque_packet(setup_.id, by_port);
    if (!set_up_ || !packet) {
        return false;
    }
    asked_ns_ = link_->now_ns();
    if (owed_ == 0) {
        owed_since_ns_ = asked_ns_;
    }
    if (!link_->send(packet->view())) {
        return false;
    }
    ++owed_;
    return true;
}

HaplyLine::Answer HaplyLine::hear(std::int64_t wait_ns, std::size_t leave) noexcept {
    const std::int64_t deadline = link_->now_ns() + wait_ns;
    bool heard = owed_ == 0;
    while (owed_ > 0) {
        if (kept_size_ > 0 && kept_[0] != setup_.id) {
            return Answer::garbage;
        }
        if (kept_size_ >= reply_size_) {
            if (!take_reply()) {
                return Answer::garbage;
            }
            heard = true;
            continue;
        }
        const std::int64_t patience = owed_ > leave ? deadline - link_->now_ns() : 0;
        const std::ptrdiff_t got =
            link_->receive({kept_.data() + kept_size_, kept_.size() - kept_size_},
                           std::max<std::int64_t>(patience, 0));
        if (got < 0) {
            return Answer::lost;
        }
        if (got == 0) {
            if (id_alone(0)) {
                return Answer::garbage;
            }
            break;
        }
        kept_size_ += static_cast<std::size_t>(got);
        if (id_alone(static_cast<std::size_t>(got))) {
            return Answer::garbage;
        }
    }
    if (owed_ == 0 && kept_size_ > 0) {
        return Answer::garbage;
    }
    return heard ? Answer::complete : Answer::pending;
}

/// A board without addresses answers its id and no more, each time: never part of the next answer.
/// @param came  bytes that came last
bool HaplyLine::id_alone(std::size_t came) noexcept {
    const bool alone = kept_size_ - came == 1;
    if (came == 0) {
        return alone && link_->now_ns() - alone_since_ns_ > kAlone;
    }
    alone_since_ns_ = link_->now_ns();
    return alone && kept_size_ < reply_size_;
}

/// The board reckons 360 * count / resolution with floats: anything else was spoilt on its way.
bool HaplyLine::is_whole(double angle_deg, std::size_t port) const noexcept {
    constexpr double kRounding =
        4.0 / (1 << 24);  // of the resolution, the product and the quotient
    const auto resolution = static_cast<double>(static_cast<float>(setup_.counts_per_turn[port]));
    const double count = std::floor(angle_deg / 360.0 * resolution + 0.5);
    return std::fabs(angle_deg - 360.0 * count / resolution) <= kRounding * std::fabs(angle_deg);
}

/// The first answer of those kept.
bool HaplyLine::take_reply() noexcept {
    const auto reply =
        read_reply({kept_.data(), reply_size_}, setup_.id, setup_.sensor_pin.has_value());
    if (!reply || !is_whole(reply->angle_deg[0], 0) || !is_whole(reply->angle_deg[1], 1)) {
        return false;
    }
    for (std::size_t pivot = 0; pivot < 2; ++pivot) {
        const std::size_t port = wiring_.port[pivot] - 1U;
        reply_.counts[pivot] = static_cast<std::int32_t>(
            std::floor(reply->angle_deg[port] / 360.0 * setup_.counts_per_turn[port] + 0.5));
    }
    if (reply->sensor) {
        reply_.grip = *reply->sensor >= wiring_.grip_threshold ? Grip::held : Grip::released;
    }
    --owed_;
    owed_since_ns_ = link_->now_ns();
    kept_size_ -= reply_size_;
    std::copy_n(kept_.begin() + static_cast<std::ptrdiff_t>(reply_size_), kept_size_,
                kept_.begin());
    return true;
}

/// First the answers that may still be on their way are waited for: forgotten ones would come as
/// answers to the new question.
HaplyLine::Answer HaplyLine::wake(std::int64_t wait_ns) noexcept {
    if (awaiting() && link_->now_ns() - asked_ns_ <= kStale) {
        const Answer answer = hear(wait_ns, 0);
        if (answer != Answer::complete || awaiting()) {
            return answer == Answer::complete ? Answer::pending : answer;
        }
    }
    forget();
    return probe(wait_ns);
}

HaplyLine::Answer HaplyLine::probe(std::int64_t wait_ns) noexcept {
    return ask({0.0, 0.0}) ? hear(wait_ns, 0) : Answer::lost;
}

HaplyLine::Off HaplyLine::part() noexcept {
    if (silence()) {
        return Off::proved;
    }
    const bool up = set_up() == Answer::complete;
    return silence() && up ? Off::anew : Off::unproved;
}

/// The guard's zeros are answered as well: each brings one of ours, whose answer is counted.
void HaplyLine::keep_off() noexcept {
    std::size_t came = 0;
    for (std::ptrdiff_t got = 1; got > 0 && came < 8 * kept_.size();) {
        got = link_->receive(kept_, 0);
        came += got > 0 ? static_cast<std::size_t>(got) : 0;
    }
    kept_size_ = 0;
    const bool unasked = came > owed_ * reply_size_;
    owed_ -= std::min(owed_, came / reply_size_);
    const bool due = link_->now_ns() - asked_ns_ >= kAgain;
    // The last zero itself may have been read as a reset. Half of this one would make the next zero
    // a reset.
    if (due && owed_ > 0 && !link_->send(quiet_packet(0).view())) {
        return;
    }
    owed_ = due ? 0 : owed_;
    if ((unasked || due) && !ask({})) {
        asked_ns_ = link_->now_ns() - kAgain;  // half of one might be any torque: again at once
    }
}

bool HaplyLine::silence() noexcept {
    if (!set_up_) {
        return false;
    }
    // Half a packet, if there is one, is taken and done with, and answers on their way have come.
    link_->pause(owed_ > 1 ? kUnderWay : kSettle);
    // A board that took a packet for a reset hears no address, and its motors are off all the same,
    // mute or not. Half of this one may be any torque, and behind it a zero is a reset: then once
    // more.
    bool sent = false;
    for (int i = 0; i < 2 && !sent; ++i) {
        sent = link_->send(quiet_packet(0).view());
        link_->pause(sent ? kUnderWay : kSettle);  // its answer is nobody's
    }
    forget_backlog();
    bool garbage = false;
    for (int i = 0; i < kSilences; ++i) {
        sent = ask({0.0, 0.0});
        link_->pause(kMillisecond);
        garbage = garbage || hear(0, 0) == Answer::garbage;
    }
    return sent && !garbage && hear(kPatience, 0) == Answer::complete && !awaiting();
}

bool HaplyLine::introduce() noexcept {
    link_->pause(kSettle);
    bool sent = link_->send(quiet_packet(setup_.id).view());
    for (const std::uint8_t id : kOtherIds) {
        sent = sent && (id == setup_.id || link_->send(quiet_packet(id).view()));
    }
    link_->pause(kSettle);
    // Whatever id another program gave its motors, they have none now.
    if (!sent || !link_->send(reset_packet_.view()) || !link_->send(quiet_packet(0).view())) {
        return false;
    }
    link_->pause(kSettle);
    if (!link_->send(setup_packet_.view())) {
        return false;
    }
    link_->pause(kSettle);
    // Zeros to whoever is there were answered by whoever is there.
    for (std::int64_t wait = kPatience; link_->receive(kept_, wait) > 0; wait = 2 * kSettle) {
    }
    return true;
}

HaplyLine::Answer HaplyLine::set_up() noexcept {
    Answer answer = Answer::lost;
    for (int attempt = 0; attempt < kIntroductions && answer != Answer::complete; ++attempt) {
        set_up_ = introduce();
        forget();
        answer = set_up_ ? Answer::complete : Answer::lost;
        for (int i = 0; i < kProofs && answer == Answer::complete; ++i) {
            answer = probe(kPatience);
        }
    }
    last_set_up_ = answer;
    return answer;
}

}  // namespace palpate::engine
