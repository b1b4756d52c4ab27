#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "engine/geometry/nurbs_curve.hpp"

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

/// Two convex cubics, 0.1 m wide, that meet in a vertex of 22 degrees: the kind of object that
/// chapter 3.2.1 of the thesis is about. Open, the object below.
inline std::vector<engine::NurbsCurve<2>> two_cubics() {
    using engine::Vec2;
    const double rise = 0.02 * std::tan(11.0 * 3.14159265358979323846 / 180.0);
    const Vec2 top{0.0, 0.032};
    const Vec2 left{-0.02, 0.032 - rise};
    const Vec2 right{0.02, 0.032 - rise};
    return {bezier({Vec2{-0.05, 0.0}, Vec2{-0.042, 0.012}, left, top}),
            bezier({top, right, Vec2{0.042, 0.012}, Vec2{0.05, 0.0}})};
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
