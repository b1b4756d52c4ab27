#include "engine/math/bernstein.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::engine {

double binomial(std::size_t n, std::size_t k) noexcept {
    double value = 1.0;
    for (std::size_t i = 1; i <= k; ++i) {
        value = value * static_cast<double>(n - k + i) / static_cast<double>(i);
    }
    return value;
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

Bernstein wronskian_size(const Bernstein& a, const Bernstein& b) {
    return sum(product(derivative_size(a), b), product(a, derivative_size(b)));
}

double largest_magnitude(const Bernstein& f) noexcept {
    double largest = 0.0;
    for (const double v : f) {
        largest = std::max(largest, std::fabs(v));
    }
    return largest;
}

}  // namespace palpate::engine
