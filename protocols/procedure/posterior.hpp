#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "protocols/procedure/grid.hpp"

namespace palpate::protocols {

/// What is believed of the parameters: a weight for every cell of a grid; the weights add up to 1.
class Posterior {
public:
    /// Uniform over the cells.
    explicit Posterior(const Grid& grid);
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

    friend bool operator==(const Posterior&, const Posterior&) = default;

private:
    std::vector<double> weights_;
};

}  // namespace palpate::protocols
