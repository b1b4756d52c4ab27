#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "engine/geometry/rational_bezier.hpp"

namespace palpate::engine {

/// A clamped knot vector: where the polynomial pieces of a B-spline of one degree begin and end.
///
/// Knots may have any spacing. Inner knots may repeat up to `degree` times: degree times is a kink
/// (C0), more would tear the curve apart.
class KnotVector {
public:
    /// One piece [lo, hi], lo < hi.
    struct Interval {
        double lo = 0.0;
        double hi = 0.0;
        std::size_t knot = 0;  ///< index of the last knot <= lo
    };

    /// @param values  points + degree + 1 finite numbers that never fall; the first and the last
    ///                degree + 1 are equal
    /// @param points  number of control points, > degree
    /// @param name    what a message calls the vector: "knots", "knots_u"
    /// @throws std::invalid_argument with the place, the value and the remedy
    KnotVector(std::vector<double> values,
               int degree,
               std::size_t points,
               std::string_view name = "knots");

    /// Degree of the pieces.
    [[nodiscard]] int degree() const noexcept { return degree_; }
    /// The knots as they were given.
    [[nodiscard]] const std::vector<double>& values() const noexcept { return values_; }
    /// The pieces, in the order of u; none is empty.
    [[nodiscard]] const std::vector<Interval>& intervals() const noexcept { return intervals_; }
    /// The first and the last u of the domain.
    [[nodiscard]] double front() const noexcept { return values_.front(); }
    [[nodiscard]] double back() const noexcept { return values_.back(); }

    /// Index of the piece that holds u: [lo, hi), the last one closed. Outside: the nearest piece.
    [[nodiscard]] std::size_t interval_of(double u) const noexcept;

    /// Bezier control points of piece `i` of the spline with control values `control` (one a
    /// control point, `stride` apart): the blossom at lo (degree - j times) and hi (j times), j = 0
    /// .. degree (Ramshaw 1989; Piegl & Tiller, The NURBS Book, 5.3). Convex combinations only.
    template <class Value>
    [[nodiscard]] std::vector<Value> bezier_points(std::size_t i,
                                                   std::span<const Value> control,
                                                   std::size_t stride = 1) const;

private:
    std::vector<double> values_;
    int degree_ = 1;
    std::vector<Interval> intervals_;
};

template <class Value>
std::vector<Value> KnotVector::bezier_points(std::size_t i,
                                             std::span<const Value> control,
                                             std::size_t stride) const {
    const auto p = static_cast<std::size_t>(degree_);
    const Interval& piece = intervals_[i];
    const std::size_t first = piece.knot - p;
    std::vector<Value> points;
    points.reserve(p + 1);
    for (std::size_t j = 0; j <= p; ++j) {
        std::vector<Value> d(p + 1);
        for (std::size_t k = 0; k <= p; ++k) {
            d[k] = control[(first + k) * stride];
        }
        for (std::size_t level = 1; level <= p; ++level) {
            const double u = level <= j ? piece.hi : piece.lo;
            for (std::size_t k = p; k >= level; --k) {
                const double lo = values_[first + k];
                const double hi = values_[first + k + p - level + 1];
                // Both shares by themselves: 1 - share would lose digits that weights of 1e3 bring
                // back.
                d[k] = ((hi - u) / (hi - lo)) * d[k - 1] + ((u - lo) / (hi - lo)) * d[k];
            }
        }
        points.push_back(d[p]);
    }
    return points;
}

}  // namespace palpate::engine
