#pragma once

#include <vector>

#include "engine/geometry/rational_bezier.hpp"

/// Drive and load of a span in long double, by Bernstein rows made afresh for each HIP, and their first root.
namespace palpate::stress {

using Real = long double;
using Row = std::vector<Real>;

struct Point {
    Real x = 0.0L;
    Real y = 0.0L;
};

[[nodiscard]] Point place(const engine::Vec2& a);
[[nodiscard]] Real dot(const Point& a, const Point& b);
[[nodiscard]] Real turn(const Point& a, const Point& b);
[[nodiscard]] Point unit(const Point& a);

/// A row at x in [0, 1].
[[nodiscard]] Real value(Row f, Real x);

/// Control points that repeat an end of a span.
[[nodiscard]] std::size_t repeats(const engine::RationalBezier<2>& span, bool at_end);

/// Ahead of a place on a span, in the direction of travel, seen from h.
struct Ahead {
    Row px, py, w;  ///< w (C - origin), w
    Row tx, ty;     ///< along C', in the direction of travel
    Row a, b;       ///< outside of the cone: both > 0
    Row noise;
    Point tangent;  ///< unit, in the direction of travel, at the start
    Point origin;
};

/// @param x, y  of the way along the span in the direction of travel, x + y = 1
[[nodiscard]] Ahead ahead_of(const engine::RationalBezier<2>& span,
                             const engine::Vec2& h,
                             Real mu,
                             Real x,
                             Real y,
                             bool forward);

/// The first root of min(a, b) on [0, 1]: between lo and hi. Where rounding decides, all that it may be.
struct Root {
    Real lo;
    Real hi;
};
struct Roots {
    std::vector<Root> at;
    bool blank = false;  ///< over a stretch no digit is left
};

/// Adds what may be the first root. @return whether there is one for certain
bool first_root_of(const Ahead& ahead, Roots& roots);

}  // namespace palpate::stress
