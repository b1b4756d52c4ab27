#pragma once

#include <cstdint>

/// Quantiles and tails that tests and intervals are read from, to some 1e-15 of themselves. The
/// only door to Boost.Math, whose headers cost a compiler seconds.
///
/// All throw std::domain_error for arguments out of their range.
namespace palpate::data {

/// The value below which Student's t of `df` has the probability p. @pre 0 < p < 1, df > 0
[[nodiscard]] double t_quantile(double p, double df);
/// P(|T| >= |t|) of Student's t of `df`. @pre df > 0
[[nodiscard]] double t_two_sided(double t, double df);

/// P(chi-square of `df` > x); 1 for x below 0. @pre df > 0
[[nodiscard]] double chi_square_p(double x, int df);

/// From low to high, both included.
struct Interval {
    double low = 0.0;
    double high = 1.0;
};

/// 97.5 % point of the standard normal distribution: two-sided 95 %.
inline constexpr double kNormal95 = 1.959963984540054;

/// Score interval of a share k / n (E. B. Wilson, J. Am. Stat. Assoc. 22:209, 1927), without
/// continuity correction. [0, 1] for n = 0. @pre 0 <= k <= n
[[nodiscard]] Interval wilson(std::int64_t k, std::int64_t n, double z = kNormal95);

/// The exact interval of a share k / n (C. J. Clopper, E. S. Pearson, Biometrika 26:404, 1934): the
/// shares under which k or more, or k or fewer, come with a probability of (1 - confidence) / 2.
/// [0, 1] for n = 0. Relative error below 1e-12 (tests: binomial tails summed). @pre 0 <= k <= n, 0
/// < confidence < 1
[[nodiscard]] Interval clopper_pearson(std::int64_t k, std::int64_t n, double confidence = 0.95);

}  // namespace palpate::data
