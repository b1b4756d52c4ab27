#include "engine/device/emulator/haply_board.hpp"

#include <cmath>
#include <utility>

#include "engine/device/drivers/haply_wire.hpp"
#include "engine/math/elementary.hpp"

namespace palpate::engine {

constexpr std::uint8_t kMissing = 0xFF;
constexpr double kFullDuty = 4095.0;
constexpr std::size_t kMaxPins = 14;  ///< a real board would write beyond its tables

HaplyBoard::HaplyBoard(BoardPlant& plant, const PantographSpec& machine, const HaplyWiring& wired)
    : plant_(&plant), machine_(machine), wired_(wired) {}

std::uint8_t HaplyBoard::take() noexcept {
    if (in_.empty()) {
        ++log_.missing;
        return kMissing;
    }
    const std::uint8_t byte = in_.front();
    in_.pop_front();
    return byte;
}

float HaplyBoard::take_float() noexcept {
    const std::uint8_t first = take();
    const std::uint8_t second = take();
    const std::uint8_t third = take();
    return wire_float(std::array<std::uint8_t, 4>{first, second, third, take()});
}

void HaplyBoard::pass() {
    ++polls_;
    plant_->advance(kPollPeriod);
    hear_stranger();
}

void HaplyBoard::hear_stranger() {
    constexpr std::int64_t kEvery = 20;  // polls
    if (meddling_ <= 0 || polls_ % kEvery != 0 || !in_.empty()) {
        return;
    }
    if (const auto packet = torque_packet(motors_[0].address, {0.1, 0.1})) {
        --meddling_;
        receive(packet->view());
    }
}

void HaplyBoard::poll() {
    pass();
    if (in_.empty()) {
        return;
    }
    std::uint8_t command = take();
    if (command == 2 && std::exchange(misread_, false)) {
        command = 0;
    }
    switch (command) {
        case kHaplyNoCommand:
            break;
        case 0:
            take();  // the id; every address goes
            reset();
            break;
        case 1:
            set_up();
            break;
        case 2:
            exchange();
            break;
        default:
            ++log_.unknown;
    }
}

void HaplyBoard::reset() {
    ++log_.resets;
    log_.hot_resets += torque_ == Vec3{} ? 0 : 1;
    motors_ = {};
    for (Encoder& encoder : encoders_) {
        encoder.address = 0;
    }
    sensors_.clear();
    pwm_.clear();
}

void HaplyBoard::take_pins(std::vector<std::uint8_t>& pins) {
    pins.clear();
    const std::uint8_t count = take();
    for (std::uint8_t i = 0; i < count; ++i) {
        const std::uint8_t pin = take();
        if (pins.size() < kMaxPins) {
            pins.push_back(pin);
        }
    }
}

void HaplyBoard::set_up() {
    ++log_.setups;
    plant_->before_set_up();
    const std::uint8_t id = take();
    const std::uint8_t motor_mask = take();
    std::size_t slot = 0;
    for (std::size_t port = 0; port < kPorts; ++port) {
        if ((motor_mask >> port & 1U) != 0) {
            motors_[port].address = id;
            motors_[slot++].clockwise = take() == 0;
        }
    }
    const std::uint8_t encoder_mask = take();
    for (std::size_t port = 0; port < kPorts; ++port) {
        if ((encoder_mask >> port & 1U) != 0) {
            encoders_[port].address = id;
            encoders_[port].clockwise = take() == 0;
        }
    }
    take_pins(sensors_);
    take_pins(pwm_);
    for (std::size_t port = 0; port < kPorts; ++port) {
        if ((encoder_mask >> port & 1U) != 0) {
            const double offset = static_cast<double>(take_float());
            encoders_[port].resolution = static_cast<double>(take_float());
            encoders_[port].preset = offset * encoders_[port].resolution / 360.0;
            encoders_[port].zero = true_count(port);
        }
    }
}

void HaplyBoard::exchange() {
    ++log_.exchanges;
    const std::uint8_t id = take();
    for (std::size_t i = 0; i < pwm_.size(); ++i) {
        take();
    }
    bool found = false;
    bool force = false;
    for (std::size_t port = 0; port < kPorts; ++port) {
        if (motors_[port].address == id) {
            found = true;
            const float torque = take_float();
            force = force || !(std::fabs(torque) < 1e-30F);
            drive(port, torque);
        }
    }
    const bool harmless = !in_.empty() && in_.front() == kHaplyNoCommand;
    log_.desyncs += found || harmless ? 0 : 1;
    log_.id_0 += force && id == 0 ? 1 : 0;
    answer(id);
}

int HaplyBoard::pivot_at(std::size_t port) const noexcept {
    for (int pivot = 0; pivot < 2; ++pivot) {
        if (wired_.port[static_cast<std::size_t>(pivot)] == port + 1) {
            return pivot;
        }
    }
    return -1;
}

void HaplyBoard::drive(std::size_t port, float torque) noexcept {
    double duty = kFullDuty;
    double sign = 1.0;
    if (std::isnan(torque)) {
        ++log_.undefined_duty;
    } else {
        const double asked = static_cast<double>(torque);
        sign = asked < 0.0 ? -1.0 : 1.0;
        duty = std::floor(kFullDuty * std::fmin(std::fabs(asked), kHaplyTorque) / kHaplyTorque);
    }
    const int pivot = pivot_at(port);
    if (pivot < 0) {
        return;
    }
    const bool wired = wired_.motor_clockwise[static_cast<std::size_t>(pivot)];
    const double torque_given =
        sign * duty / kFullDuty * kHaplyTorque * (motors_[port].clockwise == wired ? 1.0 : -1.0);
    const bool was_on = torque_ != Vec3{};
    (pivot == 0 ? torque_.x : torque_.y) = torque_given;
    zero_since_ = was_on && torque_ == Vec3{} ? time() : zero_since_;
    plant_->set_torque(torque_);
}

std::int64_t HaplyBoard::true_count(std::size_t port) const noexcept {
    const int pivot = pivot_at(port);
    if (pivot < 0) {
        return 0;
    }
    const auto at = static_cast<std::size_t>(pivot);
    const double turns = plant_->angle(at) / (2.0 * kPi);
    return static_cast<std::int64_t>(std::floor(turns * machine_.axes[at].counts_per_turn + 0.5));
}

double HaplyBoard::angle(std::size_t port, std::int64_t count) const noexcept {
    const Encoder& encoder = encoders_[port];
    const int pivot = pivot_at(port);
    const bool right =
        pivot < 0 || encoder.clockwise == wired_.encoder_clockwise[static_cast<std::size_t>(pivot)];
    const auto turned = static_cast<double>(count - encoder.zero);
    return 360.0 * (encoder.preset + (right ? turned : -turned)) / encoder.resolution;
}

void HaplyBoard::answer(std::uint8_t id) {
    if (faults_.silent) {
        return;
    }
    std::vector<std::uint8_t> bytes = faults_.noise;
    const std::size_t from = bytes.size();
    const auto put = [&](double value) {
        for (const std::uint8_t byte : wire_bytes(static_cast<float>(value))) {
            bytes.push_back(byte);
        }
    };
    std::array<std::int64_t, kPorts>& now = counts_.emplace_back();
    for (std::size_t port = 0; port < kPorts; ++port) {
        now[port] = true_count(port);
    }
    while (counts_.size() > age_ + 1) {
        counts_.pop_front();
    }
    bytes.push_back(faults_.wrong_id ? static_cast<std::uint8_t>(id ^ 0x40U) : id);
    for (std::size_t i = 0; i < sensors_.size(); ++i) {
        put(sensor_);
    }
    for (std::size_t port = 0; port < kPorts; ++port) {
        if (encoders_[port].address == id) {
            put(angle(port, counts_.front()[port]) +
                (port == kPorts - 1 || encoders_[port + 1].address != id ? faults_.turned_deg
                                                                         : 0.0));
        }
    }
    if (faults_.not_finite && bytes.size() >= from + 5) {
        bytes.resize(bytes.size() - 4);
        put(std::numeric_limits<double>::quiet_NaN());
    }
    constexpr double kNever = 86400.0;  // s
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        const bool late = faults_.at_once >= 0 && i >= static_cast<std::size_t>(faults_.at_once);
        const double delay = faults_.delay + (late ? faults_.rest_delay : 0.0);
        out_.push_back({due_after(std::fmin(delay, kNever)), bytes[i]});
    }
}

bool HaplyBoard::command_is_cut() const noexcept {
    const std::size_t size = in_.size();
    if (size == 0) {
        return false;
    }
    if (in_[0] == 0 || (misread_ && in_[0] == 2)) {
        return size < 2;
    }
    if (in_[0] == 2 && size >= 2) {
        std::size_t need = 2 + pwm_.size();
        for (const Motor& motor : motors_) {
            need += motor.address == in_[1] ? 4U : 0U;
        }
        return size < need;
    }
    if (in_[0] == 1) {
        std::size_t at = 2;  // of the mask, then of each count
        std::size_t encoders = 0;
        for (int list = 0; list < 4; ++list) {
            if (at >= size) {
                return true;
            }
            std::size_t items = in_[at];
            if (list < 2) {
                items = static_cast<std::size_t>(__builtin_popcount(in_[at] & 0xFU));
                encoders = items;
            }
            at += 1 + items;
        }
        return size < at + 8 * encoders;
    }
    return in_[0] == 2;
}

void HaplyBoard::power_cycle() {
    motors_ = {};
    encoders_ = {};
    sensors_.clear();
    pwm_.clear();
    in_.clear();
    out_.clear();
    torque_ = {};
    plant_->set_torque(torque_);
}

}  // namespace palpate::engine
