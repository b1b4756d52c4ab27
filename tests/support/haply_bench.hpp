#pragma once

#include "engine/device/drivers/haply_line.hpp"
#include "tests/support/board_link.hpp"
#include "tests/support/emulated_machine.hpp"

namespace palpate::tests {

inline constexpr std::int64_t kPeriodNs = 1'000'000;  // ns
using Packets = std::vector<BoardCable::Packet>;

struct HaplyParts {
    engine::Calibration machine;
    engine::Pantograph pantograph{machine.pantograph};
    GuidedHand plant{machine};
    engine::HaplyBoard board{plant, machine.pantograph, *machine.haply};
};

/// A Haply board in memory, a hand, and their driver.
struct HaplyBench : HaplyParts, BoardDesk {
    explicit HaplyBench(const engine::Calibration& of = emulated_calibration())
        : HaplyParts{.machine = of}, BoardDesk(board, engine::haply_line) {}

    void open(const engine::BoardTiming& timing = {}) { BoardDesk::open(machine, timing); }
};

/// One that is open, after so many ticks with a force.
struct OpenHaply : HaplyBench {
    explicit OpenHaply(const engine::Vec2& force = {}, int number = 0) {
        open();
        ticks(force, number);
    }
};

inline bool is_zero_torque(const BoardCable::Packet& packet) {
    return packet.size() == 10 && packet[0] == 2 &&
           std::all_of(packet.begin() + 2, packet.end(), [](auto byte) { return byte == 0; });
}

/// Zero torque that a board without this id takes for nothing.
inline bool is_quiet(const BoardCable::Packet& packet) {
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
