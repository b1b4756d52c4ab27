#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "data/choice/thurstone.hpp"
#include "data/inference/trials.hpp"
#include "data/statistics/distributions.hpp"
#include "data/tables/table.hpp"

/// Which of several things was it: what identifications say of how well people tell things apart,
/// and of how they name them.
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

/// What may be asked of identifications.
struct IdentificationOptions {
    double lapse = 0.02;
    std::map<std::string, double> items{};  ///< values by name; a name that is a number is its own
    std::set<std::string> given{};  ///< of the items, those that somebody named: each must be there
};

/// Of one person, two conditions, by the fit of all: a change that is as good as none has a p near
/// 1. Numbers are there where both sigmas have ends; intervals and p always, and they agree: a p
/// below .05 is an interval without the ratio of 1, or the shift of 0.
struct ThurstoneChange {
    std::optional<double> ratio{};  ///< sigma of the condition over the first one's
    Interval ratio_interval{};      ///< 95 % by profile likelihood; 0 and infinite where open
    double ratio_p = 1.0;
    std::optional<double> shift{};
    Interval shift_interval{};  ///< the same
    double shift_p = 1.0;       ///< both by likelihood ratio, chi-square of 1 df
};

/// One person's answers, and what the models say of them.
struct IdentifiedPerson {
    std::string name{};
    std::vector<CallCounts> counts{};  ///< of each condition
    ThurstoneFit thurstone{};
    std::vector<ThurstoneChange> changes{};  ///< of each condition but the first
    /// Of each condition; nothing where an item was never called by its name: which, in
    /// no_similarity.
    std::vector<std::optional<SimilarityFit>> similarity{};
    std::vector<std::string> no_similarity{};
};

/// All people, and what they have in common.
struct IdentificationReport {
    TrialTable table{};
    IdentificationOptions options{};
    std::vector<std::string> names{};  ///< items that are responses too, by value
    std::vector<double> values{};
    std::vector<IdentifiedPerson> people{};
    std::vector<std::string> left_out{};  ///< who cannot be fitted, and why
    std::vector<OverPeople> over_people{};
};

/// The value of every item of a database that has one: the curvature of its object, 1/m. Versions
/// of a protocol that are taken together may differ in it: then it has none.
[[nodiscard]] std::map<std::string, double> item_values(Database& database,
                                                        const std::string& study);

/// Fits of every person's trials that count, a condition a friction.
/// @throws std::invalid_argument with value and remedy: an item without a value, answers of yes and
/// no, nobody to fit
[[nodiscard]] IdentificationReport identification_of(TrialTable table,
                                                     const IdentificationOptions& options);

/// Why a sigma has no estimate; empty where it has one.
[[nodiscard]] std::string why_unbounded(SigmaEnd end);

/// Tables for people, and the same for programs.
[[nodiscard]] std::string identification_text(const IdentificationReport& report);
[[nodiscard]] std::string identification_json(const IdentificationReport& report);

}  // namespace palpate::data
