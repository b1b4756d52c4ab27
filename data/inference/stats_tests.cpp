#include <algorithm>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "data/inference/stats_report.hpp"
#include "data/statistics/distributions.hpp"

namespace palpate::data {
namespace {

/// In how many people two frictions have different numbers of answers.
std::size_t uneven_people(const StatsPart& part) {
    return static_cast<std::size_t>(std::ranges::count_if(part.people, [](const PersonStats& one) {
        std::int64_t first = 0;
        return std::ranges::any_of(one.cells, [&](const PersonCell& cell) {
            first = first == 0 ? cell.n : first;
            return cell.n > 0 && cell.n != first;
        });
    }));
}

/// @param slopes  the ratio of no spread of the effect
void add_method(Table& table,
                const Named& comparison,
                const Named& method,
                const MixedFit& fit,
                const MixedFit& null,
                const std::optional<SimulatedNull>& simulated,
                const std::optional<double>& slopes) {
    const char* why = "unbounded: a condition has answers of one kind alone";
    const auto ended = [&](bool unbounded, const std::optional<double>& value,
                           const char* reason = "") {
        return unbounded ? Cell(Nothing{reason}) : cell_of(value);
    };
    const double ratio = likelihood_ratio(fit, null);
    table.rows.push_back({comparison,
                          method,
                          ended(fit.intercept_unbounded, fit.intercept, why),
                          ended(fit.intercept_unbounded, fit.intercept_se),
                          ended(fit.unbounded, fit.effect, why),
                          ended(fit.unbounded, fit.effect_se),
                          ended(fit.intercept_unbounded, fit.sd_intercept),
                          ended(fit.unbounded, fit.sd_slope),
                          ended(fit.unbounded, fit.correlation),
                          cell_of(fit.log_likelihood),
                          cell_of(ratio),
                          std::int64_t{1},
                          chi_square_p(ratio, 1),
                          simulated ? Cell(simulated->p) : Cell(Nothing{}),
                          cell_of(slopes),
                          slopes ? Cell(slope_variance_p(*slopes)) : Cell(Nothing{}),
                          std::int64_t{fit.spec.nodes},
                          fit.singular,
                          fit.unbounded,
                          fit.converged});
}

/// A test of one number a person each: its name, people, mean, interval, t, df, p, dz, the p of
/// sign-flip and Wilcoxon, the Bayes factor. To these columns come `index` more in front.
Table tests_table(std::string place, std::string title, std::vector<Column> index) {
    Table table{.place = std::move(place),
                .title = std::move(title),
                .columns = std::move(index),
                .index = 0};
    table.index = table.columns.size();
    for (Column& column :
         heads({"people", "mean", "interval_95|interval", "t", "df|df|0", "t_p|t p|p", "dz|dz|2",
                "sign_flip_p|sign-flip p|p", "sign_flip_exact||-", "wilcoxon_v|Wilcoxon V|1",
                "wilcoxon_ranked|of|-", "wilcoxon_p|Wilcoxon p|p", "wilcoxon_exact||-",
                "bayes_factor_10|BF10", "left_out||-"})) {
        table.columns.push_back(std::move(column));
    }
    return table;
}

/// @param name  of the index
void add_test(Table& table, std::vector<Cell> name, const PeopleTest& test) {
    const char* none =
        test.values.size() < 2 ? "one person: nothing follows for others" : "all the same: no t";
    const auto of_t = [&](double PairedT::*member, const char* why) {
        return test.t ? cell_of((*test.t).*member) : Cell(Nothing{why});
    };
    std::vector<Cell>& row = table.rows.emplace_back(std::move(name));
    for (Cell cell :
         {cell_of(test.values.size()), cell_of(test.mean.mean), cell_of(test.mean.interval),
          of_t(&PairedT::t, none), of_t(&PairedT::df, ""), of_t(&PairedT::p, ""),
          of_t(&PairedT::dz, ""), Cell(test.flip.p), Cell(test.flip.exact), Cell(test.rank.v),
          cell_of(test.rank.ranked), Cell(test.rank.p), Cell(test.rank.exact), cell_of(test.bayes),
          Cell(std::vector<std::string>())}) {
        row.push_back(std::move(cell));
    }
    const auto say = [&](bool needed, const char* note) {
        if (needed && std::ranges::find(table.notes, note) == table.notes.end()) {
            table.notes.emplace_back(note);
        }
    };
    say(!test.flip.exact, "p of sign-flip: of patterns drawn by chance, not of all.");
    say(!test.rank.exact, "p of Wilcoxon: by the normal distribution.");
}

}  // namespace

std::string comparison_text(const StatsReport& report, std::size_t friction) {
    return fmt::format("{} - {}", report.table.frictions[friction], report.table.frictions[0]);
}

Table means_table(const StatsReport& report, const StatsPart& part) {
    Table table{.place = "measures/*/means/*",
                .title = "  Over people: means (Student's interval; of shares on the logit)",
                .columns = heads({"measure", "friction", "people", "mean", "interval_95|interval"}),
                .index = 2};
    for (const Measure& one : part.measures) {
        for (std::size_t f = 0; f < one.means.size(); ++f) {
            if (const auto& mean = one.means[f]) {
                table.rows.push_back({Named{one.key, one.title}, report.table.frictions[f],
                                      cell_of(mean->people), cell_of(mean->mean),
                                      cell_of(mean->interval)});
            }
        }
    }
    return table;
}

Table effects_table(const StatsReport& report, const StatsPart& part) {
    Table table = tests_table(
        "measures/*/effects/*",
        fmt::format("  What friction changes within person, against {}: paired t with its "
                    "interval; sign-flip: all patterns of\n  signs of up to 40 people; Wilcoxon: "
                    "exact, ties and all; "
                    "BF10: JZS, Cauchy prior of r = {:.4g} (Rouder et al. 2009; above 1\n  for an "
                    "effect, below for none)",
                    report.table.frictions.front(), report.options.prior_scale),
        heads({"measure", "comparison"}));
    for (const Measure& one : part.measures) {
        for (std::size_t f = 1; f < one.effects.size(); ++f) {
            const Named measure{one.key, one.title};
            const Named comparison{report.table.frictions[f], comparison_text(report, f)};
            if (!one.effects[f]) {
                if (one.means[f] && one.means[0]) {
                    table.notes.push_back(fmt::format("{}, {}: nobody has a number under both.",
                                                      one.title, comparison.shown));
                }
                continue;
            }
            add_test(table, {measure, comparison}, *one.effects[f]);
            auto gone = without_both(part, one, f);
            if (!gone.empty()) {
                table.notes.push_back(
                    fmt::format("{}, {}: without a number under both, left out: {}", one.title,
                                comparison.shown, fmt::join(gone, ", ")));
            }
            table.rows.back().back() = std::move(gone);
        }
    }
    if (const std::size_t uneven = uneven_people(part); uneven > 0 && !table.rows.empty()) {
        table.notes.push_back(fmt::format(
            "Of {} the frictions have different numbers of answers: d' is compared with the\n  "
            "correction of the least of them, which the table above has not; bits of fewer answers "
            "are\n  higher by chance alone.",
            counted(uneven, "person", "people")));
    }
    return table;
}

Table mixed_table(const StatsReport& report, const MixedStats& mixed) {
    const std::string& other = report.table.frictions[mixed.friction];
    Table table{
        .place = "mixed_model/*/*",
        .title = fmt::format("  Mixed model, second: logit {} ~ friction + (friction | subject), "
                             "{} against {}, {} people; adaptive Gauss-Hermite of {} x {} nodes",
                             report.right_known ? "right" : "yes", other, report.table.frictions[0],
                             mixed.people, report.options.nodes, report.options.nodes),
        .columns = heads({"comparison|",
                          "method| ",
                          "intercept|intercept|4",
                          "intercept_se|  se|4",
                          "effect||4",
                          "effect_se|  se|4",
                          "sd_intercept|sd of intercepts|4",
                          "sd_effect|sd of friction|4",
                          "correlation|their correlation|4-",
                          "log_likelihood|log-likelihood|4",
                          "no_effect/chi_square|no effect: ratio|4",
                          "no_effect/df||-",
                          "no_effect/p|  p|p",
                          "no_effect/simulated_p|  p by simulation|p",
                          "no_spread/chi_square|no spread of it: ratio|4-",
                          "no_spread/mixture_p|  p|p-",
                          "nodes||-",
                          "singular||-",
                          "unbounded||-",
                          "converged||-"}),
        .index = 2,
        .across = true};
    table.columns[4].words = "friction " + other;
    const Named comparison{other, comparison_text(report, mixed.friction)};
    add_method(table, comparison, {"laplace", "Laplace"}, mixed.laplace, mixed.laplace_null,
               mixed.simulated, likelihood_ratio(mixed.laplace, mixed.laplace_intercept));
    add_method(table, comparison, {"quadrature", "Gauss-Hermite"}, mixed.quadrature,
               mixed.quadrature_null, {}, {});
    table.notes.push_back(fmt::format(
        "No effect: both models keep the spread of friction's effect, so nothing lies on a "
        "boundary, and the ratio is\n  chi-square of 1 df for many people; for few it is larger by "
        "chance more often{}.\n  No spread: a variance on its boundary; half chi-square of 1 df, "
        "half of 2 (Self & Liang 1987, Stram & Lee 1994).",
        mixed.simulated ? fmt::format("; beside it stands the p of {} samples of the fitted null, "
                                      "and before it the tests within person",
                                      mixed.simulated->samples)
                        : ""));
    for (const std::string& warning : warnings_of(mixed)) {
        table.notes.push_back("WARNING: " + warning + ".");
    }
    return table;
}

Table within_table(const StatsReport& report, const StatsPart& part) {
    Table table = tests_table(
        "within_person/*",
        "  Within person, then over people: does confidence know (area under the type 2 ROC, 0.5: "
        "no), and what do\n  time and rest change (joint slopes of least squares on both, a trial: "
        "at the same rest, since the last\n  break at the same trial)",
        heads({"what"}));
    table.columns[2].digits = table.columns[3].digits = 5;  // slopes are small
    for (const auto& [key, test] : part.tests) {
        const std::string of = key.starts_with("share") ? share_title(report) : "ln rt";
        add_test(table,
                 {Named{key, key == "confidence_area"       ? "confidence, area"
                             : key == "overconfidence"      ? "confidence less share correct"
                             : key.ends_with("since_break") ? of + ", a trial since the last break"
                                                            : of + ", a main trial of the person"}},
                 test);
    }
    return table;
}

}  // namespace palpate::data
