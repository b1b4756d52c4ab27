#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "engine/device/five_bar.hpp"

namespace palpate::engine {

/// Motors of a machine: two in the plane, three in space.
inline constexpr std::size_t kMaxAxes = 3;

/// One driven joint: its encoder and its motor. Angles anticlockwise from the linkage's +x.
struct Axis {
    double counts_per_turn = 65536.0;   ///< > 0
    double zero = 0.0;                  ///< angle at count 0, rad
    double torque_limit = 0.7;          ///< N m, the most that the motor gives
    double torque_forever = 0.3;        ///< N m that it can give for ever, <= torque_limit
    double codes_full_scale = 32767.0;  ///< DAC code of the torque limit

    /// What a count turns, rad.
    [[nodiscard]] double count_angle() const noexcept { return kTurn / counts_per_turn; }
};

/// A pantograph as a machine: how counts become HIP and forces become torques.
struct PantographSpec {
    std::string name = "mk2";
    FiveBar linkage{};
    std::array<Axis, 2> axes{};     ///< of pivot 1 (at the origin) and pivot 2 (at (base, 0))
    Vec2 origin{0.0125, 0.050};     ///< the object frame's origin in the linkage's frame, m
    double turn = 0.0;              ///< rad, from the linkage's x axis to the object frame's
    std::optional<double> damping;  ///< b at the handle, N s/m, the least in the workspace
    double motor_time = 0.0;        ///< s, thermal time constant of the motors; 0: not known
    double clearance = 0.001;  ///< m; poses closer to a singular one are refused (Clearance::min)
};

/// One straight axis: a motor with an encoder that moves the handle by a drum or a pinion.
struct StraightAxis {
    Axis motor{.torque_limit = 0.12, .torque_forever = 0.06};  ///< its zero is not used
    double radius = 0.010;  ///< m of way by rad of the motor, > 0
    double home = 0.0;      ///< m, where the handle rests when the device is switched on
    double low = -0.060;    ///< m, the ends of the workspace
    double high = 0.060;
};

/// A machine of three straight axes, a gantry: x to the right, y away, z up, as the object frame
/// has them.
struct GantrySpec {
    std::string name = "gantry";
    std::array<StraightAxis, 3> axes{};  ///< x, y, z
    std::optional<double> damping;       ///< b at the handle, N s/m, of the weakest damped axis
    double motor_time = 0.0;             ///< s, thermal time constant of the motors; 0: not known

    /// Where the handle rests when the device is switched on, m.
    [[nodiscard]] Vec3 home() const noexcept { return {axes[0].home, axes[1].home, axes[2].home}; }
};

/// The most that a Haply board gives to a motor, N m; it clamps each torque for itself.
inline constexpr double kHaplyTorque = 0.123;

/// How a Haply board is wired to pivot 1 and pivot 2.
struct HaplyWiring {
    std::uint8_t id = 5;                     ///< of the device on the board; never 0
    std::array<std::uint8_t, 2> port{1, 2};  ///< 1 and 2 in either order
    std::array<bool, 2> motor_clockwise{};   ///< direction byte of the motor: CW = 0
    std::array<bool, 2> encoder_clockwise{};
    std::optional<std::uint8_t> grip_pin;  ///< analogue input that tells a held handle, 54 to 65
    double grip_threshold = 512.0;         ///< held from this ADC value up
};

/// How an open board is wired to pivot 1 and pivot 2, or to the axes x, y and z. Of a straight axis
/// clockwise means backward.
struct OpenWiring {
    std::optional<std::uint32_t> id;  ///< the board's own; none: any board
    double watchdog = 0.020;          ///< s without a torque until it stops, 5 to 50 ms
    std::array<std::uint8_t, kMaxAxes> channel{1, 2, 3};  ///< each once, in any order
    /// The motor turns clockwise for a positive torque.
    std::array<bool, kMaxAxes> motor_clockwise{};
    std::array<bool, kMaxAxes> encoder_clockwise{};
};

/// How a DAQ card is wired to pivot 1 and pivot 2.
struct ComediWiring {
    std::uint32_t counter_subdevice = 0;
    std::array<std::uint32_t, 2> counter{0, 1};  ///< channels
    std::uint32_t output_subdevice = 1;
    std::array<std::uint32_t, 2> output{0, 1};  ///< channels
    std::uint32_t range = 0;
    std::array<double, 2> volts_per_newton_metre{
        10.0, 10.0};  ///< negative: the motor turns the other way
    std::array<bool, 2> counter_clockwise{};
};

/// Everything a device has to know of itself; the calibration file as a value.
struct Calibration {
    PantographSpec pantograph{};         ///< nothing where there is a gantry
    std::optional<GantrySpec> gantry{};  ///< on an open board alone
    std::optional<HaplyWiring> haply{};
    std::optional<OpenWiring> board{};
    std::optional<ComediWiring> comedi{};

    /// The handle's rest pose when the device is switched on, in the object frame, m; none: by
    /// hand.
    std::optional<Vec2> home{};

    /// Of the machine that it is for: the gantry's if it is one, else the pantograph's.
    [[nodiscard]] const std::string& name() const noexcept {
        return gantry ? gantry->name : pantograph.name;
    }
    /// How many motors it has, 2 or 3.
    [[nodiscard]] std::size_t axes() const noexcept { return gantry ? 3 : 2; }
    /// @param i  below axes()
    [[nodiscard]] const Axis& axis(std::size_t i) const noexcept {
        return gantry ? gantry->axes[i].motor : pantograph.axes[i];
    }
    [[nodiscard]] std::optional<double> damping() const noexcept {
        return gantry ? gantry->damping : pantograph.damping;
    }
    [[nodiscard]] double motor_time() const noexcept {
        return gantry ? gantry->motor_time : pantograph.motor_time;
    }
};

/// @throws std::invalid_argument with a sentence: which number, its range and the remedy
void check(const PantographSpec& spec);
void check(const GantrySpec& spec);
void check(const Calibration& calibration);

}  // namespace palpate::engine
