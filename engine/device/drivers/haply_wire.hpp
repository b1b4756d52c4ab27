#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "engine/device/calibration.hpp"
#include "engine/device/drivers/board_bytes.hpp"

/// The bytes between palpate and a Haply board (hAPI, firmware of the dev kit, M0 and M3). Integers
/// are one byte, floats IEEE-754 binary32, little-endian. There is no start byte, no length, no
/// checksum and no sequence number, so a packet is whole or everything after it is misread.
///
///     reset     00 id                                                       no reply
///     set-up    01 id mask dir* mask dir* nS pin* nP pin* {offset, res}*    no reply
///     exchange  02 id torque*                                  reply: id sensor* angle_deg*
///
/// Directions, torques and angles stand in the order of the ports, which need not be the pivots'.
namespace palpate::engine {

/// The largest angle of a reply that is believed, degrees.
inline constexpr double kHaplyLargestAngle = 1e4;

/// What a set-up says, in the order of ports 1 and 2.
struct HaplySetup {
    std::uint8_t id = 5;
    std::array<bool, 2> motor_clockwise{};
    std::array<bool, 2> encoder_clockwise{};
    std::optional<std::uint8_t> sensor_pin{};  ///< 54 to 65: A0 to A11
    std::array<double, 2> offset_deg{};        ///< angle that the board gives to the present pose
    std::array<double, 2> counts_per_turn{};   ///< > 0
};

/// What a reply says, in the order of ports 1 and 2.
struct HaplyReply {
    std::array<double, 2> angle_deg{};
    std::optional<double> sensor;  ///< raw ADC value
};

/// The set-up of a calibrated pantograph. Offsets are 0: the present pose becomes count 0, small
/// numbers keep their bits in a float, and where count 0 lies is the host's business.
/// @throws std::invalid_argument what check() of such a calibration refuses: id 0, ports other than
///         1 and 2, a sensor pin that is not 54 to 65, a torque that the board does not have
[[nodiscard]] HaplySetup haply_setup(const HaplyWiring& wiring, const PantographSpec& pantograph);

/// Of what haply_setup() gave.
[[nodiscard]] BoardBytes setup_packet(const HaplySetup& setup) noexcept;

/// Clears the addresses of all motors and encoders. It leaves the motors as they are: send zero
/// torque before. @param id  not 0, as haply_setup() has it
[[nodiscard]] BoardBytes reset_packet(std::uint8_t id) noexcept;

/// Zero torque for a board of which nothing is known, of which 0 are the motors that were not set
/// up, four at most: 3 is no command, and four of them as a torque are 4e-37 N m, no step of the
/// duty. The bytes of a zero would be resets to a board without this id.
[[nodiscard]] BoardBytes quiet_packet(std::uint8_t id) noexcept;

/// A byte that is no command.
inline constexpr std::uint8_t kHaplyNoCommand = 3;

/// @param torque  of ports 1 and 2, N m
/// @return none for id 0, which would match every motor that was not set up, and for a torque that
///         is not finite, which the board turns into an undefined duty
[[nodiscard]] std::optional<BoardBytes> torque_packet(std::uint8_t id,
                                                      const std::array<double, 2>& torque) noexcept;

/// Bytes of a reply.
[[nodiscard]] constexpr std::size_t reply_size(bool sensor) noexcept {
    return 1 + 4 * (sensor ? 3U : 2U);
}

/// None for another length, another id, a number that is not finite, or an angle beyond
/// kHaplyLargestAngle.
[[nodiscard]] std::optional<HaplyReply> read_reply(std::span<const std::uint8_t> bytes,
                                                   std::uint8_t id,
                                                   bool sensor) noexcept;

static_assert(std::endian::native == std::endian::little, "a float goes as it lies in memory");
using WireFloat = std::array<std::uint8_t, sizeof(float)>;
/// The float of four bytes.
[[nodiscard]] inline float wire_float(std::span<const std::uint8_t, 4> bytes) noexcept {
    return std::bit_cast<float>(WireFloat{bytes[0], bytes[1], bytes[2], bytes[3]});
}
/// The four bytes of a float.
[[nodiscard]] inline WireFloat wire_bytes(float value) noexcept {
    return std::bit_cast<WireFloat>(value);
}

}  // namespace palpate::engine
