#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "protocols/procedure/grid.hpp"
#include "protocols/procedure/outcome_model.hpp"

namespace palpate::protocols {

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
