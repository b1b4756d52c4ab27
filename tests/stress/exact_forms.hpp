#pragma once

#include <boost/container/static_vector.hpp>

#include "engine/friction/god_object.hpp"
#include "engine/geometry/rational_bezier.hpp"
#include "tests/support/std.hpp"

/// Drive and load of a span in long double, by Bernstein rows made afresh for each HIP, and their
/// first root.
namespace palpate::stress {

using Real = long double;

/// Bernstein coefficients, of a degree that a span's forms may have.
using Row = boost::container::static_vector<Real, 3 * engine::kMaxDegree + 1>;

using Point = glm::vec<2, Real>;

[[nodiscard]] Real turn(const Point& a, const Point& b);
[[nodiscard]] Point unit(const Point& a);

/// Control points that repeat an end of a span.
[[nodiscard]] std::size_t repeats(const engine::RationalBezier<2>& span, bool at_end);

/// A span in one direction of travel, whoever touches it.
struct SpanRows {
    SpanRows(const engine::RationalBezier<2>& span, bool forward);

    Row px, py, w;      ///< w (C - origin), w
    Row nx, ny;         ///< w^2 C', in the direction of travel
    Row sizes;          ///< of the terms in nx and ny
    Row tx, ty;         ///< nx and ny without the repeated control points of either end
    std::size_t first;  ///< control points that repeat the start
    std::size_t last;   ///< the end
    Point origin{};
    bool forward;
};

/// Point and unit tangent at x, in the direction of travel.
[[nodiscard]] Point point_of(const SpanRows& span, Real x, Real y);
[[nodiscard]] Point tangent_of(const SpanRows& span, Real x, Real y);

/// How far the tangent at x may be turned in doubles, rad, up to 2: derivatives are differences of
/// coordinates and weights.
[[nodiscard]] Real turned_in_doubles(const SpanRows& span, Real x, Real y);

/// Ahead of a place on a span, in the direction of travel, seen from h.
struct Ahead {
    const SpanRows* span;
    Real x, y;  ///< where it begins
    Row a, b;   ///< outside of the cone: both > 0
    Row noise;

    /// Of the whole way, for a share of what is ahead.
    [[nodiscard]] Real at(Real share) const { return x + share * y; }
};

/// @param x, y  of the way along the span in the direction of travel, x + y = 1
[[nodiscard]] Ahead ahead_of(const SpanRows& span, const engine::Vec2& h, Real mu, Real x, Real y);

/// The first root of min(a, b) on [0, 1]: between lo and hi. Where rounding decides, all that it
/// may be.
struct Root {
    Real lo;
    Real hi;
};
struct Roots {
    std::vector<Root> at;
    bool blank = false;  ///< over a stretch no digit is left
};

/// Adds what may be the first root. @return whether there is one for certain
bool first_root_of(const Ahead& ahead, Roots& roots);

/// A place where a walk may end.
struct ExactStop {
    engine::Vec2 point{};
    double nu = 0.0;      ///< load there, m
    double blur = 0.0;    ///< m, what is not known of the point: beside a centre of curvature
    double doubt = 0.0;   ///< m, what rounding in doubles makes of the tangent there, of nu
    bool corner = false;  ///< a concave vertex: two normals carry
};

/// What the law allows. More than one stop where rounding decides.
struct ExactAnswer {
    std::vector<ExactStop> stops;
    bool open = false;  ///< HIP is on the outline but for rounding: nothing is asked
    double band = 0.0;  ///< m: stretches nearer to the edge of the cone than this are on it
};

/// Whoever walks on it.
struct ExactOutline {
    explicit ExactOutline(const engine::Outline& outline);

    const engine::Outline* outline;  ///< must live as long
    std::vector<SpanRows> on;        ///< of each span, in the direction of the outline
    std::vector<SpanRows> back;
    double extent = 0.0;  ///< largest coordinate, m
};

/// From `from` in the direction of the drive to the first place where |tau| <= mu max(nu, 0), over
/// vertices by their rules. @param outline with every coordinate below 1e9 m, and so is h
[[nodiscard]] ExactAnswer exact_walk(const ExactOutline& outline,
                                     const engine::GodObject& from,
                                     const engine::Vec2& h,
                                     double mu);

/// Some curve has a foot of h, no farther than `within` and not at an end, whose normal says that h
/// is outside: so it is where two curves lie upon each other back to back. By sampling and thirds.
[[nodiscard]] bool outside_of_some(const ExactOutline& outline,
                                   const engine::Vec2& h,
                                   double within);

}  // namespace palpate::stress
