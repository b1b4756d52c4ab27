#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>

#include "engine/geometry/vec.hpp"

namespace palpate::engine {

/// Highest degree of a curve span.
inline constexpr int kMaxDegree = 9;

/// Point and derivatives of a curve at one parameter: m, m, m per unit of u.
template <int D>
struct Jet {
    Vec<D> point{};
    Vec<D> first{};
    Vec<D> second{};
};

/// One rational Bezier span in D dimensions, u in [0, 1].
///
///     C(u) = sum w_i B_i(u) P_i / sum w_i B_i(u)        Piegl & Tiller, The NURBS Book, eq. 4.1
///
/// Every NURBS curve is a chain of such spans. Evaluated by de Casteljau's corner cutting in
/// homogeneous coordinates, whose error stays near 3e-16 of the size for weights of 1e-3 to 1e3.
template <int D>
class RationalBezier {
public:
    /// @param points   degree + 1 control points, m, finite
    /// @param weights  as many, each finite and > 0
    /// @throws std::invalid_argument naming what is wrong, the value and the remedy
    RationalBezier(std::span<const Vec<D>> points, std::span<const double> weights);

    [[nodiscard]] int degree() const noexcept { return degree_; }
    [[nodiscard]] Vec<D> point(std::size_t i) const noexcept { return points_[i]; }
    [[nodiscard]] double weight(std::size_t i) const noexcept { return weights_[i]; }

    /// C, C' and C'' at u; u is not clamped.
    [[nodiscard]] Jet<D> at(double u) const noexcept;

private:
    int degree_ = 1;
    std::array<Vec<D>, kMaxDegree + 1> points_{};
    std::array<Vec<D>, kMaxDegree + 1> weighted_{};  ///< w_i P_i
    std::array<double, kMaxDegree + 1> weights_{};
};

template <int D>
RationalBezier<D>::RationalBezier(std::span<const Vec<D>> points, std::span<const double> weights) {
    if (points.size() < 2 || points.size() > kMaxDegree + 1) {
        throw std::invalid_argument("a Bezier span has 2 to " + std::to_string(kMaxDegree + 1) +
                                    " control points, not " + std::to_string(points.size()));
    }
    if (weights.size() != points.size()) {
        throw std::invalid_argument(
            "a Bezier span needs one weight a control point: " + std::to_string(points.size()) +
            ", not " + std::to_string(weights.size()));
    }
    degree_ = static_cast<int>(points.size()) - 1;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!(weights[i] > 0.0) || !std::isfinite(weights[i])) {
            throw std::invalid_argument("weight " + std::to_string(i) + " is " +
                                        std::to_string(weights[i]) +
                                        ": give a finite weight above 0");
        }
        for (int k = 0; k < D; ++k) {
            if (!std::isfinite(points[i][k])) {
                throw std::invalid_argument("control point " + std::to_string(i) +
                                            " is not finite: give coordinates in m");
            }
        }
        points_[i] = points[i];
        weights_[i] = weights[i];
        weighted_[i] = weights[i] * points[i];
    }
}

template <int D>
Jet<D> RationalBezier<D>::at(double u) const noexcept {
    std::array<Vec<D>, kMaxDegree + 1> p = weighted_;
    std::array<double, kMaxDegree + 1> w = weights_;
    const double v = 1.0 - u;
    for (int level = degree_; level > 2; --level) {
        for (std::size_t i = 0; i < static_cast<std::size_t>(level); ++i) {
            p[i] = v * p[i] + u * p[i + 1];
            w[i] = v * w[i] + u * w[i + 1];
        }
    }
    const double n = degree_;
    Vec<D> a = p[0];
    Vec<D> b = p[1];
    double wa = w[0];
    double wb = w[1];
    Vec<D> curl{};
    double wcurl = 0.0;
    if (degree_ >= 2) {
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

}  // namespace palpate::engine
