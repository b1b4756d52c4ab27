#pragma once

#include <array>
#include <cstdint>

#include "engine/geometry/vec.hpp"

namespace palpate::engine {

/// Only strokes of this length count, m: no tremor, no flickering count, no finger that scrubs to
/// and fro on a spot adds up to a stuck encoder.
inline constexpr double kStroke = 0.010;

/// A motor that pushes less says nothing of its axis, N: a straight axis may rest while others
/// move.
inline constexpr double kPush = 0.5;

/// For each axis: what HIP did since its count last changed. A plain value.
struct EncoderWatch {
    using Counts = std::array<std::int32_t, 3>;
    struct Still {
        Vec3 from{};          ///< start of the stroke, m
        Counts counts{};      ///< there
        double travel = 0.0;  ///< of whole strokes, m
    };
    bool started = false;
    Counts counts{};
    std::array<Still, 3> still{};
};

/// True when one axis did not change by a single count while others led HIP over more than
/// `travel` m in strokes. Two axes, of a linkage in the plane:
///
/// Nothing has to be known of the encoders. With one joint at rest HIP is bound to the circle of a
/// free link about a resting elbow; a sound encoder stands still only while the hand follows that
/// circle within one count, some 0.1 mm with 4,880 counts a turn. A straight way touches a circle
/// of R = 90 mm so closely for sqrt(8 R 0.1 mm) = 8.5 mm, less than a stroke. A stroke takes the
/// curvature and the direction of the circle at once, and the limit asks for several without a
/// count in between: the longest that 17 hours of simulated hands made is 25 mm
/// (tests/engine/safety_encoder_test.cpp, with 3,000 seeds).
///
/// Three straight axes are each alone, and one may well rest. It does not while its motor pushes by
/// more than kPush: a hand that strokes to the side holds against it by its own force, which is
/// never as steady as the 0.02 N of a count of 26 um at 800 N/m. So only strokes under such a push
/// count, and those before and after a rest add up: over a hill the force comes and goes with every
/// stroke.
/// @param counts  of `axes` encoders, 2 or 3   @param hip  m
/// @param push    force of each motor's axis at the tick before, N; ignored with two axes
[[nodiscard]] bool encoder_stuck(EncoderWatch& watch,
                                 const EncoderWatch::Counts& counts,
                                 const Vec3& hip,
                                 int axes,
                                 const Vec3& push,
                                 double travel) noexcept;

/// A force above this with no count at all asks whether the encoders live, N.
inline constexpr double kStillForce = 0.3;
/// s without a count until the force eases off, and until it ends.
inline constexpr double kStillEase = 0.2;
inline constexpr double kStillTrip = 0.3;

/// Since when no encoder has counted while a force was on. A plain value.
struct StillWatch {
    enum class State : std::uint8_t { moves, eases, dead };
    bool started = false;
    EncoderWatch::Counts counts{};
    double since = 0.0;  ///< s
    bool eases = false;
};

/// All encoders together, which their common supply or a hung board stops at once: EncoderWatch
/// needs one that still moves, and a frozen place keeps the force as it was for ever.
///
/// A held handle may rest within one count under a force that rests. The force itself tells the two
/// apart: `eases` asks for it to go out within kStillTrip - kStillEase, and a hand that bore it
/// follows. The stiffest fingers and wrists give way by 1 mm a newton (A. Z. Hajian and R. D. Howe,
/// J. Biomech. Eng. 119, 1997: up to 1 kN/m), which for kStillForce is three counts of the coarsest
/// encoders. One count, and the force comes back at the ramp's pace.
/// @param force  |command| at the tick before, N   @param now  s, never less than before
[[nodiscard]] StillWatch::State stillness(StillWatch& watch,
                                          const EncoderWatch::Counts& counts,
                                          double force,
                                          double now) noexcept;

}  // namespace palpate::engine
