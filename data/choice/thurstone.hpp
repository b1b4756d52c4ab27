#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "data/choice/thurstone_model.hpp"
#include "data/statistics/distributions.hpp"

namespace palpate::data {

/// Whether the answers bound a sigma. Its estimate is a number in the first case alone.
enum class SigmaEnd : std::uint8_t {
    both,
    sharp,    ///< as good as 0: the likelihood grows to that end
    blunt,    ///< as good as infinite: answers do not follow the items
    unknown,  ///< any is as good: no answers, or too few different ones
};

/// A condition's part of a fit.
struct ThurstonePart {
    double sigma =
        0.0;  ///< sd of the percept, in the unit of the items: what it takes to tell them apart
    double shift = 0.0;  ///< of every percept against the first condition's, same unit; there 0
    SigmaEnd end = SigmaEnd::both;
    /// 95 % by profile likelihood, as data/fit/curve_fit.hpp has it: what costs less than 1.92 of
    /// log-likelihood. Low is 0, high infinite, where that end is open: beyond 0.1 of the least
    /// distance of two items, or 1,000 times the range of all. Of the shift beyond 20 times the
    /// range. Of a ratio where sigmas are relative.
    std::optional<Interval> sigma_interval{};
    std::optional<Interval> shift_interval{};
    double ratio_loss = 0.0;  ///< of log-likelihood where a relative sigma is 1
    double shift_loss = 0.0;  ///< and there where the shift is 0
};

/// A fitted model: percepts are normal about an item's place, criteria cut them into responses.
struct ThurstoneFit {
    /// Percepts at which a response passes to the next, one fewer than responses; two are equal
    /// where the response between them was never given.
    std::vector<double> criteria{};
    std::vector<ThurstonePart> parts{};
    double log_likelihood = 0.0;
    double first = 0.0;     ///< by the climb alone
    double second = 0.0;    ///< by the simplex; NaN: not asked for
    bool agree = true;      ///< both within 1e-6; else the larger is taken
    double deviance = 0.0;  ///< against shares of each row and condition that are free
    std::int64_t df = 0;    ///< free shares less parameters
};

/// The ordinal model of L. L. Thurstone (Psychol. Rev. 34:273, 1927; law of categorical judgment)
/// with the items' values known, by maximum likelihood:
///
///     P(response <= j | item i, condition f) = Phi((c_j - x_i - b_f) / sigma_f),   b_0 = 0
///
/// mixed with lapses, lapse / m each. The criteria are the observer's own in all conditions: so
/// sigma, how well items are distinguished, and the shift, by how much all feel more or less, come
/// apart, as no share correct can part them. Fisher scoring with Levenberg's damping, the highest
/// of several hills taken (thurstone_model.hpp); a profile that finds a higher one is made again
/// there.
/// @param counts  of each condition, all of the same size
/// @throws std::invalid_argument with value and remedy: sizes, order, fewer than two responses in
/// use
[[nodiscard]] ThurstoneFit fit_thurstone(const std::vector<CallCounts>& counts,
                                         const ThurstoneSpec& spec);

}  // namespace palpate::data
