#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "data/statistics/distributions.hpp"

/// What a sample of people tells of people: the person is the unit, never the trial. An interval
/// that pools the trials of several people is too narrow as soon as they differ: with a spread of
/// 0.5 logit, 12 people and 50 trials each, the pooled Wilson interval of 95 % holds the mean share
/// in .70 of samples.
///
/// Differences within people are one number a person, against 0: each test says what the others do
/// not, and none counts trials.
namespace palpate::data {

/// The mean over people, with its interval.
struct PeopleMean {
    std::size_t people = 0;
    double mean = 0.0;
    /// 95 %. Nothing for fewer than two people, or where all are alike: how people differ is not
    /// known then.
    std::optional<Interval> interval{};
};

/// What rounding does to a number of this size or less, with much to spare.
inline constexpr double kRounding = 1e-12;

/// second - first; 0 where rounding alone parts them: equal answers in another number differ in
/// their last bits, and all to one side.
[[nodiscard]] double difference_of(double first, double second);

/// The mean of a number that each person has, with Student's t interval over people. People are
/// alike where no two values are further apart than kRounding of the largest: 0.8 - 0.6 and 0.7 -
/// 0.5 differ in their last bits, which is no spread of people. In any order of the people it is
/// the same to the bit.
/// @param size  the largest of what the values are differences of, where that is known
/// @pre every value is finite; one or more
[[nodiscard]] PeopleMean mean_over_people(std::span<const double> values, double size = 0.0);

/// The same of a share from 0 to 1. The mean is that of the shares; the interval is Student's, with
/// the standard error carried to the logit scale of the mean, so that it stays inside 0 to 1:
///
///     logit m -+ t(n - 1) s / (sqrt(n) m (1 - m))
///
/// Chosen by simulation, 12 people x 50 trials, spreads of 0, 0.5 and 1 logit, mean shares from .5
/// to .88: it holds the mean share of people in .946 to .956 of samples, t on the shares in .926 to
/// .953, t on each person's logit in .881 to .955 (its centre is another quantity), on the arcsine
/// in .914 to .953. Within .5 .. .73 it is between .949 and .956 (tests). Nothing where the mean is
/// 0 or 1.
[[nodiscard]] PeopleMean mean_share_over_people(std::span<const double> shares);

/// Who has no such number, and why: an average over people names them, or it would be of others
/// than it seems.
struct LeftOutPerson {
    std::string name{};
    std::string why{};
};

/// "2 people left out: P03 (no curve), P05 (unbounded)"; empty for nobody.
[[nodiscard]] std::string without_text(std::span<const LeftOutPerson> people);

/// The middle value, of two the mean of both. Values may be infinite, where only their rank is
/// known. Nothing for no value, or where the middle is not finite. @pre none is NaN
[[nodiscard]] std::optional<double> median_of(std::vector<double> values);

/// The p of a sign-flip test, two-sided.
struct SignFlip {
    double p = 1.0;
    bool exact = true;  ///< every pattern of signs was counted
};

/// Two-sided sign-flip (paired permutation) test of the mean of differences within people: the
/// share of all 2^n patterns of signs whose sum is as far from 0 as the observed one (R. A. Fisher,
/// The Design of Experiments, 1935, section 21). Exact up to 40 people; beyond by 1,000,000
/// patterns drawn with a fixed seed. Never below 2^(1 - n).
[[nodiscard]] SignFlip sign_flip(std::span<const double> differences);

/// The share of all 2^n patterns of signs of n whole numbers whose sum is as far from 0 as that of
/// which those above 0 sum to `above`: in n times the sum of all instead of 2^n steps.
[[nodiscard]] double signed_sums_p(std::span<const std::size_t> sizes, std::size_t above);

/// The difference k2 / n2 - k1 / n1 of two shares of one person, by the square-and-add of both
/// Wilson intervals (R. G. Newcombe, Stat. Med. 17:873, 1998, method 10). Of this person's trials,
/// not of people.
/// @pre 0 <= k <= n, n >= 1
[[nodiscard]] Interval newcombe(std::int64_t k1, std::int64_t n1, std::int64_t k2, std::int64_t n2);

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

/// Student's paired t. Nothing for fewer than two people, or where all are alike.
/// @param size  as of mean_over_people()
[[nodiscard]] std::optional<PairedT> paired_t(std::span<const double> differences,
                                              double size = 0.0);

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
