#pragma once

#include <cstddef>
#include <vector>

namespace palpate::engine {

/// Polynomials on [0, 1] by their Bernstein coefficients. For setting up only: they allocate.
/// In double, or in twice the digits.
using Bernstein = std::vector<double>;

/// n over k, exact up to 2^53.
[[nodiscard]] double binomial(std::size_t n, std::size_t k) noexcept;

/// f g: Farouki & Rajan 1988, eq. 44.
template <class Real>
[[nodiscard]] std::vector<Real> product(const std::vector<Real>& f, const std::vector<Real>& g) {
    const std::size_t m = f.size() - 1;
    const std::size_t n = g.size() - 1;
    std::vector<Real> fg(m + n + 1, Real(0.0));
    for (std::size_t i = 0; i <= m; ++i) {
        for (std::size_t j = 0; j <= n; ++j) {
            const Real share = Real(binomial(m, i) * binomial(n, j)) / binomial(m + n, i + j);
            fg[i + j] += share * f[i] * g[j];
        }
    }
    return fg;
}

/// f'.
template <class Real>
[[nodiscard]] std::vector<Real> derivative(const std::vector<Real>& f) {
    std::vector<Real> slope(f.size() - 1);
    for (std::size_t i = 0; i < slope.size(); ++i) {
        slope[i] = static_cast<double>(f.size() - 1) * (f[i + 1] - f[i]);
    }
    return slope;
}

/// f + g, both of the same degree.
template <class Real>
[[nodiscard]] std::vector<Real> sum(std::vector<Real> f, const std::vector<Real>& g) {
    for (std::size_t i = 0; i < f.size(); ++i) {
        f[i] += g[i];
    }
    return f;
}

/// f - g, both of the same degree.
template <class Real>
[[nodiscard]] std::vector<Real> difference(std::vector<Real> f, const std::vector<Real>& g) {
    for (std::size_t i = 0; i < f.size(); ++i) {
        f[i] -= g[i];
    }
    return f;
}

/// a' b - a b'.
template <class Real>
[[nodiscard]] std::vector<Real> wronskian(const std::vector<Real>& a, const std::vector<Real>& b) {
    return difference(product(derivative(a), b), product(a, derivative(b)));
}

/// |f_i|.
[[nodiscard]] Bernstein magnitudes(Bernstein f) noexcept;

/// Of the terms of a derivative's coefficients, for magnitudes f: sums where the derivative has
/// differences. Rounding is relative to these.
[[nodiscard]] Bernstein derivative_size(const Bernstein& f);

/// Largest |coefficient|: no value on [0, 1] is larger.
[[nodiscard]] double largest_magnitude(const Bernstein& f) noexcept;

/// Cuts f at 1/2 (de Casteljau): `f` becomes its left half, the right half is returned. For any
/// type that can be added and multiplied by a number.
template <class Value>
[[nodiscard]] std::vector<Value> cut_in_half(std::vector<Value>& f) {
    std::vector<Value> right = f;
    const std::size_t n = f.size();
    for (std::size_t level = 1; level < n; ++level) {
        for (std::size_t k = 0; k + level < n; ++k) {
            right[k] = 0.5 * (right[k] + right[k + 1]);
        }
        f[level] = right[0];
    }
    return right;
}

}  // namespace palpate::engine
