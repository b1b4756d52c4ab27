#pragma once

#include "tests/support/surface_oracle.hpp"

namespace palpate::tests {

inline std::vector<double> random_knots(Random& random, int degree, int inner, bool repeats) {
    const auto p = static_cast<std::size_t>(degree);
    std::vector<double> knots(p + 1, 0.0);
    double at = 0.0;
    for (int i = 0; i < inner; ++i) {
        at += random.in(0.2, 1.0);
        const int times = repeats && random.coin() ? 1 + random.below(degree) : 1;
        knots.insert(knots.end(), static_cast<std::size_t>(times), at);
    }
    at += random.in(0.2, 1.0);
    knots.insert(knots.end(), p + 1, at);
    return knots;
}

/// Anything goes: degrees 1 to 9, control points at random in a box, repeated points, folded
/// sheets; but none repeated of degree 1, where a span could be a mere curve.
inline SurfaceData random_surface(
    Random& random, double size, double decades, int max_degree = 9, bool rough = true) {
    SurfaceData d;
    d.degree_u = 1 + random.below(max_degree);
    d.degree_v = 1 + random.below(max_degree);
    d.knots_u = random_knots(random, d.degree_u, random.below(3), true);
    d.knots_v = random_knots(random, d.degree_v, random.below(3), true);
    const std::size_t m = d.knots_u.size() - static_cast<std::size_t>(d.degree_u) - 1;
    const std::size_t n = d.knots_v.size() - static_cast<std::size_t>(d.degree_v) - 1;
    for (std::size_t i = 0; i < m; ++i) {
        d.points.emplace_back();
        d.weights.emplace_back();
        for (std::size_t j = 0; j < n; ++j) {
            engine::Vec3 p{random.in(-0.5, 0.5), random.in(-0.5, 0.5), random.in(-0.5, 0.5)};
            if (!rough) {  // a wavy sheet
                p.x = static_cast<double>(i) / static_cast<double>(m - 1) - 0.5 + 0.1 * p.x;
                p.y = static_cast<double>(j) / static_cast<double>(n - 1) - 0.5 + 0.1 * p.y;
                p.z *= 0.3;
            }
            const bool repeated = j > 0 && random.below(8) == 0 && d.degree_v > 1;
            d.points[i].push_back(repeated ? d.points[i].back() : size * p);
            d.weights[i].push_back(decades > 0.0 ? random.decade(-decades, decades) : 1.0);
        }
    }
    return d;
}

/// The bicubic test object of the specification: 8 x 8 points, 0.1 m wide, 25 patches, with a dome
/// and waves; weights e^-log .. e^log.
inline SurfaceData bicubic_8x8(Random& random, double log, double wave = 0.01) {
    SurfaceData d{.degree_u = 3, .degree_v = 3};
    d.knots_u = {0, 0, 0, 0, 1, 2, 3, 4, 5, 5, 5, 5};
    d.knots_v = d.knots_u;
    for (int i = 0; i < 8; ++i) {
        d.points.emplace_back();
        d.weights.emplace_back();
        for (int j = 0; j < 8; ++j) {
            const double x = i / 7.0 - 0.5;
            const double y = j / 7.0 - 0.5;
            const double z = -0.04 * (x * x + y * y) + wave * random.in(-0.5, 0.5);
            d.points.back().push_back(engine::Vec3{0.1 * x, 0.1 * y, z});
            d.weights.back().push_back(std::exp(random.in(-log, log)));
        }
    }
    if (log == 0.0) {
        d.weights.clear();
    }
    return d;
}

/// The nine-point circle of radius r about (0, 0) (The NURBS Book, example 7.1).
struct Circle {
    std::vector<double> knots{0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4};
    std::vector<engine::Vec2> points;
    std::vector<double> weights;

    explicit Circle(double r) {
        const double s = std::sqrt(0.5);
        const double x[9] = {1, 1, 0, -1, -1, -1, 0, 1, 1};
        const double y[9] = {0, 1, 1, 1, 0, -1, -1, -1, 0};
        for (int i = 0; i < 9; ++i) {
            points.push_back(engine::Vec2{r * x[i], r * y[i]});
            weights.push_back(i % 2 == 0 ? 1.0 : s);
        }
    }
};

/// A profile (distance from the axis, height) turned about z, u round the axis counter-clockwise.
/// The profile runs upwards for an outward normal.
inline SurfaceData revolved(const std::vector<engine::Vec2>& profile,
                            const std::vector<double>& weights,
                            int degree,
                            const std::vector<double>& knots) {
    const Circle circle(1.0);
    SurfaceData d{.degree_u = 2, .degree_v = degree, .knots_u = circle.knots, .knots_v = knots};
    for (std::size_t i = 0; i < 9; ++i) {
        d.points.emplace_back();
        d.weights.emplace_back();
        for (std::size_t j = 0; j < profile.size(); ++j) {
            const engine::Vec2 e = profile[j].x * circle.points[i];
            d.points.back().push_back(engine::Vec3{e.x, e.y, profile[j].y});
            d.weights.back().push_back(circle.weights[i] * weights[j]);
        }
    }
    return d;
}

inline SurfaceData cylinder(double r, double height) {
    return revolved({engine::Vec2{r, 0.0}, engine::Vec2{r, height}}, {1, 1}, 1, {0, 0, 1, 1});
}

inline SurfaceData sphere(double r) {
    const double s = std::sqrt(0.5);
    return revolved({engine::Vec2{0, -r}, engine::Vec2{r, -r}, engine::Vec2{r, 0},
                     engine::Vec2{r, r}, engine::Vec2{0, r}},
                    {1, s, 1, s, 1}, 2, {0, 0, 0, 1, 1, 2, 2, 2});
}

/// Big radius R, small radius r.
inline SurfaceData torus(double big, double small) {
    const Circle circle(small);
    std::vector<engine::Vec2> profile;
    for (const engine::Vec2& p : circle.points) {
        profile.push_back(engine::Vec2{big + p.x, p.y});
    }
    return revolved(profile, circle.weights, 2, circle.knots);
}

/// A plane side with four corners, seen from outside counter-clockwise.
inline SurfaceData side(const engine::Vec3& a,
                        const engine::Vec3& b,
                        const engine::Vec3& c,
                        const engine::Vec3& d) {
    return {.degree_u = 1,
            .degree_v = 1,
            .knots_u = {0, 0, 1, 1},
            .knots_v = {0, 0, 1, 1},
            .points = {{a, d}, {b, c}},
            .weights = {}};
}

/// The square |x|, |y| <= half at z = 0, normal +z.
inline SurfaceData plane(double half) {
    return side({-half, -half, 0.0}, {half, -half, 0.0}, {half, half, 0.0}, {-half, half, 0.0});
}

inline std::shared_ptr<const engine::NurbsSurface> made(const SurfaceData& d) {
    return std::make_shared<const engine::NurbsSurface>(make_surface(d));
}

}  // namespace palpate::tests
