#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "protocols/procedure/outcome_model.hpp"

namespace palpate::protocols {

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

    friend bool operator==(const Grid&, const Grid&) = default;

private:
    std::vector<Axis> axes_;
    std::vector<std::size_t> strides_;
    std::size_t size_ = 0;
};

/// More cells than a participant could wait for.
inline constexpr std::size_t kMaxCells = 10'000'000;

/// "from" to "to" in `count` equal steps, the ends exact. @pre count >= 1
[[nodiscard]] std::vector<double> evenly(double from, double to, std::size_t count);

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
