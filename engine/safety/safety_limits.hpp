#pragma once

#include <cstdint>
#include <limits>

namespace palpate::engine {

/// Lateness above this share of the period marks a tick as late.
inline constexpr double kLateShare = 0.5;

/// All limits between the rendered force and the device, from protocol and device together.
/// Infinity or 0, where said, switches a part of the chain off.
struct SafetyLimits {
    double period = 1e-3;      ///< T, s
    double max_force = 10.0;   ///< N; a stronger command is scaled to this, direction kept
    double ramp_step = 0.005;  ///< share of the force gained or lost a tick, > 0
    double slew = std::numeric_limits<double>::infinity();   ///< N a tick
    double speed = std::numeric_limits<double>::infinity();  ///< m/s of HIP over the speed window
    double jump = std::numeric_limits<double>::infinity();  ///< m of HIP between two fresh readings
    std::int32_t late_run = 0;    ///< late ticks in a row that trip; 0: never
    std::int32_t late_share = 0;  ///< late ticks among the last 100 that trip; 0: never
    std::int32_t quiet_run =
        0;  ///< ticks in a row without a fresh reading that take the force away until
            ///< there is one; 0: none do
    std::int32_t silent_run = 0;  ///< ticks in a row without a fresh reading that trip; 0: never
    double energy = std::numeric_limits<double>::infinity();  ///< J, of the energy observer
    bool watch_runaway = false;  ///< trip on a handle that speeds up against the full force
    bool watch_buzz = false;     ///< trip on a contact that oscillates, see BuzzWatch
    double screen_silence =
        std::numeric_limits<double>::infinity();  ///< s without a sign of life of the screen
    double time_limit = std::numeric_limits<double>::infinity();  ///< s of a trial with force
    double stiffness = 1000.0;  ///< K of the contact, N/m, for the energy that it stores
    double damping = 0.0;       ///< b, N s/m, that the device takes out by itself
    double delay_ticks = 0.0;   ///< of the device
    /// Ticks by which readings may be older than that in the mean, see DelayWatch.
    double spare_delay = std::numeric_limits<double>::infinity();
    double heat_step = 0.0;       ///< period / thermal time constant of the motors; 0: no model
    bool watch_encoders = false;  ///< trip on an encoder that stands still
    int axes = 2;                 ///< of the device
    double stuck_travel = 0.040;  ///< m that HIP goes meanwhile in strokes, see EncoderWatch
    bool dead_man = false;        ///< force only while someone holds the dead-man switch
};

/// Share of the force gained or lost each tick for a ramp of `ramp` s at period `period` s.
[[nodiscard]] constexpr double ramp_step(double ramp, double period) noexcept {
    return ramp > period ? period / ramp : 1.0;
}

}  // namespace palpate::engine
