#include "engine/device/emulator/open_board.hpp"

#include <cmath>

#include <sys/random.h>

#include "engine/math/elementary.hpp"

namespace palpate::engine {

OpenBoard::OpenBoard(BoardPlant& plant, const Calibration& machine, const OpenWiring& wired)
    : plant_(&plant), machine_(machine), wired_(wired) {
    facts_.id = wired.id.value_or(0);
    facts_.time_step = 50;
    facts_.axes = static_cast<std::uint8_t>(machine.axes());
    for (std::size_t i = 0; i < machine.axes(); ++i) {
        const Axis& axis = machine.axis(i);
        const std::size_t channel = wired.channel[i] - 1U;
        facts_.counts_per_turn[channel] =
            static_cast<std::int32_t>(std::floor(axis.counts_per_turn + 0.5));
        facts_.torque_full[channel] =
            static_cast<std::int32_t>(std::floor(1e6 * axis.torque_limit + 0.5));
    }
    power_cycle();
}

void OpenBoard::power_cycle() {
    facts_.reset_cause = 1;
    in_.clear();
    out_.clear();
    letters_.clear();
    board_begin(&board_, &facts_, this);
    platform_motors_off(&board_);
    zero_ = true_counts();
}

void OpenBoard::unplug_encoder(std::size_t axis, bool out) noexcept {
    stuck_[axis] = out ? std::optional(plant_->angle(axis)) : std::nullopt;
}

std::array<std::int32_t, kMaxAxes> OpenBoard::true_counts() const noexcept {
    std::array<std::int32_t, kMaxAxes> counts{};
    for (std::size_t i = 0; i < machine_.axes(); ++i) {
        const std::size_t channel = wired_.channel[i] - 1U;
        const double turns = stuck_[i].value_or(plant_->angle(i)) / (2.0 * kPi);
        const auto count =
            static_cast<std::int32_t>(std::floor(turns * machine_.axis(i).counts_per_turn + 0.5));
        counts[channel] = wired_.encoder_clockwise[i] ? -count : count;
    }
    return counts;
}

double OpenBoard::torque_of(std::size_t axis) const noexcept {
    constexpr auto kDuty = static_cast<double>(static_cast<int>(BOARD_DUTY));
    if (!enabled_ || axis >= machine_.axes()) {
        return 0.0;
    }
    const std::size_t channel = wired_.channel[axis] - 1U;
    const double given = 1e-6 * facts_.torque_full[channel] * duty_[channel] / kDuty;
    return wired_.motor_clockwise[axis] ? -given : given;
}

void OpenBoard::drive() noexcept {
    plant_->set_torque(torque());
}

void OpenBoard::pass() {
    constexpr std::int64_t kTick = 20;  // polls
    ++polls_;
    plant_->advance(kPollPeriod);
    if (polls_ % kTick == 0) {
        board_tick(&board_);
    }
}

/// Up to the end of a frame that is answered.
void OpenBoard::poll() {
    pass();
    std::array<std::uint8_t, BOARD_FRAME> answer{};
    std::uint8_t size = 0;
    while (size == 0 && !in_.empty()) {
        size = board_take(&board_, in_.front(), answer.data());
        in_.pop_front();
    }
    for (std::size_t i = 0; i < size && !silent_; ++i) {
        out_.push_back({due_after(delay_), answer[i]});
    }
}

void OpenBoard::post(std::uint64_t from, std::span<const std::uint8_t> datagram) {
    static_assert(static_cast<std::size_t>(BOARD_DATAGRAM) == kOpenDatagram);
    Letter letter{.due = due_after(delay_), .to = from};
    letter.datagram.size =
        board_datagram(&board_, from, datagram.data(), static_cast<std::uint16_t>(datagram.size()),
                       letter.datagram.bytes.data());
    if (letter.datagram.size > 0 && !silent_) {
        letters_.push_back(letter);
    }
}

std::optional<OpenBoard::Letter> OpenBoard::letter() {
    if (letters_.empty() || letters_.front().due > polls_) {
        return std::nullopt;
    }
    const Letter first = letters_.front();
    letters_.pop_front();
    return first;
}

}  // namespace palpate::engine

// What the firmware asks of its chip, on the board that runs it.
namespace {

palpate::engine::OpenBoard& emulated_by(board* which) noexcept {
    return *static_cast<palpate::engine::OpenBoard*>(which->owner);
}

}  // namespace

std::uint64_t platform_nonce() {
    std::uint64_t nonce = 0;
    while (getrandom(&nonce, sizeof nonce, 0) != static_cast<ssize_t>(sizeof nonce)) {
    }
    return nonce;
}
std::uint8_t platform_lock() {
    return 0;
}
void platform_unlock(std::uint8_t /*was*/) {}
void platform_motors_off(board* which) {
    emulated_by(which).enabled_ = false;
    emulated_by(which).duty_ = {};
    emulated_by(which).drive();
}
void platform_motors_on(board* which) {
    emulated_by(which).enabled_ = true;
}
void platform_duty(board* which, std::uint8_t motor, std::int16_t duty) {
    emulated_by(which).duty_[motor] = duty;
    emulated_by(which).drive();
}
bool platform_stop_pressed(board* which) {
    return emulated_by(which).stop_pressed_;
}
void platform_sense(board* which, board_sense* sense) {
    const palpate::engine::OpenBoard& emulated = emulated_by(which);
    const auto counts = emulated.true_counts();
    sense->time_us = static_cast<std::uint32_t>(emulated.polls_ * 50);
    for (std::size_t i = 0; i < emulated.machine_.axes(); ++i) {
        sense->count[i] = counts[i] - emulated.zero_[i];
    }
    sense->skipped_edge = emulated.skipped_;
    sense->lost_bytes = false;
}
void platform_forget(board* which, bool zero) {
    palpate::engine::OpenBoard& emulated = emulated_by(which);
    emulated.skipped_ = false;
    if (zero) {
        emulated.plant_->before_set_up();
        emulated.zero_ = emulated.true_counts();
    }
}
