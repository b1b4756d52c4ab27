#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocols/procedure/grid.hpp"
#include "protocols/procedure/procedure_state.hpp"

namespace palpate::protocols {

/// Expected entropy of the posterior after one more trial, bits, for every stimulus of the table:
///
///     E H(x) = sum_r P(r|x) H(w | r, x) = H(w) + sum_c w_c h(x, c) - H(R|x)
///
/// with w the weights, h(x, c) the entropy of the outcome at x in cell c, and H(R|x) that of the
/// outcome at x as w predicts it: the expected loss of entropy is the mutual information of outcome
/// and cell (Lindley 1956; Cover & Thomas 2006, 2.4). No logarithm a cell is left; three sums over
/// the cells do it.
[[nodiscard]] std::vector<double> expected_entropies(const LikelihoodTable& table,
                                                     std::span<const double> weights);

/// From now on `told` is called before a table of more than 50 MB is made, which takes up to half a
/// minute. Before any QuestPlus is made; on the thread that makes one.
void announce_large_tables(std::function<void(double megabytes)> told);

struct CellGroups;  // which combination of the wanted parameters each cell has

/// The tie rule: the first of the stimuli whose expected entropy is within 1e-12 bit (of the
/// entropy, where that is more than 1 bit) of the least. Symmetric problems have exact ties, which
/// rounding would break in a way of its own.
[[nodiscard]] std::size_t first_of_least(std::span<const double> entropies) noexcept;

/// What is believed of the parameters: a weight for every cell of a grid; the weights add up to 1.
class Posterior {
public:
    /// The product of one list of weights an axis; an empty list is uniform. Weights need not add
    /// up to 1.
    /// @throws std::invalid_argument if a list has another length than its axis, has negative or no
    ///         finite weights, or only zeros
    Posterior(const Grid& grid, std::span<const std::vector<double>> axis_weights);

    /// One a cell of the grid, >= 0; they sum to 1 but for rounding.
    [[nodiscard]] std::span<const double> weights() const noexcept { return weights_; }

    /// Bayes: multiplies by the likelihood of each cell and normalises. Which of two responses came
    /// first does not matter but for rounding.
    /// @throws std::invalid_argument if nothing is left: the response is impossible under every
    ///         cell that was believed in; the posterior is then as it was
    void update(std::span<const double> likelihood);

    /// -sum w log2 w, bits.
    [[nodiscard]] double entropy() const noexcept;
    /// The weights of axis k's values, all others summed out.
    [[nodiscard]] std::vector<double> marginal(const Grid& grid, std::size_t k) const;
    /// Mean of every parameter.
    [[nodiscard]] std::vector<double> mean(const Grid& grid) const;
    /// The cell of the largest weight, the first among those that reach it but for 1e-12 of it.
    [[nodiscard]] std::vector<double> mode(const Grid& grid) const;

private:
    std::vector<double> weights_;
};

/// What QUEST+ may show, what it estimates, and by which model.
struct QuestPlusSpec {
    OutcomeModel model;
    Grid stimuli{};
    Grid parameters{};
    std::vector<std::vector<double>> prior{};  ///< weights by axis of the parameters; or uniform
    std::vector<std::string> nuisance{};       ///< parameters whose uncertainty does not count
    std::size_t trials = 64;                   ///< then it ends; at least 1
    double entropy_bits = 0.0;                 ///< it ends below this posterior entropy, 0: never
};

/// QUEST+ (A. B. Watson, "QUEST+: A general multidimensional Bayesian adaptive psychometric
/// method", Journal of Vision 17(3):10, 2017): the next stimulus is the one after which the
/// posterior of the parameters is expected to have the least entropy.
///
/// Ties: first_of_least. The same responses give the same stimuli and the same posterior to the bit
/// on every IEEE-754 machine: only + - * /, sqrt and this project's own logarithm and exponential
/// are used, in a fixed order. There is no limit on the time of the search, since a limit would let
/// a slow machine choose otherwise; the size of the grid is limited instead (LikelihoodTable).
///
/// With one stimulus dimension and two outcomes it is the psi method (L. L. Kontsevich and C. W.
/// Tyler, "Bayesian adaptive estimation of psychometric slope and threshold", Vision Research 39,
/// 2729-2737, 1999), if the slope is on the grid by its decadic logarithm; with the lapse rate as a
/// nuisance psi-marginal (N. Prins, "The psi-marginal adaptive method", Journal of Vision 13(7):3,
/// 2013).
///
/// A plain value; copies share the table, which never changes.
class QuestPlus {
public:
    /// @throws std::invalid_argument as LikelihoodTable and Posterior, for a nuisance parameter
    ///         that is not there, or if nothing but nuisance is left, and for trials = 0
    explicit QuestPlus(const QuestPlusSpec& spec);

    /// The stimulus to show next. Takes some ms on a large grid: ask once a trial.
    [[nodiscard]] std::vector<double> next() const;
    /// @param shown    the stimulus that was shown, on the grid, recommended or not
    /// @param outcome  0 ... outcomes() - 1
    /// @throws std::invalid_argument if `shown` is not on the grid or the outcome not there or
    /// impossible
    void update(std::span<const double> shown, std::size_t outcome);

    /// As Procedure's.
    [[nodiscard]] bool finished() const noexcept;
    [[nodiscard]] std::size_t trials() const noexcept { return trials_; }
    [[nodiscard]] std::size_t outcomes() const noexcept { return table_->outcomes(); }
    [[nodiscard]] std::vector<std::string> stimulus_names() const;
    /// Of the parameters that have more than one value (of all, if none has).
    [[nodiscard]] std::vector<Estimate> estimates() const;
    /// The just-noticeable difference of a psychometric_model, half the way from where the curve F
    /// without guesses and lapses is 1/4 to where it is 3/4:
    ///
    ///   JND = (F^-1(3/4) - F^-1(1/4)) / 2    normal: 0.674 standard deviations; logistic: ln 3 / b
    ///
    /// on the stimulus' axis, by the posterior of threshold and slope. None of another model, and
    /// where the grid has a single threshold and slope.
    [[nodiscard]] std::optional<Estimate> jnd() const;
    [[nodiscard]] double entropy() const noexcept { return posterior_.entropy(); }
    [[nodiscard]] std::string state_hash() const;

    /// What is known of the parameters now, and the likelihoods that it is multiplied with.
    [[nodiscard]] const Posterior& posterior() const noexcept { return posterior_; }
    [[nodiscard]] const LikelihoodTable& table() const noexcept { return *table_; }
    /// Expected entropy after the next trial for every stimulus of the grid, bits.
    [[nodiscard]] std::vector<double> expected() const;

private:
    std::shared_ptr<const LikelihoodTable> table_;
    std::shared_ptr<const CellGroups> groups_;  ///< none: all parameters count
    std::optional<OutcomeModel::Shape> shape_;
    Posterior posterior_;
    std::size_t max_trials_;
    double entropy_bits_;
    std::size_t trials_ = 0;
};

}  // namespace palpate::protocols
