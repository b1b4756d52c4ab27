#include "engine/geometry/nurbs_curve.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

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
        for (std::size_t k = 0; k < p.size(); ++k) {
            p[k] = origin + p[k] / v[k];
        }
        spans_.push_back(
            {RationalBezier<D>(p, v), vector.intervals()[i].lo, vector.intervals()[i].hi});
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

}  // namespace palpate::engine
