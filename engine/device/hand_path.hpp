#pragma once

#include <array>

#include "engine/device/timed_way.hpp"
#include "engine/geometry/vec.hpp"

namespace palpate::engine {

/// How a simulated hand means to explore. It knows the chords A-V-B (as a person knows the
/// pictures), never the curvature between them.
struct Exploration {
    Vec2 start{0.0, 0.060};  ///< m, above the vertex
    Vec2 a{-0.040, 0.0};     ///< m
    Vec2 vertex{0.0, 0.040};
    Vec2 b{0.040, 0.0};
    double speed = 0.08;         ///< m/s along the path
    double press_depth = 0.007;  ///< m inside the chords that the hand aims for
    int sweeps = 4;              ///< there, back, ...
    double tremor = 0.00005;     ///< m, amplitude of the 9 Hz tremor of a healthy hand
    double tremor_phase = 0.0;   ///< rad
};

/// Where the hand means to be at each moment: down beside A, up and over the
/// vertex, down the other side and back, and off again.
class HandPath {
public:
    /// @param plan  speed > 0, sweeps >= 0
    explicit HandPath(const Exploration& plan);

    using Intention = TimedWay<2>::Moment;  ///< the velocity is of the path alone

    /// @param t  s since the start; before 0 the start, after the end the last point
    [[nodiscard]] Intention at(double t) const noexcept;
    /// At two moments, for little more than the work of one.
    [[nodiscard]] std::array<Intention, 2> at(double t, double later) const noexcept;
    /// When the hand is off again, s since the start.
    [[nodiscard]] double duration() const noexcept { return way_.duration(); }

private:
    Exploration plan_;
    TimedWay<2> way_;
};

}  // namespace palpate::engine
