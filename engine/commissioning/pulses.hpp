#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "engine/device/device.hpp"
#include "engine/device/machine.hpp"
#include "engine/safety/safety_chain.hpp"

/// Weak pulses on a handle that nobody holds, through the same safety chain as a session's force.
namespace palpate::engine {

/// One tick of a pulse. In the plane the third count, torque and coordinate are 0, here and below.
struct PulseSample {
    double time = 0.0;  ///< s since the first one
    Machine::Counts counts{};
    Vec3 torque{};  ///< N m, asked of the motors from this tick on
    bool fresh = true;
};

/// A push to and fro, and what the handle did.
struct Pulse {
    Vec3 place{};          ///< m, where it began, as the encoders say
    Vec3 force{};          ///< N, of its first half
    std::size_t turn = 0;  ///< sample from which on the force is reversed
    std::vector<PulseSample> samples;
    Trip trip = Trip::none;  ///< why it was broken off
    bool steady = true;      ///< ticks and answers came in time: the samples' times are right
};

/// Where a handle was, and by how much it moved.
struct Rest {
    Vec3 place{std::numeric_limits<double>::quiet_NaN()};  ///< m; not a number: nothing was read
    Vec3 counts{};                                         ///< mean of each encoder
    Vec3 span{};                                           ///< largest count less smallest
};

/// Forces that are tried until the handle moves, N. A gantry weighs and rubs more than a linkage.
[[nodiscard]] std::span<const double> pulse_forces(std::size_t axes) noexcept;

/// How a pulse is given.
struct PulsePlan {
    double force = 0.1;      ///< N
    double travel = 0.003;   ///< m after which the force is reversed
    double longest = 0.120;  ///< s until the force is reversed at the latest
};

/// Gives pulses to a device, one at a time.
class PulseRunner {
public:
    /// Waits for the next tick; a device on a virtual clock needs no waiting. @return it came in
    /// time
    using Wait = std::function<bool()>;

    /// @param device  outlives this   @param machine  as its calibration says   @param period  s
    PulseRunner(Device& device, const Machine& machine, double period, Wait wait);
    PulseRunner(const PulseRunner&) = delete;
    PulseRunner& operator=(const PulseRunner&) = delete;
    /// Zero force is the last thing written.
    ~PulseRunner();

    /// Waits for the handle to rest, pushes it along `direction` until it has moved or the time is
    /// up, then as long the other way, so that it ends near where it was and at rest. At most a
    /// second and a half. A pulse in which several ticks or answers came late tells nothing of the
    /// machine: it is given again, and refused in the end with Trip::late.
    /// @param direction  of length 1
    [[nodiscard]] Pulse give(const Vec3& direction, const PulsePlan& plan);

    /// Reads for `seconds` without a force.
    [[nodiscard]] Rest watch(double seconds);

    /// The device fell silent and answers again: it may have been opened anew, and have taken the
    /// pose of that moment for home.
    [[nodiscard]] bool reconnected() const noexcept { return reconnected_; }

private:
    struct Tick {
        Reading reading{};
        Command command{};
        bool in_time = true;
    };

    [[nodiscard]] Tick tick(const Vec3& force);
    [[nodiscard]] Pulse give_once(const Vec3& direction, const PulsePlan& plan);
    [[nodiscard]] bool answers_again();
    void settle();

    Device* device_;
    Machine machine_;
    double period_;
    Wait wait_;
    SafetyLimits limits_{};
    SafetyState safety_{};
    Vec3 load_{};
    Vec3 here_{};  ///< m, as the device said it last
    std::int64_t ticks_ = 0;
    bool reconnected_ = false;
};

/// The directions of the pulses at a place: to the right, left, away, near; in space also up, down.
[[nodiscard]] std::span<const Vec3> pulse_directions(std::size_t axes) noexcept;

/// The torque that acts until sample k > 0 from the one before, N m, if each takes `delay` s to
/// act: its mean.
[[nodiscard]] Vec3 acting_torque(std::span<const PulseSample> samples,
                                 std::size_t k,
                                 double delay) noexcept;

/// The most that an encoder counted away from where a pulse began.
[[nodiscard]] std::int32_t moved(const Pulse& pulse) noexcept;

}  // namespace palpate::engine
