#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "engine/device/calibration.hpp"
#include "engine/device/drivers/board_bytes.hpp"

/// The wire of the open board, host's side. Little-endian; a body is type u8, seq u16, payload, crc
/// u16; on a serial line a frame is 00, COBS(body), 00; a datagram is nonce u64, body. A board has
/// two or three axes, which the length of its IDENT tells, and of all that has a number for each.
/// The board's own side is engine/device/firmware.
namespace palpate::engine {

inline constexpr std::uint8_t kOpenMajor = 1;
inline constexpr std::size_t kOpenBody = 48;  ///< bytes at most
inline constexpr std::size_t kOpenNonce = 8;  ///< before the body of a datagram
inline constexpr std::size_t kOpenDatagram = kOpenBody + kOpenNonce;
inline constexpr std::uint16_t kGuardSeq = 0;  ///< of a guard's DISARM, and of no other question

/// The first byte of a packet's body: what it asks or answers.
enum class OpenType : std::uint8_t {
    hello = 0x01,
    config = 0x02,
    arm = 0x03,
    disarm = 0x04,
    clear = 0x05,
    torque = 0x10,
    peek = 0x11,
    ident = 0x81,
    configured = 0x82,
    state = 0x90,
    nak = 0xFF,
};

enum class OpenState : std::uint8_t { boot, identified, configured, armed, stopped };

/// Bits of the flags in a STATE.
enum OpenFlag : std::uint16_t {
    kOpenStopPressed = 1U << 0U,  ///< since the last CLEAR or CONFIG
    kOpenWatchdog = 1U << 1U,
    kOpenSkippedEdge = 1U << 5U,
    kOpenLostBytes = 1U << 6U,
    kOpenWasHung = 1U << 7U,
    kOpenClamped3 = 1U << 10U,
};

/// A number for each axis: of two the third is 0.
using OpenAxes = std::array<std::int32_t, kMaxAxes>;

/// What a board says it is.
struct OpenIdent {
    std::uint8_t major = 0;
    std::uint8_t minor = 0;
    std::uint16_t firmware = 0;
    std::uint32_t id = 0;
    OpenAxes counts_per_turn{};
    OpenAxes torque_full{};         ///< uN m at full duty
    std::uint8_t watchdog_min = 0;  ///< ms
    std::uint8_t watchdog_max = 0;
    std::uint8_t reset_cause = 0;
    std::uint8_t time_step = 0;  ///< us
    OpenState state = OpenState::boot;
    std::size_t axes = 2;
};

/// What a host asks for at the opening; the board answers with the same bytes.
struct OpenConfig {
    std::uint16_t token = 0;        ///< not 0
    std::uint8_t watchdog_ms = 20;  ///< without a torque the motors go off after so long
    bool zero_counts = false;
    OpenAxes limit{};  ///< uN m
    std::size_t axes = 2;

    friend bool operator==(const OpenConfig&, const OpenConfig&) = default;
};

/// How a board is and what it measured.
struct OpenReport {
    OpenState state = OpenState::boot;
    std::uint16_t flags = 0;
    std::uint32_t time_us = 0;  ///< wraps after 71.6 minutes
    OpenAxes counts{};
    std::uint8_t bad_frames = 0;
    std::size_t axes = 2;
};

/// An answer, whatever it is.
struct OpenAnswer {
    OpenType type = OpenType::nak;
    std::uint16_t seq = 0;
    OpenIdent ident{};
    OpenConfig config{};
    OpenReport report{};
    /// Of a NAK: 1 version, 2 state, 3 value, 4 stop pressed, 5 token, 6 type, 7 another host,
    /// 8 nonce.
    std::uint8_t why = 0;
};

/// CRC-16/X-25 of `bytes`: 0x906E of "123456789".
[[nodiscard]] std::uint16_t open_crc(std::span<const std::uint8_t> bytes) noexcept;

/// Bodies, CRC included.
[[nodiscard]] BoardBytes open_hello(std::uint16_t seq) noexcept;
[[nodiscard]] BoardBytes open_config(std::uint16_t seq, const OpenConfig& config) noexcept;
/// @param type  arm or clear
[[nodiscard]] BoardBytes open_token(OpenType type, std::uint16_t seq, std::uint16_t token) noexcept;
/// @param type  disarm or peek
[[nodiscard]] BoardBytes open_bare(OpenType type, std::uint16_t seq) noexcept;
/// @param torque  uN m   @param axes  2 or 3, of the board
[[nodiscard]] BoardBytes open_torque(std::uint16_t seq,
                                     const OpenAxes& torque,
                                     std::size_t axes = 2) noexcept;

/// Of a NAK: the token is not that of the board's last CONFIG.
inline constexpr std::uint8_t kOpenOtherToken = 5;
/// Of a NAK in a datagram: the board listens to somebody else.
inline constexpr std::uint8_t kOpenOtherHost = 7;

/// What the board and its host alone know: a datagram begins with it.
using OpenNonce = std::array<std::uint8_t, kOpenNonce>;

/// A body as it goes in a datagram.
[[nodiscard]] BoardBytes open_datagram(const OpenNonce& nonce, const BoardBytes& body) noexcept;

/// A body as it goes over a serial line.
[[nodiscard]] BoardBytes open_frame(const BoardBytes& body) noexcept;

/// What a body with a right CRC says; none for another one, an unknown type or a wrong length.
[[nodiscard]] std::optional<OpenAnswer> read_open(std::span<const std::uint8_t> body) noexcept;

/// Finds bodies in the bytes of a serial line.
class OpenReader {
public:
    /// @return the body that ends with this byte, which is no body unless its CRC says so; empty:
    ///         none ends here. Good until the next call
    [[nodiscard]] std::span<const std::uint8_t> take(std::uint8_t byte) noexcept;
    /// From now on bytes up to the next zero are dropped.
    void start_over() noexcept {
        *this = {};
        spoilt_ = true;
    }

private:
    std::array<std::uint8_t, kOpenBody> body_{};
    std::size_t size_ = 0;
    std::uint8_t left_ = 0;  ///< bytes until the next code byte
    bool begun_ = false;
    bool spoilt_ = false;
};

}  // namespace palpate::engine
