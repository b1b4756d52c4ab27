#pragma once

#include "tests/bench/errors.hpp"

namespace palpate::bench {

/// A bicubic NURBS surface, clamped, as a scene file would hold it.
struct Surface {
    std::string name;
    std::size_t columns = 0;  ///< control points along u
    std::size_t rows = 0;     ///< along v
    std::vector<double> knots_u;
    std::vector<double> knots_v;
    std::vector<Vec3> points;  ///< point (i, j) is points[j * columns + i], m
    std::vector<double> weights;
};

inline constexpr int kSurfaceDegree = 3;

/// An 8 x 8 patch of 0.1 m with hills, all weights 1; and the same with weights e^-0.7 to e^0.7.
[[nodiscard]] std::vector<Surface> contact_surfaces();

/// HIP over the surface, <= 0.18 m/s, -3 to +3 mm along its normal, tremor and quantisation as
/// hand_along.
[[nodiscard]] std::vector<Vec3> hand_over(const Surface& surface, double seconds);

/// By tests::SurfaceOracle.
[[nodiscard]] std::vector<Truth<3>> truths(const Surface& surface, const std::vector<Vec3>& path);

/// Corners of 2 n^2 triangles on the surface, row by row, (n + 1) a row.
[[nodiscard]] std::vector<Vec3> grid_of(const Surface& surface, std::size_t n);

/// Seam: engine/contact's surface solvers.
[[nodiscard]] Methods<3> own_surface_methods(const Surface& surface);

}  // namespace palpate::bench
