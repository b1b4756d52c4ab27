#include "engine/geometry/cusps.hpp"

#include <cmath>
#include <limits>

#include "engine/math/bernstein.hpp"

namespace palpate::engine {
namespace {

/// Halving ends at 2^-40 of the span: a stretch of 1e-13 m on an 80 mm curve.
constexpr int kMaxHalvings = 40;

/// Cusps nearer than this to each other or to an end of the span are one, or the end itself.
constexpr double kSameCusp = 1e-9;

/// Coefficients of a hodograph below this share of the terms that they are sums of are rounding.
constexpr double kNoise = 64.0 * std::numeric_limits<double>::epsilon();

/// Control points nearer than this share of the size are the same.
constexpr double kSamePoint = 1e-12;

/// One component of the hodograph and, of each coefficient, how much of it may be rounding. Both
/// are halved alike: beside light control points the hodograph is 1e-12 of what it is elsewhere.
struct Component {
    Bernstein value;
    Bernstein noise;

    [[nodiscard]] bool avoids_zero() const noexcept {
        bool above = true;
        bool below = true;
        for (std::size_t k = 0; k < value.size(); ++k) {
            above = above && value[k] > noise[k];
            below = below && value[k] < -noise[k];
        }
        return above || below;
    }
    [[nodiscard]] bool is_noise() const noexcept {
        for (std::size_t k = 0; k < value.size(); ++k) {
            if (std::fabs(value[k]) > noise[k]) {
                return false;
            }
        }
        return true;
    }
    [[nodiscard]] Component cut() { return {cut_in_half(value), cut_in_half(noise)}; }
};

/// P' W - P W' (P' for polynomials) over [lo, hi].
struct Hodograph {
    double lo = 0.0;
    double hi = 1.0;
    Component x;
    Component y;
};

Component component(const Bernstein& p, const Bernstein& w, bool polynomial) {
    const Bernstein size = magnitudes(p);
    Component c;
    if (polynomial) {
        c = {derivative(p), derivative_size(size)};
    } else {
        c = {wronskian(p, w), wronskian_size(size, w)};
    }
    for (double& v : c.noise) {
        v *= kNoise;
    }
    return c;
}

Hodograph hodograph(const RationalBezier<2>& curve) {
    Bernstein px;
    Bernstein py;
    Bernstein w;
    for (std::size_t i = 0; i <= static_cast<std::size_t>(curve.degree()); ++i) {
        w.push_back(curve.weight(i));
        px.push_back(curve.weight(i) * curve.local_point(i).x);
        py.push_back(curve.weight(i) * curve.local_point(i).y);
    }
    Hodograph h;
    h.x = component(px, w, curve.polynomial());
    h.y = component(py, w, curve.polynomial());
    return h;
}

}  // namespace

std::vector<double> cusps_of(const RationalBezier<2>& curve) {
    struct Still {
        double lo;
        double hi;
    };
    std::vector<Still> stills;  // stretches in which the curve stands still, rising, none touching
    std::vector<Hodograph> stack{hodograph(curve)};
    const double shortest = std::ldexp(1.0, -kMaxHalvings);
    while (!stack.empty()) {
        Hodograph at = std::move(stack.back());
        stack.pop_back();
        if (at.x.avoids_zero() || at.y.avoids_zero()) {
            continue;
        }
        // Where all is rounding, more halvings tell nothing more, and there may be 2^40 of them.
        if (at.hi - at.lo <= shortest || (at.x.is_noise() && at.y.is_noise())) {
            if (!stills.empty() && at.lo - stills.back().hi <= kSameCusp) {
                stills.back().hi = at.hi;
            } else {
                stills.push_back({at.lo, at.hi});
            }
            continue;
        }
        Hodograph right;
        right.hi = at.hi;
        right.lo = at.hi = 0.5 * (at.lo + at.hi);
        right.x = at.x.cut();
        right.y = at.y.cut();
        stack.push_back(std::move(right));
        stack.push_back(std::move(at));
    }
    std::vector<double> cusps;
    for (const Still& still : stills) {
        if (still.lo > kSameCusp && 1.0 - still.hi > kSameCusp) {
            cusps.push_back(0.5 * (still.lo + still.hi));
        }
    }
    return cusps;
}

RationalBezier<2> stretch_of(const RationalBezier<2>& curve, double lo, double hi) {
    std::vector<Vec3> points;
    for (std::size_t i = 0; i <= static_cast<std::size_t>(curve.degree()); ++i) {
        const double w = curve.weight(i);
        points.push_back({w * curve.local_point(i).x, w * curve.local_point(i).y, w});
    }
    points = CutAt(std::move(points), hi).left;
    points = CutAt(std::move(points), lo / hi).right;
    std::vector<Vec2> apart;
    std::vector<double> weights;
    for (const Vec3& p : points) {
        apart.push_back(Vec2{p.x, p.y} / p.z);
        weights.push_back(p.z);
    }
    return {apart, weights, curve.origin()};
}

Vec2 end_leg(const RationalBezier<2>& curve, bool end) noexcept {
    const auto n = static_cast<std::size_t>(curve.degree());
    const double same = kSamePoint * glm::length(curve.box().size());
    const Vec2 here = curve.local_point(end ? n : 0);
    for (std::size_t i = 1; i <= n; ++i) {
        const Vec2 leg = end ? here - curve.local_point(n - i) : curve.local_point(i) - here;
        if (glm::length(leg) > same) {
            return leg;
        }
    }
    return {1.0, 0.0};
}

Vec2 end_tangent(const RationalBezier<2>& curve, bool end) noexcept {
    const Vec2 leg = end_leg(curve, end);
    return leg / glm::length(leg);
}

}  // namespace palpate::engine
