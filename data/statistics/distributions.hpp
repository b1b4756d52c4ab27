#pragma once

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

/// x with I_x(a, b) = p, I being the incomplete beta function. @pre a, b > 0, 0 <= p <= 1
[[nodiscard]] double beta_quantile(double a, double b, double p);
/// x with 1 - I_x(a, b) = p, without loss where p is small. @pre the same
[[nodiscard]] double beta_upper_quantile(double a, double b, double p);

}  // namespace palpate::data
