#include "engine/device/drivers/haply_wire.hpp"

#include <bit>
#include <cmath>

namespace palpate::engine {
namespace {

constexpr std::uint8_t kReset = 0;
constexpr std::uint8_t kSetup = 1;
constexpr std::uint8_t kExchange = 2;
constexpr std::uint8_t kPorts12 = 0b11;

void add(HaplyPacket& packet, std::uint8_t byte) noexcept {
    packet.bytes[packet.size++] = byte;
}

void add(HaplyPacket& packet, double value) noexcept {
    for (const std::uint8_t byte : wire_bytes(static_cast<float>(value))) {
        add(packet, byte);
    }
}

/// Clockwise is 0, anticlockwise 1.
void add_port_pair(HaplyPacket& packet, const std::array<bool, 2>& clockwise) noexcept {
    add(packet, kPorts12);
    for (const bool cw : clockwise) {
        add(packet, static_cast<std::uint8_t>(cw ? 0 : 1));
    }
}

}  // namespace

float wire_float(std::span<const std::uint8_t, 4> bytes) noexcept {
    std::uint32_t bits = 0;
    for (std::size_t i = 4; i-- > 0;) {
        bits = bits << 8U | bytes[i];
    }
    return std::bit_cast<float>(bits);
}

std::array<std::uint8_t, 4> wire_bytes(float value) noexcept {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    std::array<std::uint8_t, 4> bytes{};
    for (std::size_t i = 0; i < 4; ++i) {
        bytes[i] = static_cast<std::uint8_t>(bits >> (8U * i));
    }
    return bytes;
}

HaplySetup haply_setup(const HaplyWiring& wiring, const PantographSpec& pantograph) {
    check({.pantograph = pantograph, .haply = wiring});
    HaplySetup setup{.id = wiring.id, .sensor_pin = wiring.grip_pin};
    for (std::size_t pivot = 0; pivot < 2; ++pivot) {
        const std::size_t slot = wiring.port[pivot] - 1U;
        setup.motor_clockwise[slot] = wiring.motor_clockwise[pivot];
        setup.encoder_clockwise[slot] = wiring.encoder_clockwise[pivot];
        setup.counts_per_turn[slot] = pantograph.axes[pivot].counts_per_turn;
    }
    return setup;
}

HaplyPacket setup_packet(const HaplySetup& setup) noexcept {
    HaplyPacket packet;
    add(packet, kSetup);
    add(packet, setup.id);
    add_port_pair(packet, setup.motor_clockwise);
    add_port_pair(packet, setup.encoder_clockwise);
    add(packet, static_cast<std::uint8_t>(setup.sensor_pin ? 1 : 0));
    if (setup.sensor_pin) {
        add(packet, *setup.sensor_pin);
    }
    add(packet, std::uint8_t{0});  // no PWM pins
    for (std::size_t i = 0; i < 2; ++i) {
        add(packet, setup.offset_deg[i]);
        add(packet, setup.counts_per_turn[i]);
    }
    return packet;
}

HaplyPacket reset_packet(std::uint8_t id) noexcept {
    HaplyPacket packet;
    add(packet, kReset);
    add(packet, id);
    return packet;
}

HaplyPacket quiet_packet(std::uint8_t id) noexcept {
    HaplyPacket packet;
    add(packet, kExchange);
    add(packet, id);
    for (int i = 0; i < (id == 0 ? 16 : 8); ++i) {
        add(packet, kHaplyNoCommand);
    }
    return packet;
}

std::optional<HaplyPacket> torque_packet(std::uint8_t id,
                                         const std::array<double, 2>& torque) noexcept {
    if (id == 0) {
        return std::nullopt;
    }
    HaplyPacket packet;
    add(packet, kExchange);
    add(packet, id);
    for (const double newton_metres : torque) {
        if (!(std::fabs(newton_metres) <= 1e6)) {  // finite as a float as well
            return std::nullopt;
        }
        add(packet, newton_metres + 0.0);  // -0 has a bit set
    }
    return packet;
}

std::optional<HaplyReply> read_reply(std::span<const std::uint8_t> bytes,
                                     std::uint8_t id,
                                     bool sensor) noexcept {
    if (bytes.size() != reply_size(sensor) || bytes[0] != id) {
        return std::nullopt;
    }
    HaplyReply reply;
    std::size_t at = 1;
    const auto next = [&] {
        const std::array<std::uint8_t, 4> four{bytes[at], bytes[at + 1], bytes[at + 2],
                                               bytes[at + 3]};
        at += 4;
        return static_cast<double>(wire_float(four));
    };
    if (sensor) {
        reply.sensor = next();
        if (!std::isfinite(*reply.sensor)) {
            return std::nullopt;
        }
    }
    for (double& angle : reply.angle_deg) {
        angle = next();
        if (!(std::fabs(angle) <= kHaplyLargestAngle)) {
            return std::nullopt;
        }
    }
    return reply;
}

}  // namespace palpate::engine
