#pragma once

#include <array>
#include <cstdint>

#include "engine/geometry/vec.hpp"

namespace palpate::engine {

/// Only strokes of this length count, m: no tremor, no flickering count, no finger that scrubs to
/// and fro on a spot adds up to a stuck encoder.
inline constexpr double kStroke = 0.010;

/// For each axis: what HIP did since its count last changed. A plain value.
struct EncoderWatch {
    struct Still {
        Vec2 from{};             ///< start of the stroke, m
        std::int32_t other = 0;  ///< count of the other axis there
        double travel = 0.0;     ///< of whole strokes, m
    };
    bool started = false;
    std::array<std::int32_t, 2> counts{};
    std::array<Still, 2> still{};
};

/// True when one axis did not change by a single count while the other led HIP over more than
/// `travel` m in strokes.
///
/// Nothing has to be known of the encoders. With one joint at rest HIP is bound to the circle of a
/// free link about a resting elbow; a sound encoder stands still only while the hand follows that
/// circle within one count, some 0.1 mm with 4,880 counts a turn. A straight way touches a circle
/// of R = 90 mm so closely for sqrt(8 R 0.1 mm) = 8.5 mm, less than a stroke. A stroke takes the
/// curvature and the direction of the circle at once, and the limit asks for several without a
/// count in between: the longest that 17 hours of simulated hands made is 25 mm
/// (tests/engine/safety_encoder_test.cpp, with 3,000 seeds).
/// @param hip  m
[[nodiscard]] bool encoder_stuck(EncoderWatch& watch,
                                 const std::array<std::int32_t, 2>& counts,
                                 const Vec2& hip,
                                 double travel) noexcept;

}  // namespace palpate::engine
