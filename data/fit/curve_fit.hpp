#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "data/fit/curve_model.hpp"
#include "data/statistics/distributions.hpp"

/// Psychometric functions fitted by maximum likelihood, or MAP where the spec has priors.
namespace palpate::data {

// Maxima of a CurveModel by two methods that share nothing but the value.

/// Where a search ended.
struct Optimum {
    CurvePoint at{};
    double value = 0.0;
    bool settled = false;  ///< a further step would gain less than the tolerance
};

/// Fisher scoring from `start` with Levenberg's damping, inside the model's ends: a step that gains
/// nothing is made shorter, a parameter that would leave its range stays at the end.
/// @param free       which parameters move
/// @param tolerance  of the log-likelihood
[[nodiscard]] Optimum climb(const CurveModel& model,
                            const CurvePoint& start,
                            const CurveMask& free,
                            double tolerance = 1e-12);

[[nodiscard]] double dot(const CurvePoint& a, const CurvePoint& b);  ///< the sum of a[i] b[i]
[[nodiscard]] CurvePoint times(const CurveMatrix& matrix, const CurvePoint& vector);  ///< M v

/// A step of Fisher scoring.
struct DampedStep {
    CurvePoint gradient{};      ///< of what is free and would not leave its range; else 0
    CurveMatrix information{};  ///< damped, of all
    CurveMatrix inverse{};      ///< of these
    CurvePoint move{};

    DampedStep(const CurveModel& model,
               const CurvePoint& at,
               const CurvePoint& slopes,
               const CurveMatrix& curvature,
               const CurveMask& free,
               double damping);
};

/// How many starts the maximum is looked for from.
enum class Search : std::uint8_t {
    quick,    ///< slopes in factors of two; from the four best points
    thorough  ///< in factors of the root of two; from the two best of each slope
};

/// The highest maximum found.
struct Highest {
    Optimum best{};
    CurvePoint start{};  ///< the highest point of the grid from which it was reached
};

/// The highest of climb() from `near` and from the highest points of a grid, none of whose
/// neighbours at its slope is higher: locations from half of the levels' range below to half above,
/// in between all levels, and where the curve passes through the share of a level; slopes from 0.25
/// / range to the steepest; rates. What is not free stays as in `near`; where a JND or Weber
/// fraction is held, the slope follows from the location.
[[nodiscard]] Highest highest(const CurveModel& model,
                              const CurvePoint& near,
                              const CurveMask& free,
                              Search search,
                              double tolerance = 1e-12);

/// The simplex of J. A. Nelder, R. Mead, Computer J. 7:308, 1965, begun anew inside all ranges
/// where it ended until that gains less than 1e-9. Knows no derivative.
[[nodiscard]] Optimum nelder_mead(const CurveModel& model,
                                  const CurvePoint& start,
                                  const CurveMask& free);

/// The least of a loss between two places (both among them), which may have several dips: a grid
/// finds the deepest, and golden section its bottom, to 1e-10 of it.
[[nodiscard]] double least_between(const std::function<double(double)>& loss,
                                   double one,
                                   double other);

/// The inverse of the rows and columns of `used`; 0 elsewhere. All 0 if it is not positive
/// definite.
[[nodiscard]] CurveMatrix inverse(const CurveMatrix& matrix, const CurveMask& used);

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
