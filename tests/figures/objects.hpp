#pragma once

#include "tests/support/thesis_objects.hpp"

/// The objects of the thesis' figures, beside tests::two_polygons(). Its control points are not
/// printed; these are of the kind that its text describes.
namespace palpate::figures {

using tests::curves_of;
using tests::Polygons;

/// A single cubic with a narrow top (radius 5.6 mm), 0.1 m wide (2.1.3: high curvature).
[[nodiscard]] Polygons narrow_arch();
/// Three cubics that close a bulging triangle (2.1.4).
[[nodiscard]] Polygons three_curves();

}  // namespace palpate::figures
