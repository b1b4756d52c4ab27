#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "engine/geometry/outline.hpp"

namespace palpate::engine {

/// Where a point of the outline is: on a segment at u, or on the joint between two segments.
/// A joint at a convex or concave vertex owns a Voronoi region of its own.
struct Place {
    bool on_joint = false;
    std::size_t index = 0;  ///< of the segment or of the joint
    double parameter =
        0.0;  ///< u in [0, 1] on a segment; fan angle phi in [0, turn] on a joint, rad
};

struct ClosestPoint {
    Place place{};
    Vec2 point{};
    double distance = 0.0;  ///< |h - point|, m
    bool inside = false;  ///< h lies strictly inside the object (never for a point on the outline)
};

/// The closest point of one span to any point, with a proof instead of a search by samples.
///
/// The foot points of h are the roots of f(u) = (C - h) . C' W^3 with C = P / W, a polynomial of
/// degree 3p - 1. Its Bernstein coefficients are linear in h and prepared here once:
/// f_k = a_k - h . b_k. Descartes' rule on these coefficients (variation diminishing) tells in which
/// intervals there is no root, exactly one, or a need to split. Nothing is missed between samples.
class SpanFeet {
public:
    explicit SpanFeet(const RationalBezier<2>& curve);

    struct Foot {
        double u = 0.0;
        Vec2 point{};
        double distance2 = 0.0;  ///< m^2
    };

    /// Global closest point of the span to h, end points included. The foot is polished by Newton's
    /// iteration until its step is below the last bit of u: distance within 4e-16 of the size.
    [[nodiscard]] Foot closest(const Vec2& h) const noexcept;

    /// Lower bound of |C(u) - h|^2 over the span: distance to the box of its control points, m^2.
    [[nodiscard]] double bound2(const Vec2& h) const noexcept;

    static constexpr std::size_t kMaxCoefficients = 3 * kMaxDegree;

private:
    using Coefficients = std::array<double, kMaxCoefficients>;

    [[nodiscard]] Foot polish(const Vec2& h, double lo, double hi) const noexcept;
    [[nodiscard]] Foot foot_at(const Vec2& h, double u) const noexcept;

    RationalBezier<2> curve_;
    Vec2 origin_{};  ///< local origin of the coefficients: the middle of the box
    Vec2 box_min_{};
    Vec2 box_max_{};
    std::size_t count_ = 0;  ///< number of coefficients, 3 p
    Coefficients constant_{};
    Coefficients linear_x_{};
    Coefficients linear_y_{};
    double scale_constant_ = 0.0;  ///< largest |a_k|, for the rounding level
    double scale_linear_ = 0.0;    ///< largest |b_k|
};

/// The closest point of a whole outline: nearest feature over all segments and joints.
class OutlineFeet {
public:
    explicit OutlineFeet(const Outline& outline);

    /// Global answer. Ties go to the lower index. Outside and inside are decided by the nearest
    /// feature: on a segment by the side of its normal; a convex vertex is seen from outside only, a
    /// concave one from inside only; beyond an open end everything is outside.
    [[nodiscard]] ClosestPoint closest(const Vec2& h) const noexcept;

private:
    [[nodiscard]] ClosestPoint at_joint(std::size_t joint,
                                        const Vec2& h,
                                        double distance) const noexcept;

    const Outline* outline_;
    std::vector<SpanFeet> feet_;
};

}  // namespace palpate::engine
