#pragma once

#include <vector>

#include "engine/geometry/rational_bezier.hpp"

namespace palpate::engine {

/// Parameters in (0, 1) where the span stands still, C' = 0: cusps, rising. Found by halving the
/// hull of the hodograph's numerator P' W - P W', so that none is missed. Empty for most curves.
[[nodiscard]] std::vector<double> cusps_of(const RationalBezier<2>& curve);

/// The stretch [lo, hi] of a span as a span of its own (Piegl & Tiller, The NURBS Book, 5.4).
[[nodiscard]] RationalBezier<2> stretch_of(const RationalBezier<2>& curve, double lo, double hi);

/// Along the tangent at the start (`end` false) or at the end, in the direction of travel, m: from
/// or to the first control point that lies apart, also where C' = 0.
[[nodiscard]] Vec2 end_leg(const RationalBezier<2>& curve, bool end) noexcept;
/// The unit tangent there.
[[nodiscard]] Vec2 end_tangent(const RationalBezier<2>& curve, bool end) noexcept;

}  // namespace palpate::engine
