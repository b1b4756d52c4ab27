#pragma once

#include <array>
#include <cstddef>
#include <span>
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

/// Of the terms of a' b - a b', for magnitudes a and b.
[[nodiscard]] Bernstein wronskian_size(const Bernstein& a, const Bernstein& b);

/// Largest |coefficient|: no value on [0, 1] is larger.
[[nodiscard]] double largest_magnitude(const Bernstein& f) noexcept;

/// Coefficients of 1, u, u^2 and u^3 from Bezier values, by forward differences times binomials.
/// @param degree  up to 3
template <class Value>
[[nodiscard]] std::array<Value, 4> powers(std::span<const Value> b, int degree) {
    const double n = degree;
    std::array<Value, 4> c{};
    c[0] = b[0];
    c[1] = n * (b[1] - b[0]);
    if (degree >= 2) {
        c[2] = (0.5 * n * (n - 1.0)) * ((b[2] - b[1]) - (b[1] - b[0]));
    }
    if (degree == 3) {
        c[3] = (b[3] - b[0]) - 3.0 * (b[2] - b[1]);
    }
    return c;
}

/// Cuts f at t (de Casteljau): what is left of it on [0, t] and on [t, 1]. For any type that can be
/// added and multiplied by a number.
template <class Value>
struct CutAt {
    std::vector<Value> left;
    std::vector<Value> right;

    CutAt(std::vector<Value> f, double t) : right(f) {
        const std::size_t n = f.size();
        for (std::size_t level = 0; level < n; ++level) {
            left.push_back(f[0]);
            right[n - 1 - level] = f[n - 1 - level];
            for (std::size_t k = 0; k + 1 < n - level; ++k) {
                f[k] = (1.0 - t) * f[k] + t * f[k + 1];
            }
        }
    }
};

/// Cuts f at 1/2 (de Casteljau): `f` becomes its left half, the right half is returned.
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
