#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <memory>
#include <vector>

#include "engine/device/device.hpp"
#include "engine/realtime/scene_view.hpp"
#include "engine/realtime/tick_record.hpp"
#include "engine/safety/safety_chain.hpp"

namespace palpate::engine {

/// What a clock and the people around it say to one tick.
struct TickOrder {
    std::int64_t time_ns = 0;      ///< since the trial's first deadline
    std::int64_t lateness_ns = 0;  ///< wake-up minus deadline
    bool enable = true;            ///< ramp the force towards on or off
    bool held = true;              ///< someone holds the dead-man key
    double screen_age = 0.0;       ///< s since the screen's last sign of life
    Trip stop = Trip::none;        ///< who ends it by hand, see SafetyInput
};

/// The last ticks before a fault, whatever became of the ring. No allocation but in last().
class FlightRecorder {
public:
    static constexpr std::size_t kTicks = 100;

    /// Forgets the last trial.
    void clear() noexcept { seen_ = 0; }
    /// The next tick.
    void add(const TickRecord& tick) noexcept { slots_[seen_++ % kTicks] = tick; }

    /// Oldest first, at most kTicks. Only while no servo ticks.
    [[nodiscard]] std::vector<TickRecord> last() const {
        std::vector<TickRecord> ticks;
        for (std::size_t i = seen_ < kTicks ? 0 : seen_ - kTicks; i < seen_; ++i) {
            ticks.push_back(slots_[i % kTicks]);
        }
        return ticks;
    }

private:
    std::array<TickRecord, kTicks> slots_{};
    std::size_t seen_ = 0;
};

/// The body of the servo loop, the same on every clock: read, render, guard, write, record.
/// Data has one direction; no allocation, no lock, no exception.
class TickLoop {
public:
    /// @param device  outlives the loop
    TickLoop(Device& device, const SafetyLimits& limits);
    ~TickLoop();

    /// A new trial: fresh contact, force off. @param scene  outlives the trial
    /// @param rest  s since the last trial's last tick, in which the motors cooled; by default for
    ///       ever
    void begin(const SceneView& scene,
               double rest = std::numeric_limits<double>::infinity()) noexcept;

    /// One tick of a trial. A reading that is not to be used, or that is not finite, is a trip; the
    /// tick then has the last HIP that was good, so that every recorded force follows from its HIP.
    TickRecord tick(const TickOrder& order) noexcept {
        return scene_.space == nullptr ? tick_in_plane(order) : tick_in_space(order);
    }

    /// One tick between trials: the device is read, and commanded to give no force. The HIP of a
    /// reading with a fault is the last good one.
    Reading idle() noexcept;

    /// Zero force now, whatever the ramp says.
    void silence() noexcept;
    /// The same, proved. See Device.
    void prove_zero() noexcept { device_->prove_zero(); }
    void keep_off() noexcept { device_->keep_off(); }

    [[nodiscard]] const SafetyLimits& limits() const noexcept { return limits_; }
    /// As it was given; outlives this.
    [[nodiscard]] const Device& device() const noexcept { return *device_; }
    /// Why the force is off; none while it is not.
    [[nodiscard]] Trip trip() const noexcept { return safety_.trip; }
    /// The trial's last ticks.
    [[nodiscard]] const FlightRecorder& flight() const noexcept { return flight_; }

private:
    TickRecord tick_in_plane(const TickOrder& order) noexcept;
    TickRecord tick_in_space(const TickOrder& order) noexcept;
    [[nodiscard]] Reading usable(Reading reading) noexcept;
    [[nodiscard]] SafetyInput input_of(const TickOrder& order,
                                       const Reading& reading) const noexcept;
    [[nodiscard]] TickRecord recorded(const TickOrder& order,
                                      const Reading& reading,
                                      const Command& command) noexcept;

    Device* device_;
    SafetyLimits limits_;
    SceneView scene_{};
    std::unique_ptr<FeltState> state_;  ///< never null
    SafetyState safety_{};
    AppliedForce applied_{};  ///< by the last tick
    Vec3 hip_{};              ///< the last one that could be used
    FlightRecorder flight_{};
    std::int64_t next_ = 0;
};

}  // namespace palpate::engine
