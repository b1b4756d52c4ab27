#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/pcg32.hpp"
#include "protocols/procedure/procedure_state.hpp"
#include "data/analysis/left_out.hpp"
#include "data/csv/number_table.hpp"
#include "data/fit/curve_fit.hpp"
#include "data/plot/figure.hpp"
#include "data/statistics/paired.hpp"
#include "data/store/analysed.hpp"
#include "data/store/database.hpp"
#include "data/tables/table.hpp"

/// Fits of all curves of a file, and what is said of them.
namespace palpate::data {

// -------------------------------------------------------------------------------------------------
// What a fit would have been of other answers drawn from the fitted curve (parametric bootstrap).

/// Draws a binomial number by the inverse of its distribution: one uniform number, log2(n)
/// comparisons.
class Binomial {
public:
    /// @param n  a whole number, >= 0   @param p  0..1
    Binomial(double n, double p) {
        const auto count = static_cast<std::size_t>(n);
        const double mean = n * p;
        const double reach = 12.0 * std::sqrt(mean * (1.0 - p)) + 40.0;  // beyond: below 1e-30
        first_ = static_cast<std::size_t>(std::max(0.0, std::floor(mean - reach)));
        const std::size_t last = std::min(count, static_cast<std::size_t>(mean + reach) + 1);
        if (p <= 0.0 || p >= 1.0) {
            first_ = p <= 0.0 ? 0 : count;
            return;
        }
        // Terms over that of the mode, outward, so that none overflows.
        const auto mode = std::clamp(static_cast<std::size_t>(mean), first_, last);
        std::vector<double> terms(last - first_ + 1, 1.0);
        const double odds = p / (1.0 - p);
        for (std::size_t k = mode; k < last; ++k) {
            terms[k + 1 - first_] = terms[k - first_] * odds * static_cast<double>(count - k) /
                                    static_cast<double>(k + 1);
        }
        for (std::size_t k = mode; k > first_; --k) {
            terms[k - 1 - first_] = terms[k - first_] / odds * static_cast<double>(k) /
                                    static_cast<double>(count - k + 1);
        }
        double sum = 0.0;
        for (double& term : terms) {
            sum += term;
            term = sum;
        }
        for (double& term : terms) {
            term /= sum;
        }
        terms.back() = 1.0;
        cumulative_ = std::move(terms);
    }

    /// A number of successes; takes two numbers of the stream.
    [[nodiscard]] double draw(Pcg32& random) const {
        const double uniform = (static_cast<double>(random.next()) +
                                (static_cast<double>(random.next()) + 0.5) * 0x1p-32) *
                               0x1p-32;
        const auto at = std::ranges::lower_bound(cumulative_, uniform);
        return static_cast<double>(first_) + static_cast<double>(at - cumulative_.begin());
    }

private:
    std::size_t first_ = 0;
    std::vector<double> cumulative_{};  ///< none: it is always first_
};

/// Whether a curve of a bootstrap has an end.
enum class End : std::uint8_t {
    both,
    steep,  ///< no level lies on the rise: its slope is infinite, its JND 0
    /// Its threshold is beyond all levels by 20 times their range: infinite, and so is its JND.
    far_up,
    far_down,  ///< the same below them
};

/// Fits of answers drawn anew, n at each level as in the data, k binomial with the fitted chance.
/// The levels of an adaptive run are kept as they were, though other answers would have led to
/// others.
struct Bootstrap {
    /// The curve that they are drawn from: the fit, or, where rates are free and have no prior, the
    /// maximum with beta(2, 20) of these. Drawn from a rate of 0 nothing would vary that the rate
    /// can hide.
    CurvePoint from{};
    std::vector<CurvePoint> at{};
    std::vector<End> ends{};  ///< of each of these
    std::size_t steep = 0;    ///< of these
    std::size_t far = 0;      ///< up or down
    /// Share of fits, the data's own counted as one, with a deviance at least as high as the
    /// data's: goodness of fit by simulation (F. A. Wichmann, N. J. Hill, Percept. Psychophys.
    /// 63:1293, 2001).
    double deviance_p = 1.0;
};

/// @param stream  which sequence of PCG32; the same seed and stream give the same fits
[[nodiscard]] Bootstrap bootstrap(const CurveModel& model,
                                  const CurveFit& fit,
                                  std::size_t samples,
                                  std::uint64_t seed,
                                  std::uint64_t stream);

/// Whether a fitted curve has an end.
[[nodiscard]] End end_of(const CurveModel& model, const CurvePoint& at);

/// A quantity of all fits, infinite where it has no end: so that percentiles know on which side it
/// lies. A share that is never reached lies beyond all stimuli, a Weber fraction of a threshold
/// that is not above 0 too. NaN where there is none.
[[nodiscard]] std::vector<double> of_all(const CurveSpec& spec,
                                         const Bootstrap& samples,
                                         Quantity quantity,
                                         double share = 0.5);

/// The estimate less its bias, as the samples have it: of what they were drawn from they are off by
/// so much on the average, on the logarithm of what is above 0. A rate's may be below 0. Nothing
/// where more than 1 % of the samples have no such quantity, or slopes without end.
[[nodiscard]] std::optional<double> corrected(const CurveSpec& spec,
                                              const CurveFit& fit,
                                              const Bootstrap& samples,
                                              Quantity quantity,
                                              double share = 0.5);

/// 95 % bias-corrected percentiles (B. Efron, J. Am. Stat. Assoc. 82:171, 1987, without
/// acceleration): with z0 = probit(share of values below that of the curve they were drawn from,
/// half of equal ones), the values at Phi(2 z0 -+ 1.96). Values may be infinite, and so may ends.
/// Values that are NaN are left out; nothing where they are more than 1 %, for fewer than 40
/// others, or where z0 is not finite.
[[nodiscard]] std::optional<Interval> bootstrap_interval(std::vector<double> values, double from);

// -------------------------------------------------------------------------------------------------
// One lapse rate, or guess rate, of all conditions of a person, as F. A. Wichmann and N. J. Hill
// (Percept. Psychophys. 63:1293, 2001) advise: a person lapses as often in each, and guesses
// alike. What the other conditions say of it enters each curve's likelihood as their own highest
// for each rate, so that the maximum of each is that of all together, and a profile of one curve
// is that of the joint likelihood.

/// Gives each model what the others say of their one rate: CurveModel::share().
/// @param models  of one person, each with spec().shared_rate()
void share_rate(std::span<CurveModel> models);

/// bootstrap() of all of a person's conditions together: each sample is fitted with one rate.
/// @param models, fits  after share_rate()
/// @param streams  of each
[[nodiscard]] std::vector<Bootstrap> shared_bootstrap(std::span<const CurveModel> models,
                                                      std::span<const CurveFit> fits,
                                                      std::size_t samples,
                                                      std::uint64_t seed,
                                                      std::span<const std::uint64_t> streams);

/// equality_p() of two of these curves, the rate being one of all under both hypotheses.
/// @param models  all of the person's
[[nodiscard]] double shared_equality_p(std::span<const CurveModel> models,
                                       std::size_t one,
                                       const CurveFit& fit_one,
                                       std::size_t two,
                                       const CurveFit& fit_two,
                                       Quantity quantity);

/// The answers of one participant in one condition.
struct Answers {
    std::string participant{};  ///< empty: the file names nobody
    std::string condition{};
    std::vector<Level> levels{};
    /// Of the adaptive runs that chose the levels: what their rules believe at the end.
    std::vector<protocols::Estimate> believed{};
    std::uint64_t stream = 0;  ///< of its bootstrap: its own
};

/// Columns stimulus, n, k, and participant and condition if they are there; rows of one stimulus
/// add up. In the order in which they first come; streams by name, so that no order of rows is in
/// the numbers.
/// @throws CsvError with file, line and character: no such column, no number, a stimulus_fault(), k
/// outside 0 .. n, n above 1,000,000
[[nodiscard]] std::vector<Answers> read_answers(const RereadableText& text,
                                                protocols::Family family);

/// There is no graded stimulus to fit, but there are answers by a picture's name.
[[nodiscard]] bool answers_are_names(Database& database, const AnswerChoice& choice);

/// What a database has to fit.
struct StoredAnswers {
    std::string study{};
    std::vector<Answers> all{};
    /// Runs in the order of the protocol, frictions from the least: as in all tables.
    std::vector<std::string> conditions{};
    std::string stimulus{};                ///< what it is: "curvature in 1/m"
    std::vector<StudyVersion> versions{};  ///< where the file has several of a protocol
    LeftOut left_out{};
};

/// Of every participant and condition of a study the answers that count, main trials alone. Where a
/// rule chose the levels: the runs, by name, its stimulus, and how often the answer was 1 (two
/// intervals: the comparison); with yes-no on planned objects: their curvature in 1/m, by friction,
/// and how often yes. Sessions of a participant add up; what the rules believe stands beside them,
/// session by session. Without whom the protocol's rules leave out.
/// @throws std::invalid_argument if there are none, or of several studies: which there are; if
/// versions that are taken together do not have stimuli of one kind
[[nodiscard]] StoredAnswers stored_answers(Database& database, const AnswerChoice& choice);

struct FitOptions {
    CurveSpec spec{};
    std::optional<double> at{};    ///< a share whose stimulus is asked for
    std::size_t bootstrap = 2000;  ///< samples; 0: none
    std::uint64_t seed = 1;
    /// In their order, the first what others are compared with; those that are not named follow by
    /// name.
    std::vector<std::string> conditions{};
    std::string stimulus{};  ///< what it is, as stimulus_text() says; empty: a CSV's
};

/// One quantity of a curve.
struct FitEstimate {
    Quantity quantity = Quantity::threshold;
    double value = 0.0;  ///< NaN: there is none
    std::string why{};   ///< why there is none: "unbounded: ...", "not determined: 2 to 3"
    bool fixed = false;  ///< given, not fitted
    std::optional<double> se{};
    std::optional<Interval> profile{};
    std::optional<Interval> bootstrap{};
    std::optional<double> corrected{};  ///< the estimate less its bias by the bootstrap
};

struct FittedCurve {
    Answers answers{};
    CurveModel model;
    CurveFit fit{};
    Bootstrap samples{};
    std::vector<FitEstimate> estimates{};
};

/// Of one participant, a quantity of a condition less that of the first.
struct Difference {
    std::string participant{};
    std::string condition{};
    Quantity quantity = Quantity::threshold;  ///< or jnd
    double value = 0.0;      ///< NaN: one of the two is not determined, or unbounded
    bool determined = true;  ///< both are
    std::optional<Interval>
        interval{};  ///< bootstrap, both drawn apart; none where a curve has none
    double p = 1.0;  ///< equality_p
};

/// Answers that cannot be fitted.
struct NotFitted {
    std::string participant{};
    std::string condition{};
    std::string why{};
};

struct FitReport {
    std::string source{};
    FitOptions options{};
    std::vector<FittedCurve> curves{};
    std::vector<std::string> conditions{};
    std::vector<NotFitted> left_out{};
    std::vector<Difference> differences{};   ///< where there are two conditions or more
    std::vector<OverPeople> people{};        ///< where there are two people or more
    std::vector<StudyVersion> versions{};    ///< of a database with several of a protocol
    std::optional<LeftOut> file_left_out{};  ///< of a database
};

/// "P01, friction on"; empty for answers of nobody in no condition.
[[nodiscard]] std::string name_of(const std::string& participant, const std::string& condition);
/// The name, and why.
[[nodiscard]] std::string text_of(const NotFitted& one);

/// Answers that cannot be fitted are in `left_out` with why, and so may all be.
[[nodiscard]] FitReport fit_all(std::string source,
                                const std::vector<Answers>& all,
                                const FitOptions& options);

/// Tables for people.
[[nodiscard]] std::string fit_text(const FitReport& report);
/// The same for programs; what is not known is null, and why stands beside it.
[[nodiscard]] std::string fit_json(const FitReport& report);
/// A panel a participant: curves, shares, and the thresholds' profile intervals.
[[nodiscard]] Figure fit_figure(const FitReport& report);

// What the table for people and the JSON for programs say alike.

/// As protocol files and --family have it.
[[nodiscard]] std::string_view word_of(protocols::Family family);
/// "threshold", "slope b"; of at_share "stimulus at a share".
[[nodiscard]] std::string_view word_of(Quantity quantity);
/// "free", "0.02 (given)", "free, one for all conditions of a person".
[[nodiscard]] std::string guess_text(const CurveSpec& spec);
[[nodiscard]] std::string lapse_text(const CurveSpec& spec);
[[nodiscard]] std::int64_t answers_of(const FittedCurve& curve);
/// Half of the answers or more stand alone at their stimulus: then the deviance is of the fitted
/// chances alone.
[[nodiscard]] bool single_answers(const FittedCurve& curve);
inline constexpr std::string_view kNoGoodness =
    "no goodness of fit: the deviance of single answers says next to nothing of it; group them by "
    "stimulus";
/// What a reader should know before the numbers are believed.
[[nodiscard]] std::vector<std::string> warnings_of(const FitReport& report,
                                                   const FittedCurve& curve);

/// The quantities of a curve, a row each.
[[nodiscard]] Table estimates_table(const FitReport& report, const FittedCurve& curve);
/// Of each participant, what a condition has more than the first: a row a quantity.
[[nodiscard]] Table differences_table(const FitReport& report);

}  // namespace palpate::data
