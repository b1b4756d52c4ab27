#pragma once

#include <vector>

#include "engine/geometry/nurbs_curve.hpp"

/// The objects of the thesis' figures. Its control points are not printed; these are of the kind
/// that its text describes.
namespace palpate::data {

/// Control polygons of one object: four points a curve, m, the object on the right of travel.
using Polygons = std::vector<std::vector<engine::Vec2>>;

/// A single cubic with a narrow top (radius 5.6 mm), 0.1 m wide (2.1.3: high curvature).
[[nodiscard]] Polygons narrow_arch();
/// Three cubics that close a bulging triangle (2.1.4).
[[nodiscard]] Polygons three_curves();
/// Two convex cubics, 0.1 m wide, that meet at a vertex of 22 degrees; both ends open (3.2.1).
[[nodiscard]] Polygons two_curves();

/// The curves of the polygons, u in [0, 1] on each.
[[nodiscard]] std::vector<engine::NurbsCurve<2>> curves_of(const Polygons& polygons);

}  // namespace palpate::data
