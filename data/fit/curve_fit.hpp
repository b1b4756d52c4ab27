#pragma once

#include <cstdint>
#include <optional>

#include "data/fit/optimum.hpp"
#include "data/statistics/distributions.hpp"

/// Psychometric functions fitted by maximum likelihood, or MAP where the spec has priors.
namespace palpate::data {

/// What is said of a curve. x_q is the stimulus with F(x_q) = q.
enum class Quantity : std::uint8_t {
    /// x_.5: halfway from guesses to lapses; the point of subjective equality of a comparison.
    threshold,
    jnd,    ///< (x_.75 - x_.25) / 2: 0.6745 sd (normal), 1.0986 / b (logistic)
    weber,  ///< jnd / threshold
    slope,  ///< b of protocols::Family
    guess,
    lapse,
    at_share  ///< the stimulus at which P is a given share
};

/// The value of a quantity. NaN: there is none, a Weber fraction of a threshold <= 0 or of a
/// logarithmic axis, or a share that is never reached.
/// @param share  of Quantity::at_share: of answers, not of F
[[nodiscard]] double quantity_of(const CurveSpec& spec,
                                 const CurvePoint& point,
                                 Quantity quantity,
                                 double share = 0.5);

/// A maximum, and how it was found.
struct CurveFit {
    CurvePoint at{};
    double value = 0.0;           ///< CurveModel::value
    double deviance = 0.0;        ///< CurveModel::deviance
    std::int64_t parameters = 0;  ///< that were fitted
    /// Inverse of the expected information, as R's glm takes it. 0 for what is fixed, or at an end
    /// of its range.
    CurveMatrix covariance{};
    double second =
        0.0;  ///< the value that the other optimiser reached, from the same point of the grid
    bool agree = true;  ///< the two differ by less than 1e-6
    bool steep =
        false;  ///< the likelihood grows with the slope to no end: no level lies on the rise
    bool shallow = false;  ///< one share for all levels is as good: it does not grow
    bool far = false;      ///< the threshold left the levels by 20 times their range
    /// Of a steep curve without priors: all thresholds of the highest likelihood, on the axis. With
    /// the slope it tends to a step, which has the guess rate below its place, 1 - lapse above it,
    /// and on it any chance between. One place of two ends: what the threshold tends to; else it is
    /// not determined.
    std::optional<Interval> maxima{};
};

/// What Nelder-Mead, from the same point of the grid, says to the maximum of a search.
struct Checked {
    Optimum best{};       ///< the higher of both
    double second = 0.0;  ///< its own value
    bool agree = true;    ///< the two differ by less than 1e-6
};
[[nodiscard]] Checked checked_by_simplex(const CurveModel& model, const Highest& found);

/// The highest maximum that thorough Search finds by Fisher scoring, and Nelder-Mead's from the
/// same point of the grid; where that is higher it is taken, and `agree` is false.
[[nodiscard]] CurveFit fit_curve(const CurveModel& model);

/// Standard error by the delta method; nothing where the covariance says nothing.
[[nodiscard]] std::optional<double> standard_error(const CurveSpec& spec,
                                                   const CurveFit& fit,
                                                   Quantity quantity,
                                                   double share = 0.5);

/// 95 % interval of all values whose best fit is worse by less than 3.8415 / 2 of log-likelihood
/// (chi-square of one degree of freedom; W. Q. Meeker, L. A. Escobar, Am. Stat. 49:48, 1995),
/// priors included. An end that the data do not bound is infinite, or that of the range. Of a
/// threshold with `maxima` it holds every step that is not refuted. Nothing for what is fixed or
/// has no value, and for at_share with free rates.
[[nodiscard]] std::optional<Interval> profile_interval(const CurveModel& model,
                                                       const CurveFit& fit,
                                                       Quantity quantity,
                                                       double share = 0.5);

/// The p of equal thresholds or JNDs of two curves with all else their own: 2 x the loss of
/// log-likelihood is chi-square of one degree of freedom. Equal JNDs are equal slopes b, but of a
/// weibull, whose JND grows with the threshold too.
/// @param quantity  threshold or jnd
[[nodiscard]] double equality_p(const CurveModel& one,
                                const CurveFit& fit_one,
                                const CurveModel& two,
                                const CurveFit& fit_two,
                                Quantity quantity);

}  // namespace palpate::data
