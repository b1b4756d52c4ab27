#pragma once

#include <array>
#include <cstdint>
#include <string_view>

/// Psychometric functions: the chance of a "1" (correct, yes, "more") at a stimulus, and its
/// inverse.
namespace palpate::protocols {

/// The core F(x), from 0 to 1; t is the threshold, b the slope. Slopes of different families are
/// different quantities: compare thresholds only at the same probability (stimulus_at).
///
///    family         F(x)                          F(t)      axis of x     slope b
///    weibull        1 - exp(-(x/t)^b)             1 - 1/e   linear, >= 0  none
///    weibull_log10  1 - exp(-10^(b (x - t)))      1 - 1/e   log10         per decade
///    weibull_db     1 - exp(-10^(b (x - t)/20))   1 - 1/e   dB = 20 log10 per decade, as for log10
///    gumbel         1 - exp(-e^(b (x - t)))       1 - 1/e   any           1 / unit of x
///    normal         Phi(b (x - t))                1/2       any           1 / standard deviation
///    logistic       1 / (1 + e^(-b (x - t)))      1/2       any           1 / unit of x
///
/// The three Weibull lines are one function on three axes with the same b (Watson 2017 writes the
/// dB line). Kingdom & Prins (2016, ch. 4) call the log10 line "Gumbel or log-Weibull"; the gumbel
/// here has e for 10, so that its b is ln 10 times theirs.
enum class Family : std::uint8_t { weibull, weibull_log10, weibull_db, gumbel, normal, logistic };
inline constexpr std::array<std::string_view, 6> kFamilyWords{
    "weibull", "weibull_log10", "weibull_db", "gumbel", "normal", "logistic"};

/// How guesses and lapses frame F; g is the guess rate, l the lapse rate.
///
///   upper      g + (1 - g - l) F                from g to 1 - l: Wichmann & Hill 2001, Watson 2017
///   two_sided  l + (1 - 2 l) F                  from l to 1 - l: two answers of which neither is
///                                               "wrong" (Watson 2017, example 3); g is not used
///   guessing   l g + (1 - l) (g + (1 - g) F)    a lapse is answered at the guess rate, so that the
///                                               top is 1 - l (1 - g): QUEST's delta and gamma
///                                               (Watson & Pelli 1983)
enum class LapseForm : std::uint8_t { upper, two_sided, guessing };
inline constexpr std::array<std::string_view, 3> kLapseWords{"upper", "two_sided", "guessing"};

/// One psychometric function.
struct PsychometricFunction {
    Family family = Family::weibull_log10;
    LapseForm form = LapseForm::upper;
    double threshold = 0.0;  ///< t, on the family's axis; > 0 for weibull
    double slope = 3.5;      ///< b > 0
    double guess = 0.5;      ///< g, 0 <= g < 1
    double lapse = 0.01;     ///< l, 0 <= l < 1 and bottom < top
};

/// F(x): see Family. A weibull at x < 0 is as at 0.
[[nodiscard]] double core(Family family, double x, double threshold, double slope) noexcept;

/// The x of F(x) = share. -infinity (0 for weibull) at share 0, infinity at 1, NaN outside.
[[nodiscard]] double core_inverse(Family family,
                                  double share,
                                  double threshold,
                                  double slope) noexcept;

/// Chance of a "1" at x, between bottom(f) and top(f).
[[nodiscard]] double probability(const PsychometricFunction& f, double x) noexcept;

/// Chances at x = -infinity and at infinity.
[[nodiscard]] double bottom(const PsychometricFunction& f) noexcept;
[[nodiscard]] double top(const PsychometricFunction& f) noexcept;

/// The stimulus at which the chance of a "1" is p.
/// @throws std::invalid_argument if p is not between bottom(f) and top(f), the ends left out
[[nodiscard]] double stimulus_at(const PsychometricFunction& f, double p);

/// @throws std::invalid_argument for parameters out of their ranges, or with bottom >= top
void check(const PsychometricFunction& f);

}  // namespace palpate::protocols
