#include "engine/device/calibration.hpp"

#include <cmath>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "engine/math/elementary.hpp"

namespace palpate::engine {
namespace {

constexpr double kLongest = 2.0;       ///< m, of a link: beyond it the unit is wrong
constexpr double kWidestDrum = 0.2;    ///< m: a belt's wheel has 10 mm
constexpr double kMaxCounts = 1e9;     ///< a turn: a position stays within 32 bits
constexpr double kMaxTorque = 2.0;     ///< N m at a joint: 28 N at the end of a link of 70 mm
constexpr double kMaxVolts = 1000.0;   ///< V/(N m): 10 V are 10 mN m
constexpr double kMaxDamping = 100.0;  ///< N s/m: no hand would move it
constexpr double kMaxCode = 2147483647.0;

void above_zero(double value, double highest, const std::string& what) {
    refuse_if(!(value > 0.0 && value <= highest),
              "{} is {:.9g}: give a number above 0, at most {:.9g}", what, value, highest);
}

void check_axis(const Axis& axis, const std::string& which) {
    above_zero(axis.counts_per_turn, kMaxCounts, "counts per turn of " + which);
    require_range(axis.zero, -4.0 * kPi, 4.0 * kPi, "encoder zero (rad) of " + which);
    above_zero(1e3 * axis.torque_limit, 1e3 * kMaxTorque, "torque limit (mN m) of " + which);
    above_zero(1e3 * axis.torque_forever, 1e3 * axis.torque_limit,
               "torque that the motor gives for ever (mN m) of " + which);
    require_range(axis.codes_full_scale, 1.0, kMaxCode, "DAC code of the torque limit of " + which);
}

void differ(std::uint32_t one, std::uint32_t two, const std::string& what) {
    refuse_if(one == two, "{} is {} for two axes: give each its own", what, one);
}

void check_haply(const HaplyWiring& wiring, const PantographSpec& pantograph) {
    refuse_if(wiring.id == 0,
              "the device id on a Haply board is 0, which the board takes for every unused slot: "
              "give 1 to 255");
    for (const std::uint8_t port : wiring.port) {
        require_range(port, 1.0, 2.0, "port of the Haply board");
    }
    differ(wiring.port[0], wiring.port[1], "port of the Haply board");
    if (wiring.grip_pin) {
        require_range(*wiring.grip_pin, 54.0, 65.0, "grip pin of the Haply board");
    }
    require_range(wiring.grip_threshold, 0.0, 4095.0, "grip threshold (ADC value)");
    for (std::size_t i = 0; i < 2; ++i) {
        const double torque = pantograph.axes[i].torque_limit;
        refuse_if(!(torque <= kHaplyTorque),
                  "torque limit of axis {} is {:.9g} mN m, and a Haply board gives {:.9g} at most: "
                  "lower it, or take the table [haply] out if the machine hangs on another board",
                  i + 1, 1e3 * torque, 1e3 * kHaplyTorque);
    }
}

void check_board(const OpenWiring& wiring, const Calibration& machine) {
    const std::size_t axes = machine.axes();
    for (std::size_t i = 0; i < axes; ++i) {
        require_range(wiring.channel[i], 1.0, static_cast<double>(axes),
                      "channel of the open board");
        require_range(machine.axis(i).counts_per_turn, 4.0, kMaxCode,
                      "counts per turn on an open board");
        for (std::size_t j = 0; j < i; ++j) {
            differ(wiring.channel[j], wiring.channel[i], "channel of the open board");
        }
    }
    require_range(1e3 * wiring.watchdog, 5.0, 50.0, "watchdog of the open board (ms)");
}

void check_comedi(const ComediWiring& wiring) {
    differ(wiring.counter[0], wiring.counter[1], "counter channel");
    differ(wiring.output[0], wiring.output[1], "output channel");
    for (const double volts : wiring.volts_per_newton_metre) {
        above_zero(std::fabs(volts), kMaxVolts, "size of the volts per newton metre");
    }
}

void check_motion(const std::optional<double>& damping, double motor_time) {
    if (damping) {
        require_range(*damping, 0.0, kMaxDamping, "damping at the handle (N s/m)");
    }
    require_range(motor_time, 0.0, 1e5, "thermal time constant of the motors (s)");
}

}  // namespace

void check(const PantographSpec& spec) {
    const FiveBar& linkage = spec.linkage;
    above_zero(linkage.driven_1, kLongest, "length (m) of driven link 1");
    above_zero(linkage.driven_2, kLongest, "length (m) of driven link 2");
    above_zero(linkage.free_1, kLongest, "length (m) of free link 1");
    above_zero(linkage.free_2, kLongest, "length (m) of free link 2");
    require_range(linkage.base, 0.0, kLongest, "distance (m) of the pivots");
    check_axis(spec.axes[0], "axis 1");
    check_axis(spec.axes[1], "axis 2");
    require_range(spec.origin.x, -kLongest, kLongest, "x of the object frame's origin (m)");
    require_range(spec.origin.y, -kLongest, kLongest, "y of the object frame's origin (m)");
    require_range(spec.turn, -2.0 * kPi, 2.0 * kPi, "turn of the object frame (rad)");
    check_motion(spec.damping, spec.motor_time);
    above_zero(spec.clearance, 0.05, "clearance from singular poses (m)");
}

void check(const GantrySpec& spec) {
    constexpr std::array<const char*, 3> kNames{"axis x", "axis y", "axis z"};
    for (std::size_t i = 0; i < 3; ++i) {
        const StraightAxis& axis = spec.axes[i];
        const std::string which = kNames[i];
        check_axis(axis.motor, which);
        above_zero(axis.radius, kWidestDrum, "radius (m) of the drum of " + which);
        require_range(axis.low, -kLongest, kLongest, "low end (m) of " + which);
        above_zero(1e3 * (axis.high - axis.low), 1e3 * kLongest,
                   "way (mm) from the low to the high end of " + which);
        require_range(1e3 * axis.home, 1e3 * axis.low, 1e3 * axis.high, "home (mm) of " + which);
    }
    check_motion(spec.damping, spec.motor_time);
}

void check(const Calibration& calibration) {
    if (calibration.gantry) {
        check(*calibration.gantry);
        refuse_if(calibration.haply || calibration.comedi,
                  "machine {} has three axes, and only an open board drives so many: leave its "
                  "table board alone",
                  calibration.name());
    } else {
        check(calibration.pantograph);
    }
    if (calibration.haply) {
        check_haply(*calibration.haply, calibration.pantograph);
    }
    if (calibration.board) {
        check_board(*calibration.board, calibration);
    }
    if (calibration.comedi) {
        check_comedi(*calibration.comedi);
    }
    if (calibration.home) {
        require_range(calibration.home->x, -kLongest, kLongest, "x of the home pose (m)");
        require_range(calibration.home->y, -kLongest, kLongest, "y of the home pose (m)");
    }
}

}  // namespace palpate::engine
