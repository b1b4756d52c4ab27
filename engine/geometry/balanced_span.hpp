#pragma once

#include <cstddef>
#include <vector>

#include "engine/geometry/nurbs_curve.hpp"

namespace palpate::engine {

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

template <int D>
struct BalancedSpan {
    RationalBezier<D> curve;
    SpanName name{};
};

/// The same curve with end weights as equal as a power of two makes them: w_i r^(n-i), r near
/// (w_n / w_0)^(1/n), which the parameter t / (t + r (1 - t)) undoes (Patterson 1985: a Moebius
/// transformation of u leaves the curve). Weights from 1e3 to 1e-3 in steps become all alike, and the
/// parameter resolves both ends. Exact but for one rounding a control point; r = 1 leaves all bits.
template <int D>
[[nodiscard]] BalancedSpan<D> balanced(const RationalBezier<D>& curve);

/// All spans of a curve, balanced and named as segment `index`.
template <int D>
[[nodiscard]] std::vector<BalancedSpan<D>> balanced_spans(const NurbsCurve<D>& curve,
                                                          std::size_t index);

}  // namespace palpate::engine
