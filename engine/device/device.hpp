#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "engine/geometry/vec.hpp"

namespace palpate::engine {

/// Why a device has nothing valid to say.
enum class DeviceFault : std::uint8_t {
    none,
    lost,         ///< unplugged, or its link is closed
    silent,       ///< it no longer answers
    garbage,      ///< it answers with what cannot be
    unreachable,  ///< its angles belong to no pose of the linkage, or to a singular one
    stopped,      ///< it has switched its motors off by itself: emergency stop, its own watchdog
    held,         ///< this program stood still with the force on: its guard switched the motors off
    unguarded,    ///< nobody would zero the motors if this program died
    ended,        ///< a recording has nothing more
};

/// Whether the participant holds the handle, where a device can tell.
enum class Grip : std::uint8_t { unknown, held, released };

/// What a device said when read. Of a machine in the plane the third coordinate and count are 0.
struct Reading {
    Vec3 hip{};  ///< object frame, m, z up
    std::array<std::int32_t, 3> counts{};
    DeviceFault fault = DeviceFault::none;  ///< other than none: hip and counts are not to be used
    bool fresh = true;  ///< false: nothing new since the last read, whose values are given again
    /// Ticks that it is older than DeviceTraits::delay_ticks says, >= 0: of answers that came late.
    double behind = 0.0;
    Grip grip = Grip::unknown;

    /// Whether hip and counts may be used.
    [[nodiscard]] bool ok() const noexcept { return fault == DeviceFault::none; }
};

/// What a device did with a commanded force. Of a motor that is not there code and load are 0.
struct AppliedForce {
    std::array<std::int32_t, 3> codes{};  ///< DAC codes
    bool saturated = false;               ///< it could not give the force asked for
    Vec3 load{};  ///< each motor's torque as a share of the torque that it can give for ever, >= 0
};

/// What is known of a device before it is used.
struct DeviceTraits {
    bool gives_force = true;          ///< false: a pointer or a recording; it can hurt nobody
    std::optional<double> damping{};  ///< b at the handle, N s/m, the least in the workspace
    double delay_ticks = 0.0;         ///< from a reading to the force it causes, beyond the hold
    double motor_time = 0.0;          ///< s, thermal time constant of the motors; 0: not known
    /// s that the last force stays when this program falls silent; infinity: for ever
    double holds_force = 0.0;
    double round_trip = 0.0;  ///< s from a question to its answer, as measured; 0: it was not
    int axes = 2;             ///< 3: a machine in space
};

/// The port to whatever holds the hand: read HIP, write force, once a tick each, in this order.
/// Only one thread uses it at a time.
class Device {
public:
    Device() = default;
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;
    virtual ~Device() = default;

    /// HIP now; why there is none is in the reading.
    [[nodiscard]] virtual Reading read() noexcept = 0;
    /// @param force  on the user, object frame, N; finite. A machine in the plane gives what lies
    ///        in it.
    virtual AppliedForce write(const Vec3& force) noexcept = 0;
    /// What people call it, for messages and the record of a session.
    [[nodiscard]] virtual std::string name() const = 0;
    /// What it told of itself when it last began, for the record: which one it is, with which
    /// firmware. Empty: it does not tell.
    [[nodiscard]] virtual std::string identity() const { return {}; }

    /// What is known of it before it is used; the same for its whole life.
    [[nodiscard]] virtual DeviceTraits traits() const noexcept { return {}; }
    /// The force that the motors can give in every direction with the handle at `hip`, m, N. None:
    /// the handle cannot be there, or the device gives no force. A machine in the plane ignores z.
    [[nodiscard]] virtual std::optional<double> weakest_force(const Vec3& hip) const noexcept {
        static_cast<void>(hip);
        return std::nullopt;
    }
    /// The most that a reading lies off the handle at `hip`, m: its steps. None: not known, or the
    /// handle cannot be there.
    [[nodiscard]] virtual std::optional<double> reading_error(const Vec3& hip) const noexcept {
        static_cast<void>(hip);
        return std::nullopt;
    }
    /// Force off, proved: after a trip, whoever caused it, and before nobody reads it any more.
    /// Takes what it takes, at most a second; a device that answers has proved it within 50 ms.
    /// @return false: nothing says that the motors are off; read() has a fault from then on
    virtual bool prove_zero() noexcept {
        write(Vec3{});
        return true;
    }
    /// Every millisecond from prove_zero() on, while nobody reads: what was proved stays true.
    /// Others may speak to a port as well.
    virtual void keep_off() noexcept {}
    /// Between trials, never while a servo ticks: makes a device that failed work again. Returns at
    /// once or after little more than a second. @return false while it is still away
    [[nodiscard]] virtual bool reconnect() { return true; }
    /// How often a pose of the handle was taken for home since the device was opened.
    [[nodiscard]] virtual std::size_t homings() const noexcept { return 0; }
    /// The handle was not at home when its pose was taken for it: reconnect() waits for it there
    /// again.
    virtual void forget_home() {}
    /// What is wrong and what to do about it, as a sentence; empty when nothing is.
    [[nodiscard]] virtual std::string trouble() const { return {}; }
    /// It may still give its last force, without end: nothing has acknowledged zero.
    [[nodiscard]] virtual bool force_unproved() const { return false; }
};

/// What to do first then.
inline constexpr const char* kForceUnproved =
    "nothing proves that the motors are off: hands off the handle, switch off the motors' supply";

}  // namespace palpate::engine
