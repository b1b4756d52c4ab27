#pragma once

#include <cmath>
#include <limits>
#include <optional>

#include "engine/geometry/rational_bezier.hpp"

namespace palpate::engine {

/// The straight line from `from` to `to` as a span of degree 1.
/// @throws std::invalid_argument if the ends coincide or are not finite
[[nodiscard]] RationalBezier<2> make_line(const Vec2& from, const Vec2& to);

/// The circular arc from `from` to `to`, exact: a rational quadratic with weights 1, cos(a), 1,
/// where sin(a) = curvature * chord / 2 (Piegl & Tiller, The NURBS Book, 7.3). Curvature 0 gives
/// the line.
///
/// @param curvature  1/m; > 0 bulges to the left of travel (convex: the object is on the right)
/// @throws std::invalid_argument if |curvature| * chord / 2 > kMaxArcSine (the arc would come close
///         to a half circle, where one quadratic span no longer exists), or for ends as make_line
[[nodiscard]] RationalBezier<2> make_arc(const Vec2& from, const Vec2& to, double curvature);

/// Sine of the largest half sweep of one span; 0.99 is a sweep of 164 degrees.
inline constexpr double kMaxArcSine = 0.99;

/// A span that is a circular arc or, with curvature 0, a line, in closed forms.
///
/// With the chord's middle O, its direction e and length l, n = perp(e), half the sweep a
/// (sin a = curvature l / 2), d = 2 u - 1 and
///
///   W = 1 - 2 u (1 - u) (1 - cos a)
///   C(u) = O + (l / W) (e d / 2 + n u (1 - u) sin a),   t(u) = (e (1 + cos a - W) - n d sin a) / W
///
/// is the rational quadratic of make_arc(), and its unit tangent. Neither centre nor radius is
/// read, so that nothing is lost where an arc is nearly straight. Error below 1e-15 of the size.
class Arc {
public:
    /// A point of the arc and the unit tangent there.
    struct Point {
        Vec2 point;
        Vec2 tangent;
    };

    /// The arc that a span is, to rounding: of degree 1, or 2 with equal end weights and legs and
    /// the weight between that a circle has. Others: nothing.
    [[nodiscard]] static std::optional<Arc> of(const RationalBezier<2>& span);

    [[nodiscard]] double curvature() const noexcept { return sin_ / half_; }  ///< 1/m
    [[nodiscard]] double chord() const noexcept { return 2.0 * half_; }       ///< its length, m

    /// At u in [0, 1], given by u + v = 1.
    [[nodiscard]] Point at(double u, double v) const noexcept {
        const double uv = u * v;
        const double bulge = 4.0 * sin2_ * uv;
        const double inverse = 1.0 / (1.0 - bulge);
        const double d = (u - v) * inverse;
        const double along = half_ * d;
        const double out = 4.0 * quarter_ * uv * inverse;
        const double turn = sin_ * d;
        const double straight = (cos_ + bulge) * inverse;
        return {.point = middle_ + along * e_ + out * perp(e_),
                .tangent = straight * e_ - turn * perp(e_)};
    }

    /// u of the foot of h, the nearer one on the whole circle or line, also outside of [0, 1]. NaN
    /// where h lies on the chord's parallel through the centre, or beyond.
    [[nodiscard]] double foot(const Vec2& h) const noexcept {
        const Vec2 r = local(h);
        const double p = pull_ + sin_ * r.y;
        const double side = sin_ * r.x;
        const double d = 2.0 * cos2_ * r.x / (p + std::sqrt(p * p + side * side));
        return p > 0.0 ? 0.5 + 0.5 * d : std::numeric_limits<double>::quiet_NaN();
    }

    /// A polynomial in d = 2 u - 1, m.
    struct Form {
        double c0 = 0.0;
        double c1 = 0.0;
        double c2 = 0.0;

        [[nodiscard]] double value(double d) const noexcept { return c0 + d * (c1 + d * c2); }
    };

    /// W (dir r . t - mu nu) of r = h - C(u) with the load nu = -r . perp(t): how far outside of
    /// its cone a god-object is that is driven in direction dir, +1 or -1.
    [[nodiscard]] Form excess(const Vec2& h, double mu, double dir) const noexcept {
        const Vec2 r = local(h);
        const double along = dir * r.x + mu * r.y;
        const double out = dir * r.y - mu * r.x;
        return {.c0 = cos2_ * along - mu * quarter_,
                .c1 = -(sin_ * out + dir * pull_),
                .c2 = -sin2_ * along - mu * quarter_};
    }

    /// No way along an arc is longer than this times the straight one: asin(x) / x up to
    /// kMaxArcSine is 1.45.
    static constexpr double kMaxWay = 1.5;
    /// Way along the arc between two of its points, m.
    [[nodiscard]] double way(const Vec2& from, const Vec2& to) const noexcept;

private:
    Arc(const RationalBezier<2>& span, double sine, double cosine);

    /// h from the middle of the chord: along it, and to its left.
    [[nodiscard]] Vec2 local(const Vec2& h) const noexcept {
        const Vec2 r = h - middle_;
        return {glm::dot(r, e_), cross(e_, r)};
    }

    Vec2 middle_{};
    Vec2 e_{1.0, 0.0};
    double half_ = 0.0;  ///< of the chord, m
    double sin_ = 0.0;   ///< of half the sweep a, > 0 where the arc bulges to the left of travel
    double cos_ = 1.0;
    double cos2_ = 1.0;     ///< (1 + cos a) / 2
    double sin2_ = 0.0;     ///< (1 - cos a) / 2
    double quarter_ = 0.0;  ///< of l sin a, m
    double pull_ = 0.0;     ///< l cos a / 2, m
};

}  // namespace palpate::engine
