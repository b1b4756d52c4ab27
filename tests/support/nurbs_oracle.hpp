#pragma once

#include "tests/support/random.hpp"

namespace palpate::tests {

/// A NURBS curve as its definition reads: what a scene file holds.
template <int D>
struct NurbsData {
    int degree = 1;
    std::vector<double> knots;
    std::vector<engine::Vec<D>> points;
    std::vector<double> weights;
};

/// A Bezier curve, without weights of its own a polynomial.
inline NurbsData<2> bezier_data(std::vector<engine::Vec2> points,
                                std::vector<double> weights = {}) {
    NurbsData<2> curve;
    curve.degree = static_cast<int>(points.size()) - 1;
    curve.knots.assign(points.size(), 0.0);
    curve.knots.insert(curve.knots.end(), points.size(), 1.0);
    if (weights.empty()) {
        weights.assign(points.size(), 1.0);
    }
    curve.points = std::move(points);
    curve.weights = std::move(weights);
    return curve;
}

/// The k of the last piece [t_k, t_k+1] that is not empty and begins at or below u; of the first
/// where none does.
inline std::size_t knot_piece(const std::vector<double>& t, long double u) {
    std::size_t found = t.size();
    for (std::size_t k = 0; k + 1 < t.size(); ++k) {
        if (t[k] < t[k + 1] && (found == t.size() || t[k] <= u)) {
            found = k;
        }
    }
    return found;
}

/// All N_i,p(u) of one degree on the piece [t_k, t_k+1] by Cox and de Boor (The NURBS Book, eq.
/// 2.5), as polynomials of that piece: u may be its closed end. Written from the definition, not
/// from the code under test.
inline std::vector<long double> basis_row(
    const std::vector<double>& t, std::size_t piece, int p, std::size_t count, long double u) {
    std::vector<long double> n(t.size() - 1, 0.0L);
    n[piece] = 1.0L;
    for (int d = 1; d <= p; ++d) {
        const auto q = static_cast<std::size_t>(d);
        for (std::size_t i = 0; i + q + 1 < t.size(); ++i) {
            const long double left = static_cast<long double>(t[i + q]) - t[i];
            const long double right = static_cast<long double>(t[i + q + 1]) - t[i + 1];
            const long double a = left > 0.0L ? (u - t[i]) / left * n[i] : 0.0L;
            const long double b = right > 0.0L ? (t[i + q + 1] - u) / right * n[i + 1] : 0.0L;
            n[i] = a + b;
        }
    }
    n.resize(count);
    return n;
}

/// C(u) in long double, straight from the definition.
template <int D>
std::array<long double, static_cast<std::size_t>(D)> nurbs_point(const NurbsData<D>& curve,
                                                                 long double u) {
    const auto row =
        basis_row(curve.knots, knot_piece(curve.knots, u), curve.degree, curve.points.size(), u);
    std::array<long double, static_cast<std::size_t>(D)> sum{};
    long double weight = 0.0L;
    for (std::size_t i = 0; i < curve.points.size(); ++i) {
        const long double n = row[i] * curve.weights[i];
        weight += n;
        for (int k = 0; k < D; ++k) {
            sum[static_cast<std::size_t>(k)] += n * curve.points[i][k];
        }
    }
    for (long double& x : sum) {
        x /= weight;
    }
    return sum;
}

/// A clamped curve of random degree, spacing, repeated knots and weights in 10^[-decades, decades].
template <int D>
NurbsData<D> random_nurbs(Random& random, double size, double decades) {
    NurbsData<D> curve;
    curve.degree = 1 + random.below(9);
    const int inner = random.below(5);
    const auto p = static_cast<std::size_t>(curve.degree);
    curve.knots.assign(p + 1, 0.0);
    double at = 0.0;
    for (int i = 0; i < inner; ++i) {
        at += random.decade(-3.0, 1.0);
        const int repeats = random.coin() ? 1 : 1 + random.below(curve.degree);
        curve.knots.insert(curve.knots.end(), static_cast<std::size_t>(repeats), at);
    }
    at += random.decade(-3.0, 1.0);
    curve.knots.insert(curve.knots.end(), p + 1, at);
    const std::size_t count = curve.knots.size() - p - 1;
    for (std::size_t i = 0; i < count; ++i) {
        engine::Vec<D> point{};
        for (int k = 0; k < D; ++k) {
            point[k] = size * random.in(-0.5, 0.5);
        }
        const bool repeated = i > 0 && random.below(8) == 0;
        curve.points.push_back(repeated ? curve.points.back() : point);
        curve.weights.push_back(decades > 0.0 ? random.decade(-decades, decades) : 1.0);
    }
    return curve;
}

}  // namespace palpate::tests
