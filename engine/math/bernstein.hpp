#pragma once

#include <vector>

namespace palpate::engine {

/// Polynomials on [0, 1] by their Bernstein coefficients. For setting up only: they allocate.
using Bernstein = std::vector<double>;

/// f g: Farouki & Rajan 1988, eq. 44.
[[nodiscard]] Bernstein product(const Bernstein& f, const Bernstein& g);

/// f'.
[[nodiscard]] Bernstein derivative(const Bernstein& f);

/// f + g, both of the same degree.
[[nodiscard]] Bernstein sum(Bernstein f, const Bernstein& g);

/// a' b - a b'.
[[nodiscard]] Bernstein wronskian(const Bernstein& a, const Bernstein& b);

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
