#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "data/statistics/distributions.hpp"

namespace palpate::data {

/// How often each item (row) was called each response (column), both in order of what is judged.
using CallCounts = std::vector<std::vector<std::int64_t>>;

/// There is an answer.
[[nodiscard]] inline bool answered(const CallCounts& counts) {
    return std::ranges::any_of(counts, [](const auto& row) {
        return std::ranges::any_of(row, [](std::int64_t n) { return n > 0; });
    });
}

/// Ordered items that differ in one quantity.
struct ThurstoneSpec {
    std::vector<double> items{};  ///< values of the rows, strictly increasing, 2 or more
    double lapse = 0.02;          ///< share of answers that any response gets alike, 0 .. 0.25
    std::size_t one_sigma = 0;    ///< the condition whose sigma is the first one's; 0: none
    std::size_t no_shift = 0;     ///< the condition that does not shift the percept; 0: none
    bool relative = false;  ///< sigma of a condition is fitted by its ratio to the first one's
    bool checked = true;    ///< also by the second optimiser
    bool intervals = true;  ///< also the intervals
};

}  // namespace palpate::data

/// The likelihood of the ordinal model of thurstone.hpp, and how it is climbed.
namespace palpate::data::thurstone {

inline constexpr double kLowest = -std::numeric_limits<double>::infinity();
/// ln sigmas, criteria and shifts, as Layout has them; also a gradient, and row by row a matrix.
using Parameters = std::vector<double>;
inline constexpr std::size_t kNone = static_cast<std::size_t>(-1);

inline constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// Between two neighbours among items in rising order.
[[nodiscard]] double least_distance(const std::vector<double>& items);
/// Ends of ln sigma, or of ln of a ratio of two: below 0.1 of the least distance of two items
/// nothing but lapses is left, beyond 1,000 times the range of all an answer tells nothing of the
/// item.
[[nodiscard]] Interval sigma_limits(const ThurstoneSpec& spec, bool ratio);

/// Which parameters there are: criteria between responses that were given, ln sigma, shifts.
struct Layout {
    std::vector<std::size_t> used{};  ///< responses
    std::size_t conditions = 1;
    std::size_t one_sigma = 0;
    std::size_t no_shift = 0;

    /// Where Parameters have what: criteria first, then ln sigma of each condition, then shifts of
    /// all conditions but the first; how many there are. What ThurstoneSpec takes from a condition
    /// has no place.
    [[nodiscard]] std::size_t criteria() const { return used.size() - 1; }
    [[nodiscard]] std::size_t sigma(std::size_t condition) const {
        return criteria() + (condition == one_sigma ? 0 : after(one_sigma, condition));
    }
    [[nodiscard]] bool shifts(std::size_t condition) const {
        return condition > 0 && condition != no_shift;
    }
    /// @pre shifts(condition)
    [[nodiscard]] std::size_t shift(std::size_t condition) const {
        return criteria() + after(one_sigma, conditions) + after(no_shift, condition) - 1;
    }
    [[nodiscard]] std::size_t size() const {
        return criteria() + after(one_sigma, conditions) + after(no_shift, conditions) - 1;
    }

private:
    static std::size_t after(std::size_t taken, std::size_t condition) {
        return taken > 0 && condition > taken ? condition - 1 : condition;
    }
};

/// The likelihood of the counts, for one value of the parameters after the other.
class Model {
public:
    /// Keeps references to both. @pre a row of counts for each item, of equal length
    Model(const std::vector<CallCounts>& counts, const ThurstoneSpec& spec)
        : counts_(counts), spec_(spec) {
        const std::size_t responses = counts.front().front().size();
        for (std::size_t j = 0; j < responses; ++j) {
            const bool given = std::ranges::any_of(counts, [j](const CallCounts& one) {
                return std::ranges::any_of(one, [j](const auto& row) { return row[j] > 0; });
            });
            if (given) {
                layout_.used.push_back(j);
            }
        }
        layout_.conditions = counts.size();
        layout_.one_sigma = spec.one_sigma;
        layout_.no_shift = spec.no_shift;
    }

    /// Sigmas stay within a factor of 10,000 of what is as good as 0 and as infinite, but for one
    /// that is held.
    void keep_within(Parameters& at, std::size_t held = kNone) const {
        const Interval limits = sigma_limits(spec_, false);
        const double wide = std::log(1e4);
        for (std::size_t f = 0; f < layout_.conditions; ++f) {
            if (layout_.sigma(f) == held) {
                continue;
            }
            double& one = at[layout_.sigma(f)];
            const double first = spec_.relative && f > 0 ? at[layout_.sigma(0)] : 0.0;
            one = std::clamp(one, limits.low - wide - first, limits.high + wide - first);
        }
    }

    /// Of a condition.
    [[nodiscard]] const CallCounts& counts(std::size_t f) const { return counts_[f]; }

    /// Of its parameters.
    [[nodiscard]] const Layout& layout() const { return layout_; }

    /// Log-likelihood, and if asked for its gradient and the expected information.
    double value(const Parameters& at,
                 Parameters* gradient = nullptr,
                 Parameters* information = nullptr) const;

    /// Of condition f at `at`, in the items' unit; also where the parameters hold a ratio.
    [[nodiscard]] double sigma(const Parameters& at, std::size_t f) const {
        const bool ratio = spec_.relative && f > 0;
        return std::exp(at[layout_.sigma(f)] + (ratio ? at[layout_.sigma(0)] : 0.0));
    }

private:
    [[nodiscard]] double shift(const Parameters& at, std::size_t f) const {
        return layout_.shifts(f) ? at[layout_.shift(f)] : 0.0;
    }
    struct Row;
    double row_value(const Parameters& at,
                     std::size_t f,
                     std::size_t i,
                     Row& row,
                     Parameters* gradient,
                     Parameters* information) const;

    const std::vector<CallCounts>& counts_;
    const ThurstoneSpec& spec_;
    Layout layout_{};
};

/// Where the likelihood is highest, and its logarithm there.
struct Maximum {
    Parameters at;
    double value = kLowest;
    Parameters from{};  ///< where the climb to it began
};

/// Of log-likelihood. Towards a sigma of 0 a ridge rises by less than this for long.
inline constexpr double kNoLoss = 1e-3;
/// The other instead of `top` where it is higher by more than a margin; whether it is.
bool take_higher(Maximum& top, Maximum other, double margin = 0.0);

/// The maximum near a start, by Fisher scoring with Levenberg's damping.
/// @param held, also  parameters that stay
[[nodiscard]] Maximum climb(const Model& model,
                            Parameters start,
                            std::size_t held = kNone,
                            std::size_t also = kNone);
/// Criteria spread evenly over the items, and this sigma.
[[nodiscard]] Parameters start_at(const Layout& layout, const ThurstoneSpec& spec, double sigma);
/// From sigmas of 0.4, 1 and 3 of the least distance of two items.
[[nodiscard]] std::vector<Parameters> starts_of(const Layout& layout, const ThurstoneSpec& spec);
/// The highest that is found from `top` with one sigma or shift moved elsewhere, the others climbed
/// first: hills of sharp conditions are narrow.
[[nodiscard]] Maximum over_hills(const Model& model,
                                 const ThurstoneSpec& spec,
                                 Maximum top,
                                 std::size_t held = kNone);
/// The same from the highest of climb() from all starts.
[[nodiscard]] Maximum highest(const Model& model, const ThurstoneSpec& spec);

}  // namespace palpate::data::thurstone

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
/// of several hills taken (thurstone::highest()); a profile that finds a higher one is made again
/// there.
/// @param counts  of each condition, all of the same size
/// @throws std::invalid_argument with value and remedy: sizes, order, fewer than two responses in
/// use
[[nodiscard]] ThurstoneFit fit_thurstone(const std::vector<CallCounts>& counts,
                                         const ThurstoneSpec& spec);

}  // namespace palpate::data
