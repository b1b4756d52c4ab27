#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "engine/base/pcg32.hpp"

namespace palpate::data {

/// Draws a binomial number by the inverse of its distribution: one uniform number, log2(n)
/// comparisons.
class Binomial {
public:
    /// @param n  a whole number, >= 0   @param p  0..1
    Binomial(double n, double p) {
        const auto count = static_cast<std::size_t>(n);
        const double mean = n * p;
        const double reach = 12.0 * std::sqrt(mean * (1.0 - p)) + 40.0;  // beyond: below 1e-30
        first_ = static_cast<std::size_t>(std::max(0.0, std::floor(mean - reach)));
        const std::size_t last = std::min(count, static_cast<std::size_t>(mean + reach) + 1);
        if (p <= 0.0 || p >= 1.0) {
            first_ = p <= 0.0 ? 0 : count;
            return;
        }
        // Terms over that of the mode, outward, so that none overflows.
        const auto mode = std::clamp(static_cast<std::size_t>(mean), first_, last);
        std::vector<double> terms(last - first_ + 1, 1.0);
        const double odds = p / (1.0 - p);
        for (std::size_t k = mode; k < last; ++k) {
            terms[k + 1 - first_] = terms[k - first_] * odds * static_cast<double>(count - k) /
                                    static_cast<double>(k + 1);
        }
        for (std::size_t k = mode; k > first_; --k) {
            terms[k - 1 - first_] = terms[k - first_] / odds * static_cast<double>(k) /
                                    static_cast<double>(count - k + 1);
        }
        double sum = 0.0;
        for (double& term : terms) {
            sum += term;
            term = sum;
        }
        for (double& term : terms) {
            term /= sum;
        }
        terms.back() = 1.0;
        cumulative_ = std::move(terms);
    }

    /// A number of successes; takes two numbers of the stream.
    [[nodiscard]] double draw(Pcg32& random) const {
        const double uniform = (static_cast<double>(random.next()) +
                                (static_cast<double>(random.next()) + 0.5) * 0x1p-32) *
                               0x1p-32;
        const auto at = std::ranges::lower_bound(cumulative_, uniform);
        return static_cast<double>(first_) + static_cast<double>(at - cumulative_.begin());
    }

private:
    std::size_t first_ = 0;
    std::vector<double> cumulative_{};  ///< none: it is always first_
};

}  // namespace palpate::data
