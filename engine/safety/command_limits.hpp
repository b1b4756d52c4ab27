#pragma once

#include "engine/geometry/vec.hpp"

namespace palpate::engine {

/// `force`, or where it is longer than `most` the vector of that length in its direction: a force that is
/// clipped axis by axis would turn, and a wall would feel as if it had friction.
/// @param force  N, finite, |force| < 1e154   @param most  N, >= 0
[[nodiscard]] Vec2 saturated(const Vec2& force, double most) noexcept;

/// `target`, or where that is further than `slew` from `last` the point at that distance on the way to it.
/// Between two vectors of a disc the way stays inside: what is no longer than a limit stays so.
/// @param last    the force of the tick before, N   @param slew  N, >= 0, infinity: no limit
[[nodiscard]] Vec2 within_slew(const Vec2& last, const Vec2& target, double slew) noexcept;

/// The gain of the ramp a tick later, 0 off ... 1 on. @param step  share a tick, > 0
[[nodiscard]] double ramped(double gain, double step, bool enable) noexcept;

}  // namespace palpate::engine
