#include "data/statistics/wilson.hpp"

#include <algorithm>
#include <cmath>

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

}  // namespace palpate::data
