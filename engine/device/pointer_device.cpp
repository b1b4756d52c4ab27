#include "engine/device/pointer_device.hpp"

#include <cmath>

namespace palpate::engine {
namespace {

std::uint64_t packed(double metres) noexcept {
    const auto steps = static_cast<std::int32_t>(std::floor(metres / PointerDevice::kStep + 0.5));
    return static_cast<std::uint32_t>(steps);
}

double unpacked(std::uint64_t word) noexcept {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(word)) * PointerDevice::kStep;
}

}  // namespace

void PointerDevice::publish(const Vec2& position) noexcept {
    latest_.store((packed(position.x) << 32U) | packed(position.y), std::memory_order_relaxed);
}

Reading PointerDevice::read() noexcept {
    const std::uint64_t word = latest_.load(std::memory_order_relaxed);
    return {.hip = {unpacked(word >> 32U), unpacked(word & 0xFFFFFFFFU), 0.0}};
}

}  // namespace palpate::engine
