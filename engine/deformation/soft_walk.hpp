#pragma once

#include "engine/deformation/soft_shape.hpp"
#include "engine/friction/god_object.hpp"

namespace palpate::engine {

/// The god-object's walk on the shape as it is now: the same law as walk_god_object() without a
/// vertex slew, on curves that no certificate could be kept for.
///
/// On a span it goes on by Newton's iteration, at most 1/32 of the span in a step, to the first
/// place found where the stretch fits the cone. V is convex or concave as the shape has it now.
/// What the spring stores never rises on the way; should rounding make it so, the god-object stays
/// where it was, and `unproven` says it.
/// @param place  of the god-object; moved
[[nodiscard]] Walk walk_on_soft(const SoftShape& shape,
                                const SoftState& state,
                                Place& place,
                                const Vec2& hip,
                                double mu) noexcept;

}  // namespace palpate::engine
