#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "data/statistics/distributions.hpp"
#include "data/statistics/information.hpp"

/// What the trials of one person say.
namespace palpate::data {

/// Information that answers transmit about shapes, bits.
struct Transmitted {
    Information bits{};
    /// Miller and Madow's, cut to 0 and the entropy of the shapes as `interval` is: what is shown
    /// and averaged.
    double corrected = 0.0;
    /// Plug-in of answers given to other trials: what a guesser shows. Nothing without
    /// permutations.
    std::optional<double> null_mean{};
    /// Share of these, the data's own counted as one, at least as high as the data's.
    std::optional<double> null_p{};
    std::optional<Interval> interval{};
};

/// Plug-in and Miller-Madow; the same answers dealt to the shapes anew, `permutations` times, with
/// PCG32 (seed, stream); and an interval of 95 %, cut to 0 and the entropy of the shapes:
///
///     plug-in - (rows - 1)(columns - 1) / (2 N ln 2)  -+  1.96 of the jackknife's standard errors
///
/// its upper end no less than Miller and Madow's estimate. The bias is that of all cells (G. A.
/// Miller, 1955), also those that did not occur: Miller and Madow's, of cells that occur, leaves
/// 0.1 to 0.2 bits too much at 50 trials of five shapes. Chosen by simulation, 50 and 100 trials of
/// five shapes, two kinds of confusions: it holds 0 to 1.8 bits in .90 to .99 of samples, 2.29 of
/// 2.32 in .75 to .86 (rare errors that were not seen); percentiles of a bootstrap hold them in .14
/// to .99, 1.96 errors about the jackknife's own estimate too. Nothing for fewer than two trials.
/// @param shapes, responses  of each trial, as numbers from 0
[[nodiscard]] Transmitted transmitted(std::span<const std::size_t> shapes,
                                      std::span<const std::size_t> responses,
                                      std::size_t permutations,
                                      std::uint64_t seed,
                                      std::uint64_t stream);

/// Area under the type 2 ROC: the chance that a right answer was given with more confidence than a
/// wrong one, ties half (S. J. Galvin, J. V. Podd, V. Drga, J. Whitmore, Psychon. Bull. Rev.
/// 10:843, 2003). 0.5: confidence says nothing. Nothing without a right or without a wrong answer.
[[nodiscard]] std::optional<double> type_2_area(std::span<const double> when_right,
                                                std::span<const double> when_wrong);

/// One trial of a regression on time.
struct Moment {
    double trial = 0.0;
    std::optional<double> since_break{};
    double value = 0.0;
};

/// What a regression on time says.
struct Trend {
    std::optional<double> trial{};        ///< change of the value a trial
    std::optional<double> since_break{};  ///< beside it, a trial since the last break
};

/// Least squares of value on trial and, where each trial has it and it is no line of the trial
/// number (one stretch without a break is), on since_break. Nothing for fewer trials than
/// coefficients + 1, or where trial never changes. A slope that over the spread of its trials
/// changes the value by less than 1e-12 of the largest value is rounding: 0.
[[nodiscard]] Trend trend(std::span<const Moment> moments);

}  // namespace palpate::data
