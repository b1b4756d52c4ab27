#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "protocols/psychometric/psychometric_function.hpp"
#include "data/statistics/distributions.hpp"

/// Psychometric functions fitted by maximum likelihood, or MAP where the spec has priors.
namespace palpate::data {

// -------------------------------------------------------------------------------------------------
// A psychometric function and the answers it is fitted to: log-likelihood, its gradient and
// information.

/// How often a stimulus was answered with 1 (yes, correct, the comparison).
struct Level {
    double stimulus = 0.0;
    std::int64_t n = 0;
    std::int64_t k = 0;
};

/// What is believed before the answers: the density of a parameter, which MAP adds to the
/// likelihood. Densities are taken on the scale that is fitted (the location, ln b, the rates
/// themselves): that scale is where the maximum is.
struct Prior {
    double first = 0.0;  ///< mean of the threshold; median of the slope b; alpha of a rate's beta
    /// sd of the threshold (of its natural logarithm: weibull); sd of ln b; beta of a rate's beta.
    double second = 1.0;
};

/// What is fitted. The function is that of protocols::PsychometricFunction with the lapses of
/// LapseForm::upper,
///
///     P(x) = guess + (1 - guess - lapse) F(x)
///
/// and F of protocols::Family: a Weibull is 1 - exp(-(x / t)^b).
struct CurveSpec {
    protocols::Family family = protocols::Family::normal;
    double guess = 0.0;         ///< where it is fixed, 0 .. 0.7
    double lapse = 0.0;         ///< where it is fixed, 0 .. 0.25
    bool guess_free = false;    ///< between 0 and 0.7
    bool lapse_free = false;    ///< between 0 and 0.25
    bool lapse_shared = false;  ///< free, one for all conditions of a person
    bool guess_shared = false;  ///< the same of the guess rate; never both
    bool two_sided = false;     ///< the guess rate is the lapse rate: LapseForm::two_sided
    std::optional<Prior>
        threshold_prior{};  ///< normal, of the threshold at F = 1/2; lognormal for a weibull
    std::optional<Prior> slope_prior{};  ///< lognormal, of b
    std::optional<Prior> guess_prior{};  ///< beta
    std::optional<Prior> lapse_prior{};  ///< beta

    /// The place in CurvePoint of the rate that is one for all conditions of a person; 0: none is.
    [[nodiscard]] std::size_t shared_rate() const {
        return guess_shared ? 2 : lapse_shared ? 3 : 0;
    }
    [[nodiscard]] bool map() const {
        return threshold_prior || slope_prior || guess_prior || lapse_prior;
    }
};

/// @throws std::invalid_argument with value and remedy for rates or priors out of their ranges
void check(const CurveSpec& spec);

inline constexpr double kMaxGuess = 0.7;
inline constexpr double kMaxLapse = 0.25;

inline constexpr std::size_t kCurveParameters = 4;
/// (location, ln b, guess, lapse). The location is where F = 1/2, on the axis on which the family
/// is b (x - t): ln x for weibull, x for all others. b is per unit of that axis, so that of
/// weibull_log10 is ln 10 times Family's.
using CurvePoint = std::array<double, kCurveParameters>;
using CurveMask = std::array<bool, kCurveParameters>;
using CurveMatrix = std::array<CurvePoint, kCurveParameters>;

/// Core in its own unit: F, 1 - F and dF/du at u.
struct CoreValue {
    double below = 0.0;
    double above = 1.0;
    double density = 0.0;
};
/// @param u  any number; at +-infinity the limits
[[nodiscard]] CoreValue core_value(protocols::Family family, double u) noexcept;
/// The u of F = share. @pre 0 < share < 1
[[nodiscard]] double core_quantile(protocols::Family family, double share) noexcept;

/// x on the axis of CurvePoint's location, and back. -infinity for a weibull at 0.
[[nodiscard]] double on_axis(protocols::Family family, double stimulus) noexcept;
[[nodiscard]] double off_axis(protocols::Family family, double location) noexcept;
/// b of the axis over b of Family: 1, ln 10 (weibull_log10), ln 10 / 20 (weibull_db).
[[nodiscard]] double slope_factor(protocols::Family family) noexcept;

/// Where a quantity is held, the location follows from it and the slope: how, and how fast.
struct Tied {
    double location = 0.0;
    double by_log_slope = 0.0;  ///< d location / d ln b
};

/// A quantity that a profile holds fixed in place of the location.
struct Tie {
    enum class Kind : std::uint8_t { none, jnd, weber, share } kind = Kind::none;
    double value =
        0.0;  ///< ln JND (weibull); ln of the Weber fraction (others); the place on the axis
    double share = 0.5;  ///< of F, for Kind::share
};

/// The log-likelihood of other answers for each lapse or guess rate that is one with theirs: cubics
/// through values and slopes, over the logarithm of the rate.
class SharedRate {
public:
    /// @param places  logarithms of rates, rising, two or more
    explicit SharedRate(const std::vector<double>& places)
        : places_(places), values_(places.size(), 0.0), slopes_(places.size(), 0.0) {}

    /// More answers at a place: their log-likelihood, and its slope there.
    void add(std::size_t i, double value, double slope) {
        values_[i] += value;
        slopes_[i] += slope;
    }

    struct At {
        double value = 0.0;
        double slope = 0.0;
        double curvature = 0.0;
    };
    /// @param rate  between its ends
    [[nodiscard]] At at(double rate) const;

private:
    std::vector<double> places_;
    std::vector<double> values_;
    std::vector<double> slopes_;
};

/// What to do about a stimulus that no curve takes: not finite, beyond 1e100, below 0 for a
/// weibull. Empty for all others.
[[nodiscard]] std::string stimulus_fault(double stimulus, protocols::Family family);

/// The answers as numbers, and what they say of a point.
class CurveModel {
public:
    /// @throws std::invalid_argument with value and remedy: no level with answers, fewer than two
    ///         different levels, k outside 0 .. n, a stimulus_fault(), two within 1e-100, rates or
    ///         priors out of range
    CurveModel(std::span<const Level> levels, const CurveSpec& spec);

    /// As it was given; and how many different levels there are.
    [[nodiscard]] const CurveSpec& spec() const { return spec_; }
    [[nodiscard]] std::size_t levels() const { return z_.size(); }
    /// Places on the axis, rising (-infinity first for a weibull at 0), answers and 1s there.
    [[nodiscard]] std::span<const double> places() const { return z_; }
    [[nodiscard]] std::span<const double> counts() const { return n_; }
    [[nodiscard]] std::span<const double> hits() const { return k_; }
    void set_hits(std::span<const double> hits) { k_.assign(hits.begin(), hits.end()); }
    /// spec().shared_rate() is one with that of others; nothing: it is not.
    void share(std::shared_ptr<const SharedRate> others) { others_ = std::move(others); }
    void tie(const Tie& tie);
    [[nodiscard]] Tie::Kind tied_by() const { return tie_.kind; }
    /// The ln b at which a JND or Weber fraction that is held has the location there, to 1e-6
    /// between the ends.
    [[nodiscard]] double log_slope_at(double location) const;
    void set_rate_priors(const std::optional<Prior>& guess, const std::optional<Prior>& lapse) {
        spec_.guess_prior = guess;
        spec_.lapse_prior = lapse;
    }

    /// The log-likelihood (without the binomial coefficients, which no parameter changes) and the
    /// log of the priors' densities, but for constants.
    [[nodiscard]] double value(const CurvePoint& point) const;
    /// value() with its gradient and the expected (Fisher) information, priors included.
    double derivatives(const CurvePoint& point,
                       CurvePoint& gradient,
                       CurveMatrix& information) const;
    /// Chances of a 1 at all levels.
    void chances(const CurvePoint& point, std::span<double> p) const;
    /// 2 (log-likelihood of the shares themselves - that of the point); priors do not enter.
    [[nodiscard]] double deviance(const CurvePoint& point) const;
    /// deviance() of one chance for all levels, the best between the given rates.
    [[nodiscard]] double flat_deviance() const;

    /// What is fitted, and between which ends.
    [[nodiscard]] CurveMask free() const;
    [[nodiscard]] const CurvePoint& low() const { return low_; }
    [[nodiscard]] const CurvePoint& high() const { return high_; }
    /// Between the outermost levels, on the axis; and the narrowest gap.
    [[nodiscard]] double first() const { return first_; }
    [[nodiscard]] double last() const { return last_; }
    /// Where a search begins: the middle of the levels, a rise over all of them, rates as given.
    [[nodiscard]] CurvePoint middle() const;

    /// The point with its location as tied, and its guess rate as two_sided has it.
    [[nodiscard]] CurvePoint whole(CurvePoint point) const;

private:
    /// The log-likelihood of the shares themselves.
    [[nodiscard]] double saturated() const;
    [[nodiscard]] Tied tied(const CurvePoint& point) const;
    [[nodiscard]] double prior(const CurvePoint& point,
                               CurvePoint* gradient,
                               CurveMatrix* information) const;

    CurveSpec spec_;
    std::shared_ptr<const SharedRate> others_{};
    std::vector<double> z_;
    std::vector<double> n_;
    std::vector<double> k_;
    CurvePoint low_{};
    CurvePoint high_{};
    double first_ = 0.0;
    double last_ = 0.0;
    double half_ = 0.0;    ///< u of F = 1/2
    double upper_ = 0.0;   ///< u of F = 3/4 less half_
    double lower_ = 0.0;   ///< of F = 1/4
    double shared_ = 0.0;  ///< of the share that is tied
    Tie tie_{};
};

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
