#include "data/statistics/distributions.hpp"
#include "data/statistics/wilson.hpp"

namespace palpate::data {

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
