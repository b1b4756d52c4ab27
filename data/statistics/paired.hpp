#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "data/statistics/wilson.hpp"

/// One number a person, against 0: differences within people. Each test says what the others do
/// not, and none counts trials. The sign-flip test is in over_people.hpp.
namespace palpate::data {

/// Student's t of differences.
struct PairedT {
    double mean = 0.0;
    double sd = 0.0;
    double t = 0.0;
    double df = 0.0;
    double p = 1.0;       ///< two-sided
    Interval interval{};  ///< 95 %, of the mean
    double dz = 0.0;      ///< mean / sd
};

/// Student's paired t. Nothing for fewer than two people, or where all have the same value.
[[nodiscard]] std::optional<PairedT> paired_t(std::span<const double> differences);

/// Wilcoxon's signed ranks.
struct SignedRank {
    double v = 0.0;          ///< sum of the ranks of what is above 0
    std::size_t ranked = 0;  ///< that are not 0: zeros are left out, as Wilcoxon did
    double p = 1.0;          ///< two-sided
    bool exact = true;
};

/// The signed-rank test (F. Wilcoxon, Biometrics Bull. 1:80, 1945). Equal sizes share their mean
/// rank; p is that of all 2^n patterns of signs of these very ranks, ties included, so that nothing
/// is approximated: up to 300 people, beyond by the normal distribution with the variance sum r^2 /
/// 4. Sizes within 1e-9 of the largest count as equal: shares of the same counts differ in their
/// last bits.
[[nodiscard]] SignedRank signed_rank(std::span<const double> differences);

/// Scale r of the Cauchy prior of the standardised effect that is taken where nobody says another:
/// sqrt(2) / 2, "medium" (R. D. Morey, J. N. Rouder, package BayesFactor).
inline constexpr double kJzsScale = 0.70710678118654752440;

/// Bayes factor of an effect over none, BF10, of a paired t of n people, with the JZS prior: effect
/// / sd ~ Cauchy(0, r), p(sd) ~ 1 / sd (J. N. Rouder, P. L. Speckman, D. Sun, R. D. Morey, G.
/// Iverson, Psychon. Bull. Rev. 16:225, 2009, eq. 1, with N r^2 for N):
///
///     BF10 = integral over g of  w^(-1/2) ((1 + t^2 / (w v)) / (1 + t^2 / v))^(-(v + 1) / 2)
///            (2 pi)^(-1/2) g^(-3/2) e^(-1 / (2 g)),   w = 1 + N r^2 g,   v = N - 1
///
/// By the trapezoid rule over ln g: relative error below 1e-10 (tests: the same by the noncentral t
/// over the prior).
/// @pre n >= 2, r > 0, t finite. Infinite where it is above the largest double
[[nodiscard]] double jzs_bayes_factor(double t, std::size_t n, double r = kJzsScale);

}  // namespace palpate::data
