#pragma once

#include "engine/device/drivers/haply_line.hpp"
#include "tests/support/board_link.hpp"
#include "tests/support/guided_hand.hpp"
#include "tests/support/scripted_guard.hpp"

namespace palpate::tests {

inline constexpr std::int64_t kPeriodNs = 1'000'000;  // ns
using Packets = std::vector<tests::BoardCable::Packet>;

/// A board in memory, its driver, and the clock that both live on.
struct HaplyBench {
    explicit HaplyBench(const engine::Calibration& calibration = emulated_calibration())
        : machine(calibration) {}

    engine::Calibration machine;
    engine::Pantograph pantograph{machine.pantograph};
    tests::GuidedHand plant{machine};
    engine::HaplyBoard board{plant, machine.pantograph, *machine.haply};
    tests::BoardCable cable{board};
    ScriptedGuard::Script guard;
    std::unique_ptr<engine::BoardDevice> device;

    void open(const engine::BoardTiming& timing = {}) {
        device = std::make_unique<engine::BoardDevice>(
            machine, std::make_unique<tests::BoardLink>(cable), engine::haply_line,
            std::make_unique<ScriptedGuard>(guard), timing);
    }
    engine::Reading tick(const engine::Vec2& force) {
        const engine::Reading reading = device->read();
        device->write(engine::Vec3(force, 0.0));
        next_ = std::max(next_ + kPeriodNs, cable.now_ns());
        cable.pass(std::max(next_ - cable.now_ns(), kPeriodNs / 10));
        return reading;
    }
    engine::Reading ticks(const engine::Vec2& force, int number) {
        engine::Reading reading;
        for (int i = 0; i < number; ++i) {
            reading = tick(force);
        }
        return reading;
    }

private:
    std::int64_t next_ = 0;  ///< deadline, ns
};

inline bool is_zero_torque(const tests::BoardCable::Packet& packet) {
    return packet.size() == 10 && packet[0] == 2 &&
           std::all_of(packet.begin() + 2, packet.end(), [](auto byte) { return byte == 0; });
}

/// Zero torque that a board without this id takes for nothing.
inline bool is_quiet(const tests::BoardCable::Packet& packet) {
    return packet.size() >= 10 && packet[0] == 2 &&
           std::all_of(packet.begin() + 2, packet.end(),
                       [](auto byte) { return byte == engine::kHaplyNoCommand; });
}

/// What must hold of all bytes that a driver ever sends, whole packets from a list of sends.
/// @return what is wrong with them, empty if nothing is
inline std::string wrong_with(const Packets& sent, std::uint8_t id) {
    bool set_up = false;
    bool force = false;  // a torque may be on
    for (const auto& packet : sent) {
        if (packet.empty()) {  // the board lost its power
            set_up = force = false;
            continue;
        }
        if (is_quiet(packet)) {
            force = force && packet[1] != id;
            continue;
        }
        if (packet.size() < 2 || packet[1] != id) {
            return "a packet for another id, or cut";
        }
        const std::size_t whole = packet[0] == 0 ? 2 : packet[0] == 1 ? 26 : 10;
        if (packet[0] > 2 || packet.size() != whole) {
            return "not a whole packet";
        }
        if (packet[0] == 0) {
            if (force) {
                return "a reset while a torque may be on";
            }
            set_up = false;
        } else if (packet[0] == 1) {
            set_up = true;
        } else if (!set_up) {
            return "an exchange before the set-up";
        } else {
            force = !is_zero_torque(packet);
            for (std::size_t at : {2U, 6U}) {
                const float torque = engine::wire_float(std::span(packet).subspan(at).first<4>());
                if (!(std::fabs(torque) <= 0.12300001F)) {
                    return "a torque that is not finite, or too much";
                }
            }
        }
    }
    return {};
}

/// The last five packets are zero torque.
inline bool ends_in_silence(const Packets& sent) {
    return sent.size() >= 5 && std::all_of(sent.end() - 5, sent.end(), is_zero_torque);
}

}  // namespace palpate::tests
