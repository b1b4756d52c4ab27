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

/// A NURBS curve in D = 2 or 3 dimensions, split once into its rational Bezier spans.
///
///     C(u) = sum N_i,p(u) w_i P_i / sum N_i,p(u) w_i        Piegl & Tiller, The NURBS Book, eq.
///     4.1
///                                                            (thesis eq. 2.1 to 2.5)
/// u runs over [front, back] of the knot vector; the last span is closed, so that C(back) is the
/// last control point (the thesis' half-open eq. 2.3 leaves it undefined).
template <int D>
class NurbsCurve {
public:
    struct Span {
        RationalBezier<D> curve;  ///< parameter 0 .. 1
        double lo = 0.0;          ///< u at its start
        double hi = 1.0;          ///< u at its end
    };

    /// @param degree   1 to 9
    /// @param knots    as KnotVector asks
    /// @param points   control points, m, finite; they may repeat
    /// @param weights  as many, finite and > 0; empty: all 1; so near to each other that every span
    /// can be balanced()
    /// @throws std::invalid_argument with what, the value and the remedy
    NurbsCurve(int degree,
               std::vector<double> knots,
               std::span<const Vec<D>> points,
               std::span<const double> weights = {});

    /// One Bezier span as a curve with u in [0, 1].
    explicit NurbsCurve(const RationalBezier<D>& span) : degree_(span.degree()) {
        spans_.push_back({span, 0.0, 1.0});
    }

    /// Degree of all spans.
    [[nodiscard]] int degree() const noexcept { return degree_; }
    /// The first and the last u of the domain.
    [[nodiscard]] double front() const noexcept { return spans_.front().lo; }
    [[nodiscard]] double back() const noexcept { return spans_.back().hi; }
    /// The spans in the order of u; at least one.
    [[nodiscard]] const std::vector<Span>& spans() const noexcept { return spans_; }

    /// C, C' and C'' at u, per unit of u. Outside of the domain the end span goes on as a
    /// polynomial.
    [[nodiscard]] Jet<D> at(double u) const noexcept;
    /// Index of the span that holds u.
    [[nodiscard]] std::size_t span_of(double u) const noexcept;

private:
    int degree_ = 1;
    std::vector<Span> spans_;
};

extern template class NurbsCurve<2>;
extern template class NurbsCurve<3>;

/// Where a span comes from: parameters [lo, hi] of the experimenter's segment.
struct SpanName {
    std::size_t segment = 0;
    double lo = 0.0;
    double hi = 1.0;
    double ratio = 1.0;  ///< r of balanced(); 1 for nearly all curves

    /// The segment's own parameter at t in [0, 1] of the span: t / (t + r (1 - t)) of the way.
    [[nodiscard]] double parameter(double t) const noexcept {
        const double share = ratio == 1.0 ? t : t / (t + ratio * (1.0 - t));
        return t == 1.0 ? hi : lo + share * (hi - lo);
    }
};

/// A span whose parameter was changed by ratio, so that its end weights are equal, and its name.
template <int D>
struct BalancedSpan {
    RationalBezier<D> curve;
    SpanName name{};
};

/// The same curve with end weights as equal as a power of two makes them: w_i r^(n-i), r near
/// (w_n / w_0)^(1/n), which the parameter t / (t + r (1 - t)) undoes (Patterson 1985: a Moebius
/// transformation of u leaves the curve). Weights from 1e3 to 1e-3 in steps become all alike, and
/// the parameter resolves both ends. Exact but for one rounding a control point; r = 1 leaves all
/// bits.
/// @throws std::invalid_argument if a weight leaves [kMinWeight, kMaxWeight]
template <int D>
[[nodiscard]] BalancedSpan<D> balanced(const RationalBezier<D>& curve);

/// All spans of a curve, balanced and named as segment `index`.
template <int D>
[[nodiscard]] std::vector<BalancedSpan<D>> balanced_spans(const NurbsCurve<D>& curve,
                                                          std::size_t index);

}  // namespace palpate::engine
