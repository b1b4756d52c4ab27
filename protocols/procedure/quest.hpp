#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/procedure/procedure_state.hpp"

namespace palpate::protocols {

/// Which point of the posterior is shown next.
enum class QuestRule : std::uint8_t {
    quantile,  ///< Pelli 1987: the order of the quantile follows from gamma and delta
    mean,      ///< King-Smith et al. 1994
    mode       ///< Watson & Pelli 1983
};
inline constexpr std::array<std::string_view, 3> kQuestRules{"quantile", "mean", "mode"};

/// Names and defaults are those of the QUEST toolbox that most laboratories use (Watson & Pelli
/// 1983; Psychophysics Toolbox).
struct QuestSpec {
    double guess = 0.0;         ///< tGuess: prior estimate of the threshold, log10 units
    double sd = 1.0;            ///< tGuessSd: of the normal prior, log10 units, > 0
    double p_threshold = 0.82;  ///< chance of a 1 at what is called the threshold
    double beta = 3.5;          ///< slope of the Weibull function, per log10 unit, > 0
    double delta = 0.01;        ///< share of trials answered blindly, 0 to below 1
    double gamma = 0.5;         ///< chance of a 1 far below threshold, 0 to below 1
    double grain = 0.01;        ///< step of the internal table, log10 units, > 0
    double range = 5.0;         ///< width of the internal table around guess, log10 units
    QuestRule rule = QuestRule::quantile;
    double lowest = -1e10;  ///< what is shown is kept from lowest to highest
    double highest = 1e10;
    std::size_t trials = 40;
};

/// QUEST (A. B. Watson and D. G. Pelli, "QUEST: A Bayesian adaptive psychometric method",
/// Perception & Psychophysics 33, 113-120, 1983), one parameter, two outcomes:
///
///     P(1 | x, t) = delta gamma + (1 - delta) (1 - (1 - gamma) exp(-10^(beta (x - t + e))))
///
/// with e such that P(1 | t, t) = p_threshold.
///
/// Where a careful reader might be surprised; the first four are as in the published toolbox:
/// * delta is the share of blind answers, of which gamma are a 1: the top is 1 - delta (1 - gamma).
/// * The stimulus that was shown is rounded to the grain before the posterior is updated, and one
///   further than `range` from a cell counts as if it were `range` from it.
/// * The quantile is interpolated on the sums of the table's weights, where a cell's weight counts
///   as lying below the cell: it stands about half a grain lower than that of a density.
/// * The order of the quantile is not 1/2: it balances what a right and a wrong answer tell
///   (quantile_order), .590 for the defaults.
/// * e is computed in closed form; the toolbox interpolates it in its table, 4e-4 grain away.
class Quest {
public:
    /// @throws std::invalid_argument for a member out of range, a p_threshold that the function
    ///         does not reach, or a table of more than 200,000 cells
    explicit Quest(const QuestSpec& spec);

    /// What the spec's rule takes of the posterior, its mean, mode or quantile, within the spec's
    /// lowest and highest.
    [[nodiscard]] std::vector<double> next() const;
    /// @throws std::invalid_argument for a stimulus that is not one finite number, for another
    ///         outcome than 0 and 1
    void update(std::span<const double> shown, std::size_t outcome);

    /// As Procedure's; the estimate is the threshold.
    [[nodiscard]] bool finished() const noexcept { return trials_ >= spec_.trials; }
    [[nodiscard]] std::size_t trials() const noexcept { return trials_; }
    [[nodiscard]] std::size_t outcomes() const noexcept { return 2; }
    [[nodiscard]] std::vector<std::string> stimulus_names() const { return {"stimulus"}; }
    [[nodiscard]] std::vector<Estimate> estimates() const;
    [[nodiscard]] double entropy() const noexcept;  ///< of the table's weights, bits
    [[nodiscard]] std::string state_hash() const;

    /// Of the posterior of the threshold, in the stimulus' unit.
    [[nodiscard]] double mean() const noexcept;
    [[nodiscard]] double mode() const noexcept;  ///< the first of the largest weights
    /// @param order  0..1
    [[nodiscard]] double quantile(double order) const noexcept;
    [[nodiscard]] double quantile_order() const noexcept { return order_; }

private:
    /// Threshold of cell i.
    [[nodiscard]] double at(std::size_t i) const noexcept;

    QuestSpec spec_;
    std::ptrdiff_t half_ = 0;  ///< cells on either side of the guess
    double offset_ = 0.0;      ///< e
    double order_ = 0.5;
    /// P(1) at -2 half ... 2 half grains from t.
    std::shared_ptr<const std::vector<double>> right_;
    std::vector<double> weights_;
    std::size_t trials_ = 0;
};

}  // namespace palpate::protocols
