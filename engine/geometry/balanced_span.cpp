#include "engine/geometry/balanced_span.hpp"

#include <cmath>

namespace palpate::engine {

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
        points.push_back(curve.point(i));
        weights.push_back(std::ldexp(curve.weight(i), shift));
    }
    return {.curve = RationalBezier<D>(points, weights), .name = {.ratio = std::ldexp(1.0, step)}};
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
