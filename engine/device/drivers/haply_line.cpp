#include "engine/device/drivers/haply_line.hpp"

#include <algorithm>

#include "engine/base/clock.hpp"

namespace palpate::engine {
namespace {

/// The board takes one command each 50 us and fills what is missing with 0xFF: after this pause it
/// has finished whatever it was at, and the next byte begins a command.
constexpr std::int64_t kSettle = 5 * kMillisecond;
constexpr std::int64_t kPatience = 100 * kMillisecond;  ///< for an answer between trials
constexpr int kSilences = 5;
/// Together half a second: on a busy machine the first answers may come late, and nothing is felt yet.
constexpr int kIntroductions = 5;
constexpr int kProofs = 3;

}  // namespace

HaplyLine::HaplyLine(ByteLink& link, const HaplySetup& setup)
    : link_(&link),
      setup_(setup),
      reset_packet_(reset_packet(setup.id)),
      setup_packet_(setup_packet(setup)),
      zero_(*torque_packet(setup.id, {0.0, 0.0})),
      reply_size_(reply_size(setup.sensor_pin.has_value())) {}

void HaplyLine::forget() noexcept {
    link_->drain();
    kept_size_ = 0;
    owed_ = 0;
}

void HaplyLine::start_over() noexcept {
    set_up_ = false;
    kept_size_ = 0;
    owed_ = 0;
}

bool HaplyLine::ask(const std::array<double, 2>& torque) noexcept {
    const auto packet = torque_packet(setup_.id, torque);
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
            break;
        }
        kept_size_ += static_cast<std::size_t>(got);
    }
    if (owed_ == 0 && kept_size_ > 0) {
        return Answer::garbage;
    }
    return heard ? Answer::complete : Answer::pending;
}

/// The first answer of those kept.
bool HaplyLine::take_reply() noexcept {
    const auto reply =
        read_reply({kept_.data(), reply_size_}, setup_.id, setup_.sensor_pin.has_value());
    if (!reply) {
        return false;
    }
    reply_ = *reply;
    --owed_;
    owed_since_ns_ = link_->now_ns();
    kept_size_ -= reply_size_;
    std::copy_n(kept_.begin() + static_cast<std::ptrdiff_t>(reply_size_), kept_size_,
                kept_.begin());
    return true;
}

std::optional<double> HaplyLine::round_trip(std::size_t times) noexcept {
    std::array<std::int64_t, 64> took{};
    const std::size_t all = std::min(times, took.size());
    for (std::size_t i = 0; i < all; ++i) {
        if (!ask({0.0, 0.0}) || hear(kPatience) != Answer::complete) {
            return std::nullopt;
        }
        took[i] = link_->now_ns() - asked_ns_;
    }
    std::sort(took.begin(), took.begin() + static_cast<std::ptrdiff_t>(all));
    return static_cast<double>(took[all / 2]) * 1e-9;
}

bool HaplyLine::silence() noexcept {
    if (!set_up_) {
        return false;
    }
    link_->pause(kSettle);  // half a packet, if there is one, is taken and done with
    forget();
    bool sent = false;
    for (int i = 0; i < kSilences; ++i) {
        sent = ask({0.0, 0.0});
        link_->pause(kMillisecond);
    }
    return sent && hear(kPatience) == Answer::complete && !awaiting();
}

bool HaplyLine::introduce() noexcept {
    if (!link_->send(reset_packet_.view())) {
        return false;
    }
    link_->pause(kSettle);
    if (!link_->send(setup_packet_.view())) {
        return false;
    }
    link_->pause(kSettle);
    return true;
}

HaplyLine::Answer HaplyLine::set_up() noexcept {
    Answer answer = Answer::lost;
    for (int attempt = 0; attempt < kIntroductions && answer != Answer::complete; ++attempt) {
        set_up_ = introduce();
        forget();
        answer = set_up_ ? Answer::complete : Answer::lost;
        for (int i = 0; i < kProofs && answer == Answer::complete; ++i) {
            answer = ask({0.0, 0.0}) ? hear(kPatience) : Answer::lost;
        }
    }
    return answer;
}

}  // namespace palpate::engine
