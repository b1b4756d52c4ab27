#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>

namespace palpate::data {

/// Share correct of an unbiased observer who names the largest of m normal percepts, one of which
/// is d higher than the others, all of deviation 1 (D. M. Green, J. A. Swets, Signal Detection
/// Theory and Psychophysics, 1966):
///
///     P = integral of phi(x - d) Phi(x)^(m - 1) dx
///
/// By the trapezoid rule, which converges faster than any power here: error below 1e-13.
/// @param d  any finite number; below 0: worse than chance
/// @param m  alternatives, >= 2
[[nodiscard]] double share_correct(double d, std::int64_t m);

/// The d with share_correct(d, m) = hits / n; sqrt(2) probit(hits / n) for m = 2. Error below
/// 1e-10. Nobody is perfect: n of n counts as n - 1/2, none as 1/2 (N. A. Macmillan, H. L. Kaplan,
/// Psychol. Bull. 98:185, 1985), so that d stays finite.
/// @pre 0 <= hits <= n, n >= 1, m >= 2
/// @param least  answers that the correction is for, <= n; 0: n. Where conditions with different
///               numbers of answers are compared, the least of them: else who is perfect in both
///               would be better in the longer one.
[[nodiscard]] double d_prime(std::int64_t hits,
                             std::int64_t n,
                             std::int64_t m,
                             std::int64_t least = 0);

/// What yes/no answers say by signal detection.
struct YesNo {
    double d_prime = 0.0;    ///< z(hit rate) - z(false alarm rate)
    double criterion = 0.0;  ///< c = -(z(hit rate) + z(false alarm rate)) / 2: above 0 rather no
};

/// Of yes/no answers. Rates with the log-linear correction (M. J. Hautus, Behav. Res. Methods
/// Instrum. Comput. 27:46, 1995): half a yes and one trial more, in each row, whether it is needed
/// or not.
/// @param least_signals, least_noises as of d_prime(): shares are taken to be of so many, 0: of
/// signals, noises
/// @pre 0 <= hits <= signals, 0 <= false_alarms <= noises, signals and noises >= 1
[[nodiscard]] YesNo yes_no(std::int64_t hits,
                           std::int64_t signals,
                           std::int64_t false_alarms,
                           std::int64_t noises,
                           std::int64_t least_signals = 0,
                           std::int64_t least_noises = 0);

/// How often each stimulus was answered with each response.
using ConfusionCounts = std::map<std::pair<std::string, std::string>, std::int64_t>;

/// Transmitted information H(stimulus) + H(response) - H(both), bits.
struct Information {
    double plug_in = 0.0;  ///< from the shares as they are: too high for few answers
    /// Each entropy corrected by (cells that occur - 1) / (2 N ln 2) (G. A. Miller, 1955). May be
    /// below 0, and above `most`.
    double miller_madow = 0.0;
    double corrected = 0.0;  ///< the same, cut to 0 and `most`: what is shown and averaged
    double most = 0.0;       ///< H(stimulus)
};

/// Zeros without any answer. @pre no count is negative
[[nodiscard]] Information mutual_information(const ConfusionCounts& counts);

}  // namespace palpate::data
