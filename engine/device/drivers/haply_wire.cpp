#include "engine/device/drivers/haply_wire.hpp"

#include <cmath>

namespace palpate::engine {
namespace {

constexpr std::uint8_t kReset = 0;
constexpr std::uint8_t kSetup = 1;
constexpr std::uint8_t kExchange = 2;
constexpr std::uint8_t kPorts12 = 0b11;

void add(BoardBytes& packet, double value) noexcept {
    for (const std::uint8_t byte : wire_bytes(static_cast<float>(value))) {
        packet.add(byte);
    }
}

/// Clockwise is 0, anticlockwise 1.
void add_port_pair(BoardBytes& packet, const std::array<bool, 2>& clockwise) noexcept {
    packet.add(kPorts12);
    for (const bool cw : clockwise) {
        packet.add(static_cast<std::uint8_t>(cw ? 0 : 1));
    }
}

}  // namespace

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

BoardBytes setup_packet(const HaplySetup& setup) noexcept {
    BoardBytes packet{.bytes = {kSetup, setup.id}, .size = 2};
    add_port_pair(packet, setup.motor_clockwise);
    add_port_pair(packet, setup.encoder_clockwise);
    packet.add(static_cast<std::uint8_t>(setup.sensor_pin ? 1 : 0));
    if (setup.sensor_pin) {
        packet.add(*setup.sensor_pin);
    }
    packet.add(0);  // no PWM pins
    for (std::size_t i = 0; i < 2; ++i) {
        add(packet, setup.offset_deg[i]);
        add(packet, setup.counts_per_turn[i]);
    }
    return packet;
}

BoardBytes reset_packet(std::uint8_t id) noexcept {
    return {.bytes = {kReset, id}, .size = 2};
}

BoardBytes quiet_packet(std::uint8_t id) noexcept {
    BoardBytes packet{.bytes = {kExchange, id}, .size = 2};
    for (int i = 0; i < (id == 0 ? 16 : 8); ++i) {
        packet.add(kHaplyNoCommand);
    }
    return packet;
}

std::optional<BoardBytes> torque_packet(std::uint8_t id,
                                        const std::array<double, 2>& torque) noexcept {
    if (id == 0) {
        return std::nullopt;
    }
    BoardBytes packet{.bytes = {kExchange, id}, .size = 2};
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
