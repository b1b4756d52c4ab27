#include "engine/geometry/rational_bezier.hpp"

#include <cmath>
#include <utility>

#include "engine/base/refuse.hpp"
#include "engine/math/bernstein.hpp"

namespace palpate::engine {
template <int D>
void check_control_point(const Vec<D>& point, double weight, std::size_t index) {
    refuse_if(!(weight >= kMinWeight) || !(weight <= kMaxWeight),
              "weights[{}] is {:.9g}: give a finite weight above 0, from 1e-12 to 1e12", index,
              weight);
    for (int k = 0; k < D; ++k) {
        refuse_if(
            !(std::fabs(point[k]) <= kMaxCoordinate),
            "control point {} has the coordinate {:.9g}: give finite coordinates in m, up to 1e9",
            index, point[k]);
    }
}

template <int D>
RationalBezier<D>::RationalBezier(std::span<const Vec<D>> points,
                                  std::span<const double> weights,
                                  const Vec<D>& about) {
    refuse_if(points.size() < 2 || points.size() > kMaxDegree + 1,
              "a Bezier span has 2 to {} control points, not {}", kMaxDegree + 1, points.size());
    refuse_if(weights.size() != points.size(),
              "a Bezier span needs one weight a control point: {}, not {}", points.size(),
              weights.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        local_[i] = about + points[i];
        check_control_point<D>(local_[i], weights[i], i);
    }
    degree_ = static_cast<int>(points.size()) - 1;
    box_ = box_of<D>(std::span(local_.data(), points.size()));
    origin_ = box_.middle();
    polynomial_ = std::all_of(weights.begin(), weights.end(),
                              [&weights](double w) { return w == weights[0]; });
    for (std::size_t i = 0; i < points.size(); ++i) {
        local_[i] = points[i] - (origin_ - about);
        weights_[i] = polynomial_ ? 1.0 : weights[i];
        weighted_[i] = weights_[i] * local_[i];
    }
    horner_ = polynomial_ && degree_ <= 3;
    if (horner_) {
        power_ = powers(std::span<const Vec<D>>(local_), degree_);
    }
}

template <int D>
template <int N>
Jet<D> RationalBezier<D>::cut(double u, double v) const noexcept {
    constexpr auto kCount = static_cast<std::size_t>(N) + 1;
    std::array<Vec<D>, kCount> p;
    std::array<double, kCount> w;
    for (std::size_t i = 0; i < kCount; ++i) {
        p[i] = weighted_[i];
        w[i] = weights_[i];
    }
    for (std::size_t level = N; level > 2; --level) {
        for (std::size_t i = 0; i < level; ++i) {
            p[i] = v * p[i] + u * p[i + 1];
            w[i] = v * w[i] + u * w[i + 1];
        }
    }
    constexpr double n = N;
    Vec<D> a = p[0];
    Vec<D> b = p[1];
    double wa = w[0];
    double wb = w[1];
    Vec<D> curl{};
    double wcurl = 0.0;
    if constexpr (N >= 2) {
        curl = n * (n - 1.0) * ((p[2] - p[1]) - (p[1] - p[0]));
        wcurl = n * (n - 1.0) * ((w[2] - w[1]) - (w[1] - w[0]));
        a = v * p[0] + u * p[1];
        b = v * p[1] + u * p[2];
        wa = v * w[0] + u * w[1];
        wb = v * w[1] + u * w[2];
    }
    const double inverse = 1.0 / (v * wa + u * wb);
    const double slope = n * (wb - wa);
    Jet<D> jet;
    jet.point = (v * a + u * b) * inverse;
    jet.first = (n * (b - a) - slope * jet.point) * inverse;
    jet.second = (curl - (2.0 * slope) * jet.first - wcurl * jet.point) * inverse;
    return jet;
}

template <int D>
Jet<D> RationalBezier<D>::by_corner_cutting(double u, double v) const noexcept {
    constexpr auto kCuts = []<int... N>(std::integer_sequence<int, N...>) {
        return std::array{&RationalBezier::template cut<N + 1>...};
    }
    (std::make_integer_sequence<int, kMaxDegree>{});
    return (this->*kCuts[static_cast<std::size_t>(degree_ - 1)])(u, v);
}

template class RationalBezier<2>;
template class RationalBezier<3>;
template void check_control_point<2>(const Vec<2>&, double, std::size_t);
template void check_control_point<3>(const Vec<3>&, double, std::size_t);

}  // namespace palpate::engine
