#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "data/choice/thurstone.hpp"
#include "data/statistics/distributions.hpp"

namespace palpate::data {

/// Luce's choice model with similarities: P(j | i) = bias_j similarity_ij / sum over k of the same.
struct SimilarityFit {
    std::vector<double> bias{};  ///< of each response; they sum to 1
    std::vector<std::vector<double>>
        similarity{};  ///< symmetric, 1 on the diagonal, 0: never confused
    double log_likelihood = 0.0;
    double deviance = 0.0;  ///< against free shares of each row
    std::int64_t df = 0;    ///< (m - 1)(m - 2) / 2
    /// Largest difference, answers, from the likelihood equations: what is left to gain.
    double residual = 0.0;
    /// 95 % of each similarity by profile likelihood: 0 below where none is too small (a pair that
    /// was never confused), infinite above where none is too large.
    std::vector<std::vector<Interval>> intervals{};
    /// Pairs whose similarity is 0 though they were confused, one way alone: the maximum is a
    /// limit, in which the biases on either side have no ratio.
    std::vector<std::pair<std::size_t, std::size_t>> one_way{};
    /// Items that confusions link, each in one group: biases have a ratio within a group alone.
    std::vector<std::vector<std::size_t>> groups{};
};

/// The similarity choice model (R. D. Luce, Handbook of Mathematical Psychology 1:103, 1963; J. E.
/// K. Smith, Percept. & Psychophys. 31:259, 1982), by maximum likelihood:
///
///     P(j | i) = bias_j similarity_ij / sum over k of bias_k similarity_ik
///
/// It is the model of quasi-symmetry of the table. The likelihood is concave in the logarithms:
/// Newton's steps end on its one maximum.
/// @param counts  items and responses are the same list
/// @throws std::invalid_argument: not square, or an item that was never called by its name
[[nodiscard]] SimilarityFit fit_similarity(const CallCounts& counts);

/// Mean similarity of two different items: 0 where none was confused, 1 where all look alike.
[[nodiscard]] double mean_similarity(const SimilarityFit& fit);

}  // namespace palpate::data
