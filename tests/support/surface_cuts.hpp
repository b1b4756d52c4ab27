#pragma once

#include "tests/support/surfaces.hpp"

/// Surfaces in pieces: cut apart without a change of shape, and put together from plane sides.
namespace palpate::tests {

/// The same surface with u and v changed places and u turned round: the outward normal stays.
inline SurfaceData turned(const SurfaceData& d) {
    SurfaceData t{.degree_u = d.degree_v, .degree_v = d.degree_u, .knots_u = d.knots_v};
    const double sum = d.knots_u.front() + d.knots_u.back();
    for (auto knot = d.knots_u.rbegin(); knot != d.knots_u.rend(); ++knot) {
        t.knots_v.push_back(sum - *knot);
    }
    const std::size_t m = d.points.size();
    for (std::size_t a = 0; a < d.points[0].size(); ++a) {
        t.points.emplace_back();
        if (!d.weights.empty()) {
            t.weights.emplace_back();
        }
        for (std::size_t b = 0; b < m; ++b) {
            t.points[a].push_back(d.points[m - 1 - b][a]);
            if (!d.weights.empty()) {
                t.weights[a].push_back(d.weights[m - 1 - b][a]);
            }
        }
    }
    return t;
}

/// One knot more in u: Boehm's rule in homogeneous coordinates (The NURBS Book, eq. 5.15).
inline SurfaceData with_knot_u(const SurfaceData& d, double u) {
    SurfaceData out = d;
    const auto p = static_cast<std::size_t>(d.degree_u);
    std::size_t k = p;
    while (k + p + 2 < d.knots_u.size() && d.knots_u[k + 1] <= u) {
        ++k;
    }
    out.knots_u.insert(out.knots_u.begin() + static_cast<long>(k) + 1, u);
    out.points.insert(out.points.begin() + static_cast<long>(k), d.points[k]);
    if (out.weights.empty()) {
        out.weights.assign(d.points.size(), std::vector<double>(d.points[0].size(), 1.0));
    }
    const auto old = out.weights;
    out.weights.insert(out.weights.begin() + static_cast<long>(k), old[k]);
    for (std::size_t i = k - p + 1; i <= k; ++i) {
        const double a = i >= d.points.size() || d.knots_u[i + p] == d.knots_u[i]
                           ? 0.0
                           : (u - d.knots_u[i]) / (d.knots_u[i + p] - d.knots_u[i]);
        for (std::size_t j = 0; j < d.points[0].size(); ++j) {
            const double w = i < d.points.size() ? a * old[i][j] : 0.0;
            const double v = (1.0 - a) * old[i - 1][j];
            const engine::Vec3 here = i < d.points.size() ? d.points[i][j] : engine::Vec3{};
            out.weights[i][j] = w + v;
            out.points[i][j] = (1.0 / (w + v)) * (w * here + v * d.points[i - 1][j]);
        }
    }
    return out;
}

/// With u as often among its knots as its degree: cut in two without being taken apart.
inline SurfaceData creased_u(SurfaceData d, double u) {
    while (std::count(d.knots_u.begin(), d.knots_u.end(), u) < d.degree_u) {
        d = with_knot_u(d, u);
    }
    return d;
}

/// The two sides of an inner u.
inline std::pair<SurfaceData, SurfaceData> cut_u(const SurfaceData& whole, double u) {
    const SurfaceData d = creased_u(whole, u);
    const auto first = static_cast<std::size_t>(std::find(d.knots_u.begin(), d.knots_u.end(), u) -
                                                d.knots_u.begin());
    const auto row = static_cast<long>(first) - 1;  // the control points on the cut
    const auto p = static_cast<long>(d.degree_u);
    SurfaceData a = d;
    SurfaceData b = d;
    a.knots_u.assign(d.knots_u.begin(), d.knots_u.begin() + static_cast<long>(first) + p);
    a.knots_u.push_back(u);
    b.knots_u.assign(1, u);
    b.knots_u.insert(b.knots_u.end(), d.knots_u.begin() + static_cast<long>(first),
                     d.knots_u.end());
    a.points.assign(d.points.begin(), d.points.begin() + row + 1);
    b.points.assign(d.points.begin() + row, d.points.end());
    if (!d.weights.empty()) {
        a.weights.assign(d.weights.begin(), d.weights.begin() + row + 1);
        b.weights.assign(d.weights.begin() + row, d.weights.end());
    }
    return {a, b};
}

inline SurfaceData turned_by(SurfaceData d, int quarters) {
    for (int k = 0; k < quarters % 4; ++k) {
        d = turned(d);
    }
    return d;
}

using Pieces = std::vector<std::shared_ptr<const engine::NurbsSurface>>;

/// Four surfaces from one, cut at u and at v, each turned at random.
inline std::vector<SurfaceData> quarters(const SurfaceData& d, double u, double v, Random& random) {
    std::vector<SurfaceData> four;
    const auto halves = cut_u(d, u);
    for (const SurfaceData& half : {halves.first, halves.second}) {
        const auto parts = cut_u(turned_by(half, 1), v);  // u runs as v did
        four.push_back(turned_by(parts.first, random.below(4)));
        four.push_back(turned_by(parts.second, random.below(4)));
    }
    return four;
}

inline Pieces made(const std::vector<SurfaceData>& all) {
    Pieces pieces;
    for (const SurfaceData& d : all) {
        pieces.push_back(made(d));
    }
    return pieces;
}

/// Two plane sides that meet in the y axis, each falling (fall > 0: a ridge) or rising (a valley)
/// from it by `fall` of its width.
inline std::vector<SurfaceData> roof(double half, double fall, double fall_right) {
    using engine::Vec3;
    const Vec3 front{0.0, -half, 0.0};
    const Vec3 back{0.0, half, 0.0};
    return {side(Vec3{-half, -half, -fall * half}, front, back, Vec3{-half, half, -fall * half}),
            side(front, Vec3{half, -half, -fall_right * half}, Vec3{half, half, -fall_right * half},
                 back)};
}

/// The box |x|, |y|, |z| <= half, its six sides turned at random.
inline std::vector<SurfaceData> box_sides(const engine::Vec3& half, Random& random) {
    using engine::Vec3;
    const auto at = [&](int x, int y, int z) {
        return Vec3{x * half.x, y * half.y, z * half.z};
    };
    std::vector<SurfaceData> six{side(at(-1, -1, 1), at(1, -1, 1), at(1, 1, 1), at(-1, 1, 1)),
                                 side(at(-1, -1, -1), at(-1, 1, -1), at(1, 1, -1), at(1, -1, -1)),
                                 side(at(1, -1, -1), at(1, 1, -1), at(1, 1, 1), at(1, -1, 1)),
                                 side(at(-1, -1, -1), at(-1, -1, 1), at(-1, 1, 1), at(-1, 1, -1)),
                                 side(at(-1, 1, -1), at(-1, 1, 1), at(1, 1, 1), at(1, 1, -1)),
                                 side(at(-1, -1, -1), at(1, -1, -1), at(1, -1, 1), at(-1, -1, 1))};
    for (SurfaceData& d : six) {
        d = turned_by(d, random.below(4));
    }
    return six;
}

}  // namespace palpate::tests
