#pragma once

#include <atomic>
#include <cmath>

#include "engine/device/device.hpp"

namespace palpate::engine {

/// A screen pointer as the handle: the window publishes where it is, the servo reads the latest
/// value. It gives no force. Safe between one publishing and one reading thread: both coordinates
/// travel in one atomic word of two 32-bit steps of kStep, so that a point is never half old and
/// half new.
class PointerDevice : public Device {
public:
    /// Resolution of a published position, m: far below a pixel.
    static constexpr double kStep = 1e-8;

    /// @param position  object frame, m, |coordinate| < 20 m
    void publish(const Vec2& position) noexcept {
        latest_.store({steps_of(position.x), steps_of(position.y)}, std::memory_order_relaxed);
    }

    [[nodiscard]] Reading read() noexcept override {
        const Steps at = latest_.load(std::memory_order_relaxed);
        return {.hip = {at.x * kStep, at.y * kStep, 0.0}};
    }
    AppliedForce write(const Vec3& /*force*/) noexcept override { return {}; }
    [[nodiscard]] std::string name() const override { return "mouse"; }
    [[nodiscard]] DeviceTraits traits() const noexcept override { return {.gives_force = false}; }

private:
    struct Steps {
        std::int32_t x = 0;
        std::int32_t y = 0;
    };
    static std::int32_t steps_of(double metres) noexcept {
        return static_cast<std::int32_t>(std::floor(metres / kStep + 0.5));
    }
    std::atomic<Steps> latest_{};
    static_assert(decltype(latest_)::is_always_lock_free, "a tick reads it");
};

}  // namespace palpate::engine
