#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "engine/device/device.hpp"
#include "engine/device/homing.hpp"
#include "engine/device/pantograph.hpp"
#include "engine/safety/safety_chain.hpp"

/// Weak pulses on a handle that nobody holds, through the same safety chain as a session's force.
namespace palpate::engine {

/// One tick of a pulse.
struct PulseSample {
    double time = 0.0;  ///< s since the first one
    std::array<std::int32_t, 2> counts{};
    Vec2 torque{};  ///< N m, asked of both motors from this tick on
    bool fresh = true;
};

/// A push to and fro, and what the handle did.
struct Pulse {
    Vec2 place{};          ///< m, where it began, as the encoders say
    Vec2 force{};          ///< N, of its first half
    std::size_t turn = 0;  ///< sample from which on the force is reversed
    std::vector<PulseSample> samples;
    Trip trip = Trip::none;  ///< why it was broken off
    bool steady = true;      ///< ticks and answers came in time: the samples' times are right
};

/// How a pulse is given.
struct PulsePlan {
    double force = 0.1;      ///< N
    double travel = 0.003;   ///< m after which the force is reversed
    double longest = 0.120;  ///< s until the force is reversed at the latest
};

/// Gives pulses to a device, one at a time.
class PulseRunner {
public:
    /// Waits for the next tick; a device on a virtual clock needs no waiting. @return it came in time
    using Wait = std::function<bool()>;

    /// @param device  outlives this   @param machine  as its calibration says   @param period  s
    PulseRunner(Device& device, const PantographSpec& machine, double period, Wait wait);
    PulseRunner(const PulseRunner&) = delete;
    PulseRunner& operator=(const PulseRunner&) = delete;
    /// Zero force is the last thing written.
    ~PulseRunner();

    /// Waits for the handle to rest, pushes it along `direction` until it has moved or the time is up,
    /// then as long the other way, so that it ends near where it was and at rest. At most a second and
    /// a half. A pulse in which several ticks or answers came late tells nothing of the machine: it
    /// is given again, and refused in the end with Trip::late.
    /// @param direction  of length 1
    [[nodiscard]] Pulse give(const Vec2& direction, const PulsePlan& plan);

    /// Reads for `seconds` without a force. @return where the handle was, and by how much it moved;
    ///         readings() 0 if none came
    [[nodiscard]] MarkReading watch(double seconds);

private:
    struct Tick {
        Reading reading{};
        Command command{};
        bool in_time = true;
    };

    [[nodiscard]] Tick tick(const Vec2& force);
    [[nodiscard]] Pulse give_once(const Vec2& direction, const PulsePlan& plan);
    void settle();

    Device* device_;
    Pantograph machine_;
    double period_;
    Wait wait_;
    SafetyLimits limits_{};
    SafetyState safety_{};
    Vec2 load_{};
    std::int64_t ticks_ = 0;
};

/// The four directions of the pulses at a place: to the right, left, away, near.
inline constexpr std::array<Vec2, 4> kPulseDirections{Vec2{1.0, 0.0}, Vec2{-1.0, 0.0},
                                                      Vec2{0.0, 1.0}, Vec2{0.0, -1.0}};

/// The most that an encoder counted away from where a pulse began.
[[nodiscard]] std::int32_t moved(const Pulse& pulse) noexcept;

}  // namespace palpate::engine
