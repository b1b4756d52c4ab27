#include "engine/math/bernstein.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::engine {
namespace {

double binomial(std::size_t n, std::size_t k) {
    double value = 1.0;
    for (std::size_t i = 1; i <= k; ++i) {
        value = value * static_cast<double>(n - k + i) / static_cast<double>(i);
    }
    return value;
}

}  // namespace

Bernstein product(const Bernstein& f, const Bernstein& g) {
    const std::size_t m = f.size() - 1;
    const std::size_t n = g.size() - 1;
    Bernstein fg(m + n + 1, 0.0);
    for (std::size_t i = 0; i <= m; ++i) {
        for (std::size_t j = 0; j <= n; ++j) {
            fg[i + j] += binomial(m, i) * binomial(n, j) / binomial(m + n, i + j) * f[i] * g[j];
        }
    }
    return fg;
}

Bernstein derivative(const Bernstein& f) {
    Bernstein slope(f.size() - 1);
    for (std::size_t i = 0; i < slope.size(); ++i) {
        slope[i] = static_cast<double>(f.size() - 1) * (f[i + 1] - f[i]);
    }
    return slope;
}

Bernstein sum(Bernstein f, const Bernstein& g) {
    for (std::size_t i = 0; i < f.size(); ++i) {
        f[i] += g[i];
    }
    return f;
}

Bernstein wronskian(const Bernstein& a, const Bernstein& b) {
    Bernstein left = product(derivative(a), b);
    const Bernstein right = product(a, derivative(b));
    for (std::size_t i = 0; i < left.size(); ++i) {
        left[i] -= right[i];
    }
    return left;
}

Bernstein magnitudes(Bernstein f) noexcept {
    for (double& c : f) {
        c = std::fabs(c);
    }
    return f;
}

Bernstein derivative_size(const Bernstein& f) {
    Bernstein size(f.size() - 1);
    for (std::size_t i = 0; i < size.size(); ++i) {
        size[i] = static_cast<double>(f.size() - 1) * (f[i + 1] + f[i]);
    }
    return size;
}

double largest_magnitude(const Bernstein& f) noexcept {
    double largest = 0.0;
    for (const double v : f) {
        largest = std::max(largest, std::fabs(v));
    }
    return largest;
}

}  // namespace palpate::engine
