#pragma once

#include "engine/geometry/nurbs_curve.hpp"
#include "tests/support/std.hpp"

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

/// Distance from `h` to the nearest point of all curves, m, good to about 1e-12: 400 samples a
/// curve, then golden section about the best. Written for tests alone.
inline double true_distance(const std::vector<engine::NurbsCurve<2>>& curves,
                            const engine::Vec2& h) {
    constexpr int kSamples = 400;
    constexpr double kGolden = 0.6180339887498949;
    double best = std::numeric_limits<double>::infinity();
    for (const auto& curve : curves) {
        const auto far = [&](double u) {
            return glm::length(curve.at(u).point - h);
        };
        const double width = curve.back() - curve.front();
        int at = 0;
        for (int i = 1; i <= kSamples; ++i) {
            at = far(curve.front() + width * i / kSamples) <
                         far(curve.front() + width * at / kSamples)
                   ? i
                   : at;
        }
        double lo = curve.front() + width * std::max(at - 1, 0) / kSamples;
        double hi = curve.front() + width * std::min(at + 1, kSamples) / kSamples;
        for (int i = 0; i < 40; ++i) {
            const double a = hi - kGolden * (hi - lo);
            const double b = lo + kGolden * (hi - lo);
            (far(a) < far(b) ? hi : lo) = far(a) < far(b) ? b : a;
        }
        best = std::min({best, far(lo), far(hi)});
    }
    return best;
}

}  // namespace palpate::tests
