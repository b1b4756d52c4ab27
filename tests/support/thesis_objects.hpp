#pragma once

#include "engine/geometry/nurbs_curve.hpp"
#include "tests/support/foot_oracle.hpp"

namespace palpate::tests {

/// A polynomial Bezier curve as a NURBS curve on [0, 1].
inline engine::NurbsCurve<2> bezier(std::vector<engine::Vec2> points) {
    const std::size_t degree = points.size() - 1;
    std::vector<double> knots(degree + 1, 0.0);
    knots.insert(knots.end(), degree + 1, 1.0);
    return engine::NurbsCurve<2>(static_cast<int>(degree), knots,
                                 std::span<const engine::Vec2>(points));
}

inline engine::NurbsCurve<2> line(engine::Vec2 from, engine::Vec2 to) {
    return bezier({from, to});
}

/// Control polygons of one object: four points a curve, m, the object on the right of travel.
using Polygons = std::vector<std::vector<engine::Vec2>>;

/// Two convex cubics, 0.1 m wide, that meet in a vertex of 22 degrees: the kind of object that
/// chapter 3.2.1 of the thesis is about. Both ends open.
inline Polygons two_polygons() {
    constexpr double kHalfTurn = 11.0 * std::numbers::pi / 180.0;
    const double fall = 0.02 * std::tan(kHalfTurn);
    const engine::Vec2 top{0.0, 0.032};
    return {{{-0.05, 0.0}, {-0.042, 0.012}, {-0.02, top.y - fall}, top},
            {top, {0.02, top.y - fall}, {0.042, 0.012}, {0.05, 0.0}}};
}

/// The curves of the polygons, u in [0, 1] on each.
inline std::vector<engine::NurbsCurve<2>> curves_of(const Polygons& polygons) {
    std::vector<engine::NurbsCurve<2>> curves;
    for (const std::vector<engine::Vec2>& polygon : polygons) {
        curves.push_back(bezier(polygon));
    }
    return curves;
}

inline std::vector<engine::NurbsCurve<2>> two_cubics() {
    return curves_of(two_polygons());
}

/// Distance from `h` to the nearest point of all curves, m, by the oracle.
inline double true_distance(const Polygons& polygons, const engine::Vec2& h) {
    long double best = std::numeric_limits<long double>::infinity();
    for (const std::vector<engine::Vec2>& polygon : polygons) {
        best = std::min(best, FootOracle(bezier_data(polygon)).closest(h).distance);
    }
    return static_cast<double>(best);
}

}  // namespace palpate::tests
