#include "engine/device/pointer_device.hpp"

#include <cmath>

namespace palpate::engine {
namespace {

std::int32_t steps_of(double metres) noexcept {
    return static_cast<std::int32_t>(std::floor(metres / PointerDevice::kStep + 0.5));
}

}  // namespace

void PointerDevice::publish(const Vec2& position) noexcept {
    latest_.store({steps_of(position.x), steps_of(position.y)}, std::memory_order_relaxed);
}

Reading PointerDevice::read() noexcept {
    const Steps at = latest_.load(std::memory_order_relaxed);
    return {.hip = {at.x * kStep, at.y * kStep, 0.0}};
}

}  // namespace palpate::engine
