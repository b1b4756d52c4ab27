#pragma once

#include "tests/bench/objects.hpp"

namespace palpate::bench {

/// How a hand goes along an object, at 1 kHz.
struct HandPlan {
    double seconds = 20.0;
    double nearest = -3e-3;  ///< offset along the outward normal, m; < 0 is inside
    double farthest = 3e-3;
    bool closed = false;  ///< goes round, instead of to and fro
    std::uint64_t seed = 1;
};

inline constexpr double kFastestHand = 0.3;   ///< m/s
inline constexpr double kEncoderStep = 1e-5;  ///< m

/// HIP at each tick: along the outline at 0.04 to 0.26 m/s, round vertices through their fan of
/// normals, to and fro across the outline, with a tremor of 9 Hz and 0.05 mm, quantised to 10 um as
/// a device does. Never faster than kFastestHand before the quantisation.
[[nodiscard]] std::vector<engine::Vec2> hand_along(const Object& object, const HandPlan& plan);

}  // namespace palpate::bench
