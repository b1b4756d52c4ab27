#pragma once

#include <span>

/// Exponential and normal distribution from + - * / and exact scaling only, beside the logarithm of
/// engine/math/elementary.hpp: the same to the bit on every IEEE-754 machine built with
/// -ffp-contract=off. An adaptive procedure picks the stimulus of least expected entropy; with
/// libm, one ulp between two C libraries could pick another one, and every trial after it would
/// differ.
namespace palpate::protocols {

inline constexpr double kLn2 = 0.693147180559945309417232121458176568;
inline constexpr double kLn10 = 2.302585092994045684017991454684364208;

/// e^x. 0 below -745.2, infinity above 709.7; NaN for NaN. Within 2 ulp (psychometric_test.cpp).
/// x = n ln 2 + r, |r| <= ln 2 / 2, and Taylor's polynomial of degree 13 for e^r.
[[nodiscard]] double exponential(double x) noexcept;

/// 10^x. Relative error below 1e-15 + |x| 6e-16.
[[nodiscard]] double power_of_ten(double x) noexcept;

/// p log2 p, and 0 for p <= 0: a term of an entropy, in bits.
[[nodiscard]] double p_log_p(double p) noexcept;
/// Entropy of shares that sum to 1, bits.
[[nodiscard]] double entropy_of(std::span<const double> shares) noexcept;

/// Phi(z), the share of a standard normal distribution below z. Relative error below 1e-14 in both
/// tails, 0 below -38.5. |z| < 1.5: Abramowitz & Stegun 26.2.11, a series of positive terms;
/// beyond: the continued fraction 26.2.14.
[[nodiscard]] double normal_cdf(double z) noexcept;

/// The z with Phi(z) = p, 0 < p < 1. -infinity at 0, infinity at 1, NaN outside.
/// A&S 26.2.23, then three of Halley's steps on normal_cdf.
[[nodiscard]] double normal_quantile(double p) noexcept;

}  // namespace palpate::protocols
