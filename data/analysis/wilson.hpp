#pragma once

#include <cstdint>

namespace palpate::data {

struct Interval {
    double low = 0.0;
    double high = 1.0;
};

/// 97.5 % point of the standard normal distribution: two-sided 95 %.
inline constexpr double kNormal95 = 1.959963984540054;

/// Score interval of a share k / n (E. B. Wilson, J. Am. Stat. Assoc. 22:209, 1927), without continuity
/// correction. [0, 1] for n = 0. @pre 0 <= k <= n
[[nodiscard]] Interval wilson(std::int64_t k, std::int64_t n, double z = kNormal95);

}  // namespace palpate::data
