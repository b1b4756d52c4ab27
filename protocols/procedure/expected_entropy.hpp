#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "protocols/procedure/grid.hpp"

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

/// Which combination of the wanted parameters each cell has.
struct CellGroups {
    std::vector<std::uint32_t> of;  ///< of every cell, below `count`
    std::size_t count = 0;
    std::size_t run = 1;  ///< cells run * i ... run * i + run - 1 share one, for every i
};

/// Groups of the cells that differ in nothing but `nuisance`.
/// @throws std::invalid_argument for a nuisance that is no axis, or if nothing else is left
[[nodiscard]] CellGroups groups_of(const Grid& parameters, std::span<const std::string> nuisance);

/// The same for the posterior of some parameters alone, the others (nuisance) summed out before the
/// entropy is taken (Prins 2013, "the psi-marginal adaptive method").
[[nodiscard]] std::vector<double> expected_marginal_entropies(const LikelihoodTable& table,
                                                              std::span<const double> weights,
                                                              const CellGroups& groups);

/// The tie rule: the first of the stimuli whose expected entropy is within 1e-12 bit (of the
/// entropy, where that is more than 1 bit) of the least. Symmetric problems have exact ties, which
/// rounding would break in a way of its own.
[[nodiscard]] std::size_t first_of_least(std::span<const double> entropies) noexcept;

}  // namespace palpate::protocols
