#pragma once

#include <array>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

#include "engine/geometry/vec.hpp"

namespace palpate::engine {

/// How a handle moves when nobody holds it, as found from pulses.
struct HandleDynamics {
    double handle_mass = 0.060;    ///< kg, handle and free links lumped at the handle
    Vec2 inertia{1e-4, 1e-4};      ///< kg m^2 of each driven link with its motor
    Vec2 damping{};                ///< N m s/rad at each motor
    Vec2 friction{};               ///< N m of dry friction at each motor
    double handle_damping = 0.0;   ///< N s/m at the handle: a plate, a sleeve, air
    double handle_friction = 0.0;  ///< N of dry friction at the handle
};

/// How one straight axis moves when nobody holds it.
struct AxisDynamics {
    double mass = 0.120;    ///< kg that its motor moves
    double damping = 0.0;   ///< N s/m
    double friction = 0.0;  ///< N, dry
    double pull = 0.0;      ///< N that pull it backwards all the time: weight, of the vertical axis

    friend bool operator==(const AxisDynamics&, const AxisDynamics&) = default;
};

/// What `palpate commission` found of one rig: which device, with which calibration, by which
/// program. Without it nobody holds a handle that gives force in a session that counts.
struct RigRecord {
    std::string device;                    ///< as --device names it
    std::string calibration;               ///< SHA-256 of its canonical text
    std::string program;                   ///< version
    std::optional<std::uint32_t> board{};  ///< board_id(); none: it says none
    HandleDynamics dynamics{};             ///< of a pantograph
    std::array<AxisDynamics, 3> axes{};    ///< of three straight axes
    double force = 0.1;                    ///< N of the pulses that moved the handle
    double damping = 0.0;                  ///< b at the handle, N s/m, the least in the workspace
    double friction = 0.0;       ///< N of dry friction at the handle, the least of its poses
    double round_trip = 0.0;     ///< s from a question to its answer; 0: the device is not asked
    double rate_hz = 0.0;        ///< at which every tick has a new reading one tick old
    double stiffness = 0.0;      ///< N/m, usable at 1 kHz by the passivity condition
    std::optional<Vec3> mark{};  ///< m, where the handle is brought at each opening; none: asked
};

/// Which board it is, of what Device::identity() says: N of "id N, ...". None: it does not tell.
[[nodiscard]] inline std::optional<std::uint32_t> board_id(std::string_view identity) noexcept {
    constexpr std::string_view kWord = "id ";
    std::uint32_t id = 0;
    const bool said =
        identity.starts_with(kWord) &&
        std::from_chars(identity.data() + kWord.size(), identity.data() + identity.size(), id).ec ==
            std::errc{};
    return said ? std::optional(id) : std::nullopt;
}

}  // namespace palpate::engine
