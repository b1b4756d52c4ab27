#include "engine/geometry/nurbs_curve.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "engine/geometry/knots.hpp"

namespace palpate::engine {
namespace {

/// All weights 1 when none are given.
std::vector<double> all_weights(std::span<const double> weights, std::size_t points) {
    if (weights.empty()) {
        return std::vector<double>(points, 1.0);
    }
    if (weights.size() != points) {
        throw std::invalid_argument(std::to_string(weights.size()) + " weights for " +
                                    std::to_string(points) +
                                    " control points: give one a control point, or none");
    }
    return {weights.begin(), weights.end()};
}

}  // namespace

template <int D>
NurbsCurve<D>::NurbsCurve(int degree,
                          std::vector<double> knots,
                          std::span<const Vec<D>> points,
                          std::span<const double> weights)
    : degree_(degree) {
    const KnotVector vector(std::move(knots), degree, points.size());
    const std::vector<double> w = all_weights(weights, points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        check_control_point<D>(points[i], w[i], i);
    }
    const Vec<D> origin =
        box_of<D>(points).middle();  // far from the world's origin digits are kept
    std::vector<Vec<D>> weighted(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        weighted[i] = w[i] * (points[i] - origin);
    }
    for (std::size_t i = 0; i < vector.intervals().size(); ++i) {
        std::vector<Vec<D>> p = vector.bezier_points(i, std::span<const Vec<D>>(weighted));
        const std::vector<double> v = vector.bezier_points(i, std::span<const double>(w));
        const std::size_t first = vector.intervals()[i].knot - static_cast<std::size_t>(degree);
        for (std::size_t k = 0; k < p.size(); ++k) {
            const std::size_t own = first + k;  // one of the curve's own keeps its last bit
            p[k] = p[k] == weighted[own] && v[k] == w[own] ? points[own] - origin : p[k] / v[k];
        }
        spans_.push_back(
            {RationalBezier<D>(p, v, origin), vector.intervals()[i].lo, vector.intervals()[i].hi});
    }
}

template <int D>
std::size_t NurbsCurve<D>::span_of(double u) const noexcept {
    const auto after = std::upper_bound(spans_.begin(), spans_.end(), u,
                                        [](double value, const Span& s) { return value < s.lo; });
    return after == spans_.begin() ? 0 : static_cast<std::size_t>(after - spans_.begin()) - 1;
}

template <int D>
Jet<D> NurbsCurve<D>::at(double u) const noexcept {
    const Span& span = spans_[span_of(u)];
    const double width = span.hi - span.lo;
    const double rate = 1.0 / width;
    Jet<D> jet = span.curve.at((u - span.lo) / width);  // exactly 1 at the end
    jet.first *= rate;
    jet.second *= rate * rate;
    return jet;
}

template class NurbsCurve<2>;
template class NurbsCurve<3>;

template <int D>
BalancedSpan<D> balanced(const RationalBezier<D>& curve) {
    const int n = curve.degree();
    const auto last = static_cast<std::size_t>(n);
    const int apart = std::ilogb(curve.weight(last)) - std::ilogb(curve.weight(0));
    const int step = (apart >= 0 ? apart + n / 2 : apart - n / 2) / n;  // rounded
    if (step == 0) {
        return {.curve = curve};
    }
    std::vector<Vec<D>> points;
    std::vector<double> weights;
    for (std::size_t i = 0; i <= last; ++i) {
        // r^(n-i), shifted so that no weight leaves its range
        const int shift = step * (n - static_cast<int>(i)) - step * n / 2;
        points.push_back(curve.local_point(i));
        weights.push_back(std::ldexp(curve.weight(i), shift));
    }
    return {.curve = RationalBezier<D>(points, weights, curve.origin()),
            .name = {.ratio = std::ldexp(1.0, step)}};
}

template <int D>
std::vector<BalancedSpan<D>> balanced_spans(const NurbsCurve<D>& curve, std::size_t index) {
    std::vector<BalancedSpan<D>> spans;
    for (const auto& [span, lo, hi] : curve.spans()) {
        BalancedSpan<D> one = balanced<D>(span);
        one.name.segment = index;
        one.name.lo = lo;
        one.name.hi = hi;
        spans.push_back(std::move(one));
    }
    return spans;
}

template BalancedSpan<2> balanced(const RationalBezier<2>&);
template BalancedSpan<3> balanced(const RationalBezier<3>&);
template std::vector<BalancedSpan<2>> balanced_spans(const NurbsCurve<2>&, std::size_t);
template std::vector<BalancedSpan<3>> balanced_spans(const NurbsCurve<3>&, std::size_t);

}  // namespace palpate::engine
