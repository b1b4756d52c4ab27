#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/psychometric/psychometric_function.hpp"

/// The psychometric function of QUEST+ (Watson 2017): for a stimulus x and parameters s, the
/// chances of all outcomes. Any number of stimulus dimensions, parameters and outcomes.
namespace palpate::protocols {

/// What the parameter of steepness in a model's grid means; its name says it.
enum class SlopeAs : std::uint8_t {
    slope,        ///< b of Family
    log10_slope,  ///< log10 b, as Kontsevich & Tyler 1999 space it
    sd            ///< 1 / b: the standard deviation of the family "normal"
};
inline constexpr std::array<std::string_view, 3> kSlopeWords{"slope", "log10_slope", "sd"};

/// P(outcome | x, s): how an answer depends on the stimulus and on the parameters to estimate.
struct OutcomeModel {
    std::vector<std::string> stimulus;    ///< names of the dimensions of x, in order
    std::vector<std::string> parameters;  ///< names of s, in order
    std::size_t outcomes = 2;             ///< 0 ... outcomes - 1
    /// Writes the chances of all outcomes at x for s: `outcomes` numbers that add up to 1.
    /// @throws std::invalid_argument if s is out of its range
    std::function<void(
        std::span<const double> x, std::span<const double> s, std::span<double> chances)>
        chances{};
    /// Of a psychometric_model.
    struct Shape {
        Family family = Family::normal;
        LapseForm form = LapseForm::upper;
        SlopeAs slope_as = SlopeAs::slope;
    };
    std::optional<Shape> shape{};
    std::string same{};  ///< models that have the same one give the same chances; empty: none does
};

/// A yes/no or correct/wrong answer: outcome 1 with the chance of a psychometric function of
/// (threshold, slope, guess, lapse); with the two-sided form (threshold, slope, lapse). Stimulus:
/// one dimension, "stimulus".
[[nodiscard]] OutcomeModel psychometric_model(Family family,
                                              LapseForm form,
                                              SlopeAs slope_as = SlopeAs::slope);

/// b of Family for a value of the parameter of steepness.
[[nodiscard]] double slope_of(SlopeAs as, double value);

/// As psychometric_model, with a threshold that depends on a second stimulus dimension, "covariate"
/// (such as a friction coefficient): threshold + tilt * covariate. Parameters (threshold, tilt,
/// ...).
[[nodiscard]] OutcomeModel covariate_model(Family family,
                                           LapseForm form,
                                           SlopeAs slope_as = SlopeAs::slope);

/// Which of m known items was it? The percept of x is x + bias + noise * N(0, 1); the observer
/// names the item whose value is nearest (criteria midway between neighbours), and with the chance
/// `lapse` any of the m at random:
///
///     P(j | x) = lapse / m + (1 - lapse) (Phi(z_j) - Phi(z_(j-1))),  z_j = (c_j - x - b) / noise
///
/// with c_j = (v_j + v_(j+1)) / 2 between and infinite outside. Stimulus: one dimension,
/// "stimulus"; parameters (noise, bias, lapse). An ideal observer of an identification experiment;
/// Thurstone's law of categorical judgement with fixed criteria.
/// @param alternatives  v, increasing, at least 2
/// @throws std::invalid_argument for other alternatives
[[nodiscard]] OutcomeModel identification_model(const std::vector<double>& alternatives);

/// One dimension of a grid: the values that a stimulus or a parameter can take.
struct Axis {
    std::string name;
    std::vector<double> values;  ///< finite, strictly increasing, at least one

    friend bool operator==(const Axis&, const Axis&) = default;
};

/// The product of its axes. Cells are numbered with the last axis running fastest.
class Grid {
public:
    Grid() = default;
    /// @throws std::invalid_argument without axes, for a name that comes twice, for values that do
    ///         not increase, or for more than kMaxCells cells
    explicit Grid(std::vector<Axis> axes);

    /// Axes, and cells: the product of the axes' lengths.
    [[nodiscard]] std::size_t dimensions() const noexcept { return axes_.size(); }
    [[nodiscard]] std::size_t size() const noexcept { return size_; }
    /// @throws std::out_of_range for k >= dimensions()
    [[nodiscard]] const Axis& axis(std::size_t k) const { return axes_.at(k); }
    [[nodiscard]] std::span<const Axis> axes() const noexcept { return axes_; }
    /// Which value of axis k cell `cell` has. @pre cell < size()
    [[nodiscard]] std::size_t index(std::size_t cell, std::size_t k) const noexcept {
        return cell / strides_[k] % axes_[k].values.size();
    }
    /// Coordinates of a cell. @pre cell < size()
    [[nodiscard]] std::vector<double> point(std::size_t cell) const;
    /// The cell at a point; a coordinate may be off by 1e-9 of its axis' range or size, as decimals
    /// are.
    /// @throws std::invalid_argument if the point has other dimensions or is not on the grid
    [[nodiscard]] std::size_t cell_at(std::span<const double> point) const;

private:
    std::vector<Axis> axes_;
    std::vector<std::size_t> strides_;
    std::size_t size_ = 0;
};

/// More cells than a participant could wait for.
inline constexpr std::size_t kMaxCells = 10'000'000;

/// "from" to "to" in `count` equal steps, the ends exact. @pre count >= 1
[[nodiscard]] std::vector<double> evenly(double from, double to, std::size_t count);

/// `x`, added up of numbers of that size, to twelve digits of it: what additions leave in the last
/// bits would make two levels of one. @param size  > 0
[[nodiscard]] double twelve_digits(double x, double size);

/// The chances of every outcome at every stimulus of a grid for every cell of a parameter grid, and
/// the entropy of the outcome there. Computed once; what a trial reads of it lies in a row.
///
/// Memory: 8 bytes * stimuli * cells * (outcomes + 1). 40 stimuli, 20,000 cells, 2 outcomes: 19.2
/// MB.
class LikelihoodTable {
public:
    /// @throws std::invalid_argument if the grids do not have the model's dimensions by name and
    ///         order, if the model gives no chances that add up to 1, or if the table needs more
    ///         than kMaxBytes
    LikelihoodTable(const OutcomeModel& model, Grid stimuli, Grid parameters);

    /// What it was made of; `outcomes` is the model's.
    [[nodiscard]] const Grid& stimuli() const noexcept { return stimuli_; }
    [[nodiscard]] const Grid& parameters() const noexcept { return parameters_; }
    [[nodiscard]] std::size_t outcomes() const noexcept { return outcomes_; }
    /// Of a table, not yet made.
    [[nodiscard]] static double megabytes(const OutcomeModel& model,
                                          const Grid& stimuli,
                                          const Grid& parameters) noexcept;

    /// P(outcome | stimulus, cell) for all cells.
    [[nodiscard]] std::span<const double> chances(std::size_t stimulus,
                                                  std::size_t outcome) const noexcept {
        return row(stimulus * (outcomes_ + 1) + outcome);
    }
    /// -sum_r P(r | stimulus, cell) log2 P(r | stimulus, cell) for all cells, bits.
    [[nodiscard]] std::span<const double> outcome_entropy(std::size_t stimulus) const noexcept {
        return row(stimulus * (outcomes_ + 1) + outcomes_);
    }

private:
    [[nodiscard]] std::span<const double> row(std::size_t i) const noexcept {
        return std::span(values_).subspan(i * parameters_.size(), parameters_.size());
    }
    void fill(const OutcomeModel& model);

    Grid stimuli_;
    Grid parameters_;
    std::size_t outcomes_;
    std::vector<double> values_;
};

/// Half a gigabyte: choosing reads all of it, in some 50 ms, which a participant does not notice.
inline constexpr std::size_t kMaxBytes = std::size_t{512} << 20U;

}  // namespace palpate::protocols
