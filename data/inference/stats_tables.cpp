#include "data/inference/stats_tables.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "data/inference/power.hpp"
#include "data/statistics/distributions.hpp"

namespace palpate::data {
namespace {

std::optional<double> exponential(const std::optional<double>& log) {
    return log ? std::optional(std::exp(*log)) : std::nullopt;
}

Table people_table(const StatsReport& report, const StatsPart& part) {
    Table table{
        .place = "people/*/friction/*",
        .title = fmt::format(
            "  Person by person: {}, with intervals of this person's own trials; d' {};\n  bits: "
            "plug-in, Miller-Madow, mean of {} permutations (a guesser's), their p, interval;\n  "
            "seconds: geometric means; felt: from the first contact to done",
            share_title(report),
            report.yes_no
                ? "and criterion c with the log-linear correction (Hautus 1995)"
                : fmt::format("of {} alternatives, unbiased observer (n of n counts as n - 1/2)",
                              report.table.alternatives),
            report.options.permutations),
        .columns =
            heads({"person", "friction", "k", "n|of n", "share|", "wilson_95|Wilson",
                   "clopper_pearson_95|Clopper-Pearson", "d_prime|d'|2", "criterion|c|2",
                   "bits/plug_in|bits|2", "bits/miller_madow|MM|2", "bits/null_mean|null|2",
                   "bits/null_p|p|p", "bits/interval_95|interval|2", "log_rt|", "rt_s|rt s|2",
                   "log_explore|", "felt_s|felt s|2", "confidence|confidence|2"}),
        .index = 2};
    for (const PersonStats& person : part.people) {
        for (std::size_t f = 0; f < person.cells.size(); ++f) {
            const PersonCell& cell = person.cells[f];
            const Transmitted bits = cell.bits.value_or(Transmitted{});
            const auto of_bits = [&](Cell value) {
                return cell.bits ? std::move(value) : Cell(Nothing{});
            };
            table.rows.push_back(
                {person.subject, report.table.frictions[f], cell.k, cell.n,
                 cell_of(static_cast<double>(cell.k) / static_cast<double>(cell.n)), cell.wilson,
                 cell.clopper_pearson, cell_of(cell.d_prime), cell_of(cell.criterion),
                 of_bits(bits.bits.plug_in), of_bits(bits.corrected),
                 of_bits(cell_of(bits.null_mean)), of_bits(cell_of(bits.null_p)),
                 of_bits(cell_of(bits.interval)), cell_of(cell.log_rt),
                 cell_of(exponential(cell.log_rt)), cell_of(cell.log_explore),
                 cell_of(exponential(cell.log_explore)), cell_of(cell.confidence)});
        }
    }
    return table;
}

/// What a person has of all frictions together.
Table persons_table(const StatsPart& part) {
    Table table{.place = "people/*",
                .title =
                    "  Confidence, person by person: area under the type 2 ROC, mean less share "
                    "correct, Brier's score\n  (0: sure and right; 0.25: always .5)",
                .columns = heads({"person", "confidence_area|area", "overconfidence|over",
                                  "brier|Brier", "share_per_trial|", "share_since_break|",
                                  "log_rt_per_trial|", "log_rt_since_break|"})};
    bool any = false;
    std::vector<double> scores;
    for (const PersonStats& person : part.people) {
        any = any || person.confidence_area || person.brier;
        if (person.brier) {
            scores.push_back(*person.brier);
        }
        table.rows.push_back({person.subject, cell_of(person.confidence_area),
                              cell_of(person.overconfidence), cell_of(person.brier),
                              cell_of(person.answers.trial), cell_of(person.answers.since_break),
                              cell_of(person.log_rt.trial), cell_of(person.log_rt.since_break)});
    }
    if (!scores.empty()) {
        table.notes.push_back(
            fmt::format("Brier's score, mean: {:.3f}", mean_over_people(scores).mean));
    }
    if (!any) {
        table.columns[0].words.clear();
        table.title.clear();
    }
    return table;
}

/// JSON's alone: text and page name a measure in each of its rows.
Table titles_table(const StatsPart& part) {
    Table table{.place = "measures/*", .columns = heads({"measure|", "title|"})};
    for (const Measure& one : part.measures) {
        table.rows.push_back({one.key, one.title});
    }
    return table;
}

/// What the protocol stands or falls by, of one friction against the first.
std::vector<Cell> primary_row(const StatsReport& report, const StatsPart& part, std::size_t f) {
    using protocols::PrimaryTest;
    const Nothing none{"nothing can be said"};
    const auto share = std::ranges::find(part.measures, "share", &Measure::key);
    const auto mixed = std::ranges::find(part.mixed, f, &MixedStats::friction);
    const Named name{report.table.frictions[f], comparison_text(report, f)};
    if (report.table.primary == PrimaryTest::mixed && mixed != part.mixed.end()) {
        const double ratio = likelihood_ratio(mixed->laplace, mixed->laplace_null);
        return {
            name,
            mixed->laplace.unbounded ? Cell(Nothing{"unbounded"}) : cell_of(mixed->laplace.effect),
            Nothing{}, cell_of(ratio), chi_square_p(ratio, 1)};
    }
    if (report.table.primary == PrimaryTest::mixed || share == part.measures.end() ||
        !share->effects[f] || share->effects[f]->values.size() < 2) {
        return {name, none, none, Nothing{}, none};
    }
    const PeopleTest& test = *share->effects[f];
    const double p = report.table.primary == PrimaryTest::sign_flip   ? test.flip.p
                   : report.table.primary == PrimaryTest::signed_rank ? test.rank.p
                   : test.t                                           ? test.t->p
                                                                      : 1.0;
    return {name, cell_of(test.mean.mean), cell_of(test.mean.interval), Nothing{}, p};
}

Table primary_table(const StatsReport& report, const StatsPart& part) {
    Table table{.place = "primary/*",
                .columns = heads({"comparison", "estimate", "interval_95|interval",
                                  "chi_square|ratio", "p|p|p"})};
    if (!report.table.primary) {
        return table;
    }
    const bool logit = report.table.primary == protocols::PrimaryTest::mixed;
    table.title =
        fmt::format("  Primary test, as the protocol says: {}{}{}", title_of(*report.table.primary),
                    logit ? ", in logit" : "",
                    report.right_known ? "" : " (here of yes: nothing is right or wrong)");
    for (std::size_t f = 1; f < report.table.frictions.size(); ++f) {
        table.rows.push_back(primary_row(report, part, f));
    }
    return table;
}

Table confidence_table(const StatsPart& part) {
    Table table{
        .place = "confidence/-",
        .title = "  Confidence: share correct at each level, mean over the people who used it",
        .columns = heads({"level|level|2", "answers", "people", "share", "interval_95|interval"})};
    for (const ConfidenceLevel& one : part.levels) {
        table.rows.push_back({one.level, one.n, cell_of(one.share.people), cell_of(one.share.mean),
                              cell_of(one.share.interval)});
    }
    return table;
}

/// JSON's alone: text says it above the model.
Table models_table(const StatsReport& report, const StatsPart& part) {
    Table table{.place = "mixed_model/*",
                .columns = heads({"comparison|", "people|", "warnings|"})};
    for (const MixedStats& mixed : part.mixed) {
        table.rows.push_back(
            {report.table.frictions[mixed.friction], cell_of(mixed.people), warnings_of(mixed)});
    }
    return table;
}

}  // namespace

std::vector<Table> stats_tables(const StatsReport& report, const StatsPart& part) {
    std::vector<Table> all{primary_table(report, part), people_table(report, part),
                           persons_table(part),         titles_table(part),
                           means_table(report, part),   effects_table(report, part),
                           models_table(report, part)};
    for (const MixedStats& mixed : part.mixed) {
        all.push_back(mixed_table(report, mixed));
    }
    all.push_back(confidence_table(part));
    all.push_back(within_table(report, part));
    return all;
}

}  // namespace palpate::data
