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
///     from plug-in - (rows - 1)(columns - 1) / (2 N ln 2) - 1.96 e  to Miller and Madow's + 1.96 e
///
/// with e the jackknife's standard error. The bias of plug-in is that of all cells that may occur
/// (G. A. Miller, 1955), and these are not known: at the low end all are taken to, at the high end
/// those that did. Chosen by simulation, 50 and 100 trials of five shapes, 28 to 90 % right: it
/// holds the channel's bits in .93 to .99 of samples where errors name any shape, .96 to 1 where
/// they name a neighbour; with all cells at both ends .70 to .93 there, with those in use .73 to
/// .94 of the former. Two shapes have no cell that cannot occur, and few bits: .73 of samples at 55
/// % right, .90 to .93 from 70 % (50 trials). Beyond 90 % rare errors are not seen, and fewer are
/// held. Nothing for fewer than two trials.
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
