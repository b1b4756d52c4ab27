#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "engine/device/five_bar.hpp"

namespace palpate::engine {

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

/// How an open board is wired to pivot 1 and pivot 2.
struct OpenWiring {
    std::optional<std::uint32_t> id;            ///< the board's own; none: any board
    double watchdog = 0.020;                    ///< s without a torque until it stops, 5 to 50 ms
    std::array<std::uint8_t, 2> channel{1, 2};  ///< 1 and 2 in either order
    std::array<bool, 2> motor_clockwise{};      ///< the motor turns clockwise for a positive torque
    std::array<bool, 2> encoder_clockwise{};
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
    PantographSpec pantograph{};
    std::optional<HaplyWiring> haply{};
    std::optional<OpenWiring> board{};
    std::optional<ComediWiring> comedi{};

    /// The handle's rest pose when the device is switched on, in the object frame, m; none: by
    /// hand.
    std::optional<Vec2> home{};
};

/// @throws std::invalid_argument with a sentence: which number, its range and the remedy
void check(const PantographSpec& spec);
void check(const Calibration& calibration);

}  // namespace palpate::engine
