#include "engine/geometry/cusps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/math/bernstein.hpp"

namespace palpate::engine {
namespace {

/// Halving ends at 2^-40 of the span: a stretch of 1e-13 m on an 80 mm curve.
constexpr int kMaxHalvings = 40;

/// Cusps nearer than this to each other or to an end of the span are one, or the end itself.
constexpr double kSameCusp = 1e-9;

/// A hodograph below this share of its largest value is zero within rounding.
constexpr double kNoise = 64.0 * std::numeric_limits<double>::epsilon();

/// Control points nearer than this share of the size are the same.
constexpr double kSamePoint = 1e-12;

struct Hodograph {
    double lo = 0.0;
    double hi = 1.0;
    Bernstein x;
    Bernstein y;
};

Hodograph hodograph(const RationalBezier<2>& curve) {
    Bernstein px;
    Bernstein py;
    Bernstein w;
    for (std::size_t i = 0; i <= static_cast<std::size_t>(curve.degree()); ++i) {
        w.push_back(curve.weight(i));
        px.push_back(curve.weight(i) * curve.local_point(i).x);
        py.push_back(curve.weight(i) * curve.local_point(i).y);
    }
    if (curve.polynomial()) {
        return {.x = derivative(px), .y = derivative(py)};
    }
    return {.x = wronskian(px, w), .y = wronskian(py, w)};
}

/// 0 is provably not among the values of f.
bool avoids_zero(const Bernstein& f, double noise) {
    const auto [low, high] = std::minmax_element(f.begin(), f.end());
    return *low > noise || *high < -noise;
}

/// Homogeneous control points of [0, u] and [u, 1].
struct Halves {
    std::vector<Vec3> left;
    std::vector<Vec3> right;
};

Halves cut_at(std::vector<Vec3> points, double u) {
    Halves halves{{}, points};
    const std::size_t n = points.size();
    for (std::size_t level = 0; level < n; ++level) {
        halves.left.push_back(points[0]);
        halves.right[n - 1 - level] = points[n - 1 - level];
        for (std::size_t k = 0; k + 1 < n - level; ++k) {
            points[k] = (1.0 - u) * points[k] + u * points[k + 1];
        }
    }
    return halves;
}

}  // namespace

std::vector<double> cusps_of(const RationalBezier<2>& curve) {
    std::vector<double> cusps;
    std::vector<Hodograph> stack{hodograph(curve)};
    const double noise =
        kNoise * std::max(largest_magnitude(stack[0].x), largest_magnitude(stack[0].y));
    while (!stack.empty()) {
        Hodograph at = std::move(stack.back());
        stack.pop_back();
        if (avoids_zero(at.x, noise) || avoids_zero(at.y, noise)) {
            continue;
        }
        if (at.hi - at.lo <= std::ldexp(1.0, -kMaxHalvings)) {
            const double u = 0.5 * (at.lo + at.hi);
            const double before = cusps.empty() ? 0.0 : cusps.back();
            if (u - before > kSameCusp && 1.0 - u > kSameCusp) {
                cusps.push_back(u);
            }
            continue;
        }
        Hodograph right;
        right.hi = at.hi;
        right.lo = at.hi = 0.5 * (at.lo + at.hi);
        right.x = cut_in_half(at.x);
        right.y = cut_in_half(at.y);
        stack.push_back(std::move(right));
        stack.push_back(std::move(at));
    }
    return cusps;
}

RationalBezier<2> stretch_of(const RationalBezier<2>& curve, double lo, double hi) {
    std::vector<Vec3> points;
    for (std::size_t i = 0; i <= static_cast<std::size_t>(curve.degree()); ++i) {
        const double w = curve.weight(i);
        points.push_back({w * curve.local_point(i).x, w * curve.local_point(i).y, w});
    }
    points = cut_at(std::move(points), hi).left;
    points = cut_at(std::move(points), lo / hi).right;
    std::vector<Vec2> apart;
    std::vector<double> weights;
    for (const Vec3& p : points) {
        apart.push_back(curve.origin() + Vec2{p.x, p.y} / p.z);
        weights.push_back(p.z);
    }
    return {apart, weights};
}

Vec2 end_tangent(const RationalBezier<2>& curve, bool end) noexcept {
    const auto n = static_cast<std::size_t>(curve.degree());
    const double same = kSamePoint * glm::length(curve.box().size());
    const Vec2 here = curve.local_point(end ? n : 0);
    for (std::size_t i = 1; i <= n; ++i) {
        const Vec2 leg = end ? here - curve.local_point(n - i) : curve.local_point(i) - here;
        const double length = glm::length(leg);
        if (length > same) {
            return leg / length;
        }
    }
    return {1.0, 0.0};
}

}  // namespace palpate::engine
