#include "engine/geometry/nurbs_curve.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/base/refuse.hpp"

namespace palpate::engine {
namespace {

void check_degree(int degree, std::size_t points) {
    refuse_if(degree < 1 || degree > kMaxDegree, "degree is {}: give 1 to {}", degree, kMaxDegree);
    const auto p = static_cast<std::size_t>(degree);
    refuse_if(points < p + 1,
              "degree {} needs at least {} control points, not {}: add points or lower the degree",
              degree, p + 1, points);
}

void check_values(const std::vector<double>& values, const std::string& name) {
    for (std::size_t i = 0; i < values.size(); ++i) {
        refuse_if(!std::isfinite(values[i]), "{}[{}] is {:.9g}: give a finite number", name, i,
                  values[i]);
        const double before = values[i > 0 ? i - 1 : 0];
        refuse_if(values[i] < before,
                  "{}[{}] = {:.9g} is below the knot before it, {:.9g}: knots never fall", name, i,
                  values[i], before);
    }
}

void check_clamped(const std::vector<double>& values, std::size_t p, const std::string& name) {
    const std::size_t last = values.size() - 1;
    for (std::size_t i = 1; i <= p; ++i) {
        refuse_if(values[i] != values[0] || values[last - i] != values[last],
                  "{} must repeat its first and its last value {} times (degree + 1), so that the "
                  "curve reaches its end points",
                  name, p + 1);
    }
    refuse_if(!(values[0] < values[last]),
              "{} holds only the value {:.9g}: the last knot must be larger than the first", name,
              values[0]);
    refuse_if(!std::isfinite(values[last] - values[0]),
              "{} go from {:.9g} to {:.9g}, farther apart than any number: give knots that are "
              "nearer to each other",
              name, values[0], values[last]);
}

void check_repeats(const std::vector<double>& values, std::size_t p, const std::string& name) {
    for (std::size_t i = 1; i + p < values.size() - 1; ++i) {
        refuse_if(values[i] > values[0] && values[i] < values.back() && values[i] == values[i + p],
                  "{} repeats the inner knot {:.9g} more than {} times (the degree): the curve "
                  "would fall apart",
                  name, values[i], p);
    }
}

/// The last of rising pieces that begins at or before u; the first where none does.
template <class Piece>
std::size_t piece_with(const std::vector<Piece>& pieces, double u) noexcept {
    const auto after = std::ranges::upper_bound(pieces, u, {}, &Piece::lo);
    return after == pieces.begin() ? 0 : static_cast<std::size_t>(after - pieces.begin()) - 1;
}

/// r of balanced() as a power of two.
template <int D>
int balance_step(const RationalBezier<D>& curve) {
    const int n = curve.degree();
    const int apart =
        std::ilogb(curve.weight(static_cast<std::size_t>(n))) - std::ilogb(curve.weight(0));
    return (apart >= 0 ? apart + n / 2 : apart - n / 2) / n;  // rounded
}

/// Weight i times r^(n-i), shifted so that those at the ends stay in their range.
template <int D>
std::vector<double> balanced_weights(const RationalBezier<D>& curve, int step) {
    const int n = curve.degree();
    std::vector<double> weights;
    for (int i = 0; i <= n; ++i) {
        weights.push_back(
            std::ldexp(curve.weight(static_cast<std::size_t>(i)), step * (n - i) - step * n / 2));
    }
    return weights;
}

bool in_range(const std::vector<double>& weights) {
    return std::ranges::all_of(weights,
                               [](double w) { return w >= kMinWeight && w <= kMaxWeight; });
}

/// Weights that balanced() would drive out of their range.
/// @param named  those that the sentence names
void refuse_unless(bool fits, const std::vector<double>& named) {
    const auto [least, greatest] = std::ranges::minmax(named);
    refuse_if(
        !fits,
        "weights go from {:.9g} to {:.9g}, too far apart for one curve: give a largest weight "
        "that is nearer to the smallest",
        least, greatest);
}

/// All weights 1 when none are given.
std::vector<double> all_weights(std::span<const double> weights, std::size_t points) {
    if (weights.empty()) {
        return std::vector<double>(points, 1.0);
    }
    refuse_if(weights.size() != points,
              "{} weights for {} control points: give one a control point, or none", weights.size(),
              points);
    return {weights.begin(), weights.end()};
}

}  // namespace

KnotVector::KnotVector(std::vector<double> values,
                       int degree,
                       std::size_t points,
                       std::string_view name)
    : values_(std::move(values)), degree_(degree) {
    const std::string label(name);
    check_degree(degree, points);
    const auto p = static_cast<std::size_t>(degree);
    refuse_if(values_.size() != points + p + 1,
              "{} has {} values: {} control points of degree {} need {}", label, values_.size(),
              points, degree, points + p + 1);
    check_values(values_, label);
    check_clamped(values_, p, label);
    check_repeats(values_, p, label);
    for (std::size_t i = p; i < points; ++i) {
        if (values_[i] < values_[i + 1]) {
            intervals_.push_back({values_[i], values_[i + 1], i});
        }
    }
}

std::size_t KnotVector::interval_of(double u) const noexcept {
    return piece_with(intervals_, u);
}

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
        const int step = balance_step<D>(spans_.back().curve);
        refuse_unless(step == 0 || in_range(balanced_weights<D>(spans_.back().curve, step)), w);
    }
}

template <int D>
std::size_t NurbsCurve<D>::span_of(double u) const noexcept {
    return piece_with(spans_, u);
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
    const int step = balance_step<D>(curve);
    if (step == 0) {
        return {.curve = curve};
    }
    const std::vector<double> weights = balanced_weights<D>(curve, step);
    refuse_unless(in_range(weights), weights);
    std::vector<Vec<D>> points;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        points.push_back(curve.local_point(i));
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
