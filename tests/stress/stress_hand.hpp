#pragma once

#include "engine/geometry/outline.hpp"
#include "tests/support/random.hpp"

/// Random hands: they rub along the outline, press towards centres of curvature and vertices,
/// wander, rest and jump; some ticks are not finite. Up to 10 m/s where the object is large enough.
namespace palpate::stress {

struct HandSpec {
    std::size_t ticks = 400;
    double period = 0.001;  ///< s
    bool broken = true;     ///< NaN and infinities may occur
    bool far = false;       ///< so may HIPs up to 1e150 m away
    bool leaps = false;     ///< anywhere on every tick, inside more often than not
    bool gentle = false;    ///< a hundredth of the object a tick at most; lifts off before it jumps
};

[[nodiscard]] std::vector<engine::Vec2> random_path(tests::Random& random,
                                                    const engine::Outline& outline,
                                                    const HandSpec& spec);

/// Diagonal of the outline's control points, m.
[[nodiscard]] double size_of(const engine::Outline& outline);

}  // namespace palpate::stress
