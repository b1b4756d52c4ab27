#pragma once

#include "engine/geometry/rational_bezier.hpp"

namespace palpate::engine {

/// The straight line from `from` to `to` as a span of degree 1.
/// @throws std::invalid_argument if the ends coincide or are not finite
[[nodiscard]] RationalBezier<2> make_line(const Vec2& from, const Vec2& to);

/// The circular arc from `from` to `to`, exact: a rational quadratic with weights 1, cos(a), 1,
/// where sin(a) = curvature * chord / 2 (Piegl & Tiller, The NURBS Book, 7.3). Curvature 0 gives
/// the line.
///
/// @param curvature  1/m; > 0 bulges to the left of travel (convex: the object is on the right)
/// @throws std::invalid_argument if |curvature| * chord / 2 > kMaxArcSine (the arc would come close
///         to a half circle, where one quadratic span no longer exists), or for ends as make_line
[[nodiscard]] RationalBezier<2> make_arc(const Vec2& from, const Vec2& to, double curvature);

/// Sine of the largest half sweep of one span; 0.99 is a sweep of 164 degrees.
inline constexpr double kMaxArcSine = 0.99;

}  // namespace palpate::engine
