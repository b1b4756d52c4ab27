#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "data/inference/mixed_logit.hpp"
#include "data/inference/trials.hpp"
#include "data/statistics/distributions.hpp"
#include "data/statistics/information.hpp"
#include "data/statistics/paired.hpp"
#include "data/tables/table.hpp"

/// All statistics of a table of trials, and what is said of them.
namespace palpate::data {

// What the trials of one person say.

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

struct StatsOptions {
    std::vector<std::string> signals{};  ///< of yes/no: the shapes that ought to be called yes
    std::size_t alternatives = 0;        ///< pictures an answer was one of; 0: as the table has it
    std::size_t permutations = 999;      ///< of each person's answers; 0: none
    std::size_t simulations = 999;       ///< of the likelihood ratio's null; 0: none
    std::uint64_t seed = 1;
    int nodes = 15;                  ///< of the adaptive quadrature, a side
    double prior_scale = kJzsScale;  ///< r of the Bayes factor
};

/// One person under one friction.
struct PersonCell {
    std::int64_t n = 0;
    std::int64_t k = 0;  ///< answers that are right; of yes/no without signals: yes
    Interval wilson{};
    Interval clopper_pearson{};
    std::optional<double> d_prime{};
    std::optional<double> criterion{};  ///< of yes/no
    std::int64_t signals = 0;           ///< of yes/no: answers to these
    std::int64_t hits = 0;
    /// d' and criterion with the correction of the least answers that the person gave under a
    /// friction: what is compared.
    std::optional<double> alike_d_prime{};
    std::optional<double> alike_criterion{};
    std::optional<Transmitted> bits{};
    std::optional<double> log_rt{};  ///< mean of ln(s)
    std::optional<double> log_explore{};
    std::optional<double> confidence{};  ///< mean
};

struct PersonStats {
    std::string subject{};
    std::vector<PersonCell> cells{};  ///< a friction each
    std::optional<double> confidence_area{};
    /// Where confidence is a probability: its mean less the share of right answers, and the mean of
    /// (confidence - right)^2 (G. W. Brier, Mon. Weather Rev. 78:1, 1950).
    std::optional<double> overconfidence{};
    std::optional<double> brier{};
    Trend answers{};  ///< of answers as 0 and 1, a trial
    Trend log_rt{};
};

/// One number a person, against another that means nothing.
struct PeopleTest {
    std::vector<double> values{};  ///< of those who have it
    PeopleMean mean{};
    std::optional<PairedT> t{};
    SignFlip flip{};
    SignedRank rank{};
    std::optional<double> bayes{};  ///< BF10
};

/// What people have under each friction, and the differences within person.
struct Measure {
    std::string
        key{};  ///< "share", "d_prime", "criterion", "bits", "log_rt", "log_explore", "confidence"
    std::string title{};                                       ///< "share correct"
    std::vector<std::vector<std::optional<double>>> values{};  ///< by person, then friction
    std::vector<std::optional<PeopleMean>> means{};            ///< by friction
    std::vector<std::optional<PeopleTest>> effects{};          ///< by friction; of the first none
};

/// The mixed model of one friction and the first.
struct MixedStats {
    std::size_t friction = 0;
    std::size_t people = 0;
    MixedFit laplace{};
    MixedFit laplace_null{};       ///< without the effect
    MixedFit laplace_intercept{};  ///< people differ in one number alone
    MixedFit quadrature{};
    MixedFit quadrature_null{};
    std::optional<SimulatedNull> simulated{};
};

/// Answers given with one level of confidence.
struct ConfidenceLevel {
    double level = 0.0;
    std::int64_t n = 0;
    PeopleMean share{};  ///< of answers that are right, over those people who used the level
};

/// All statistics of one choice of trials.
struct StatsPart {
    std::size_t trials = 0;
    std::vector<PersonStats> people{};
    std::vector<Measure> measures{};
    std::vector<MixedStats> mixed{};
    std::vector<ConfidenceLevel> levels{};  ///< of no more than 12 different ones
    /// By key: "confidence_area" (against 0.5), "overconfidence", "share_per_trial",
    /// "share_since_break", "log_rt_per_trial", "log_rt_since_break" (against 0).
    std::vector<std::pair<std::string, PeopleTest>> tests{};
};

struct ExcludedTrials {
    std::string subject{};
    std::string why{};
    std::size_t trials = 0;
};

struct StatsReport {
    TrialTable table{};
    StatsOptions options{};
    bool yes_no = false;
    bool probability = false;  ///< all confidence lies from 0 to 1, and some between
    /// false: of yes/no without signals answers are yes or no, not right or wrong
    bool right_known = true;
    std::vector<ExcludedTrials> excluded{};
    StatsPart applied{};                     ///< without what is excluded
    std::optional<StatsPart> not_applied{};  ///< with it; nothing where nothing is
};

/// @throws std::invalid_argument with value and remedy: options that do not fit the table, or
/// nothing that counts
[[nodiscard]] StatsReport stats_of(TrialTable table, const StatsOptions& options);

/// Tables for people.
[[nodiscard]] std::string stats_text(const StatsReport& report);
/// The same for programs; what is not known is null.
[[nodiscard]] std::string stats_json(const StatsReport& report);
/// A script of R that computes the same from `trials` (trials_csv(), beside the script), with lme4
/// where it is installed: lines of a place in stats_json(), a tab, and the number.
[[nodiscard]] std::string stats_r(const StatsReport& report, const std::string& trials);

// -------------------------------------------------------------------------------------------------
// What palpate stats found, as tables: text, JSON and the report's page say these.

/// "on - off": a friction against the first.
[[nodiscard]] std::string comparison_text(const StatsReport& report, std::size_t friction);

/// The test that the protocol's `primary` names, a row a friction but the first: what text, JSON
/// and page say of it. Without rows where no protocol says which (a CSV's trials).
[[nodiscard]] Table primary_table(const StatsReport& report, const StatsPart& part);
/// Its name, with what its estimate is in.
[[nodiscard]] std::string primary_title(const StatsReport& report);
/// Of the mixed model by Laplace, without the effect and with it: chi-square of 1 df.
[[nodiscard]] double no_effect_p(const MixedStats& mixed);

/// Means over people, a row a measure and friction.
[[nodiscard]] Table means_table(const StatsReport& report, const StatsPart& part);
/// What friction changes within person, a row a measure and friction but the first.
[[nodiscard]] Table effects_table(const StatsReport& report, const StatsPart& part);
/// The mixed model of a friction, a row a method.
[[nodiscard]] Table mixed_table(const StatsReport& report, const MixedStats& mixed);
/// Confidence, time and rest within person, a row a number.
[[nodiscard]] Table within_table(const StatsReport& report, const StatsPart& part);

/// All of one choice of trials, in the order in which text says them.
[[nodiscard]] std::vector<Table> stats_tables(const StatsReport& report, const StatsPart& part);

// -------------------------------------------------------------------------------------------------
// How a report is made of its trials.

/// All statistics of the trials that `takes`. A person's permutations are drawn with a stream of
/// their own, which no other choice of trials changes.
[[nodiscard]] StatsPart part_of(const StatsReport& report,
                                const std::function<bool(const Trial&)>& takes);

/// Whether the answer is right; of yes/no without signals: whether it is yes.
[[nodiscard]] bool hit(const StatsReport& report, const Trial& trial);

/// Measures, and the tests of one number a person, from part.people.
void add_measures(const StatsReport& report, StatsPart& part);
void add_tests(const StatsReport& report, StatsPart& part);

/// A text over the tables, for all outputs: "share correct", "share of yes".
[[nodiscard]] std::string share_title(const StatsReport& report);

/// Who has no number of a measure under a friction, or under the first.
[[nodiscard]] std::vector<std::string> without_both(const StatsPart& part,
                                                    const Measure& measure,
                                                    std::size_t friction);

/// What a reader should know before a mixed model's numbers are believed.
[[nodiscard]] std::vector<std::string> warnings_of(const MixedStats& mixed);

}  // namespace palpate::data
