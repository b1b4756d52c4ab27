#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/procedure/procedure_state.hpp"
#include "data/analysis/left_out.hpp"
#include "data/csv/number_table.hpp"
#include "data/fit/bootstrap.hpp"
#include "data/plot/figure.hpp"
#include "data/statistics/paired.hpp"
#include "data/store/analysed.hpp"
#include "data/store/database.hpp"
#include "data/tables/table.hpp"

/// Fits of all curves of a file, and what is said of them.
namespace palpate::data {

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
