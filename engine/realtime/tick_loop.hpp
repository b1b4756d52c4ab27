#pragma once

#include "engine/device/device.hpp"
#include "engine/realtime/tick_record.hpp"
#include "engine/rendering/scene.hpp"
#include "engine/safety/force_chain.hpp"

namespace palpate::engine {

/// Lateness above this share of the period marks a tick as late.
inline constexpr double kLateShare = 0.5;

/// The body of the servo loop, the same on every clock: read, render, guard, write, record.
/// Data has one direction; no allocation, no lock, no exception.
class TickLoop {
public:
    /// @param device  outlives the loop
    TickLoop(Device& device, const ForceLimits& limits) : device_(&device), limits_(limits) {}

    /// A new trial: fresh contact, force off. @param scene  outlives the trial
    void begin(const Scene& scene) noexcept;

    /// @param time_ns      since the trial's first deadline
    /// @param lateness_ns  wake-up minus deadline
    /// @param enable       ramp the force towards on or off
    TickRecord tick(std::int64_t time_ns, std::int64_t lateness_ns, bool enable) noexcept;

    /// Zero force now, whatever the ramp says.
    void silence() noexcept;

    [[nodiscard]] bool faulted() const noexcept { return gate_.faulted; }

private:
    Device* device_;
    ForceLimits limits_;
    const Scene* scene_ = nullptr;
    ContactState state_{};
    ForceGate gate_{};
    std::int64_t next_ = 0;
};

}  // namespace palpate::engine
