#include "data/statistics/wilson.hpp"

#include <algorithm>
#include <cmath>

#include "data/statistics/distributions.hpp"

namespace palpate::data {

Interval wilson(std::int64_t k, std::int64_t n, double z) {
    if (n <= 0) {
        return {};
    }
    const auto count = static_cast<double>(n);
    const double p = static_cast<double>(k) / count;
    const double z2 = z * z / count;
    const double centre = (p + 0.5 * z2) / (1.0 + z2);
    const double half = std::sqrt((p * (1.0 - p) + 0.25 * z2) / count) * z / (1.0 + z2);
    return {k == 0 ? 0.0 : std::max(0.0, centre - half),
            k == n ? 1.0 : std::min(1.0, centre + half)};
}

Interval clopper_pearson(std::int64_t k, std::int64_t n, double confidence) {
    Interval interval;
    const double tail = 0.5 * (1.0 - confidence);
    const auto hits = static_cast<double>(k);
    const auto misses = static_cast<double>(n - k);
    if (k > 0) {  // P(X >= k) = I_p(k, n - k + 1)
        interval.low = beta_quantile(hits, misses + 1.0, tail);
    }
    if (k < n) {  // P(X <= k) = 1 - I_p(k + 1, n - k)
        interval.high = beta_upper_quantile(hits + 1.0, misses, tail);
    }
    return interval;
}

}  // namespace palpate::data
