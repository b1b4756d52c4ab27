#include "data/statistics/distributions.hpp"

#include <algorithm>
#include <cmath>

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/special_functions/beta.hpp>

namespace palpate::data {

double t_quantile(double p, double df) {
    return boost::math::quantile(boost::math::students_t(df), p);
}

double t_two_sided(double t, double df) {
    return 2.0 * boost::math::cdf(complement(boost::math::students_t(df), std::fabs(t)));
}

double chi_square_p(double x, int df) {
    return boost::math::cdf(complement(boost::math::chi_squared(df), std::max(x, 0.0)));
}

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
        interval.low = boost::math::ibeta_inv(hits, misses + 1.0, tail);
    }
    if (k < n) {  // P(X <= k) = 1 - I_p(k + 1, n - k)
        interval.high = boost::math::ibetac_inv(hits + 1.0, misses, tail);
    }
    return interval;
}

}  // namespace palpate::data
