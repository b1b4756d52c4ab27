#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "engine/geometry/vec.hpp"

namespace palpate::engine {

/// What a device said when read.
struct Reading {
    Vec2 hip{};  ///< object frame, m
    std::array<std::int32_t, 2> counts{};
    bool ok = true;  ///< false: nothing valid could be read (unplugged, end of a replay)
};

/// What a device did with a commanded force.
struct Applied {
    std::array<std::int32_t, 2> codes{};  ///< DAC codes
    bool saturated = false;               ///< it could not give the force asked for
};

/// The port to whatever holds the hand: read HIP, write force, once a tick each, in this order.
class Device {
public:
    Device() = default;
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;
    virtual ~Device() = default;

    [[nodiscard]] virtual Reading read() noexcept = 0;
    /// @param force  on the user, object frame, N; finite
    virtual Applied write(const Vec2& force) noexcept = 0;
    [[nodiscard]] virtual std::string name() const = 0;
};

}  // namespace palpate::engine
