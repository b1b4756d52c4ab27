#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "data/inference/power.hpp"
#include "data/inference/stats_parts.hpp"

namespace palpate::data {
namespace {

std::string number_or_dash(const std::optional<double>& value, int digits = 3) {
    const double least = 0.5 * std::pow(10.0, -digits);  // below it -0.00 would stand there
    return value ? fmt::format("{:.{}f}", std::fabs(*value) < least ? 0.0 : *value, digits)
                 : std::string("-");
}

std::string three(double value) {
    return number_or_dash(value, 3);
}

std::string ends_text(const std::optional<Interval>& interval) {
    return interval ? three(interval->low) + " to " + three(interval->high)
                    : std::string("no interval");
}

std::string small_p(double p) {
    return p < 0.001 ? std::string("p < 0.001") : fmt::format("p = {:.3f}", p);
}

std::string trimmed_line(const std::string& line) {
    return line.substr(0, line.find_last_not_of(' ') + 1) + '\n';
}

std::string title_text(const StatsReport& report) {
    const TrialTable& table = report.table;
    std::string text = table.source;
    if (!table.study.empty()) {
        text += text == "study " + table.study ? "" : ": study " + table.study;
        text += fmt::format(", {} data", table.kind);
        text += table.kind == "simulated" ? ": participant and device are SIMULATED"
              : table.kind == "pilot"     ? ": PILOT, not for analysis"
                                          : "";
    }
    if (report.yes_no) {
        text += "\n  Answers are yes and no; ";
        text += report.right_known
                  ? fmt::format("yes is right for {}", fmt::join(report.options.signals, ", "))
                  : "none is right or wrong: --signal SHAPE says for which yes is right";
    } else {
        text += fmt::format("\n  Answers name one of {} shapes: chance is {:.3f}",
                            table.alternatives, 1.0 / static_cast<double>(table.alternatives));
    }
    return text +
           fmt::format(
               ".\n  Intervals are of 95 %. Nothing here pools the trials of several people: "
               "the person is the unit. Seed {}.\n",
               report.options.seed);
}

std::string excluded_text(const StatsReport& report) {
    const auto& account = report.table.left_out;
    std::string text = account ? left_out_text(*account) : std::string();
    if (report.excluded.empty()) {
        return text + (account ? "  Rules and marks leave nothing out: with and without these it "
                                 "is the same.\n"
                               : "  Nothing is excluded: with and without exclusions it is the "
                                 "same.\n");
    }
    text += "  Excluded, and below left out first, then left in:\n";
    for (const ExcludedTrials& one : report.excluded) {
        text += fmt::format("    {}  {}: {}\n", one.subject, counted(one.trials, "trial"), one.why);
    }
    return text;
}

std::string bits_text(const std::optional<Transmitted>& bits) {
    const auto known = [](const std::optional<double>& value, int digits) {
        return value ? fmt::format("{:.{}f}", *value, digits) : std::string("-");
    };
    return bits ? fmt::format("{:.2f} {:>5.2f} {:>5}  {:>5}  {:<13}", bits->bits.plug_in,
                              bits->corrected, known(bits->null_mean, 2), known(bits->null_p, 3),
                              bits->interval ? fmt::format("{:.2f} to {:.2f}", bits->interval->low,
                                                           bits->interval->high)
                                             : "-")
                : fmt::format("{:<35}", "-");
}

std::string cells_text(const StatsReport& report, const StatsPart& part) {
    std::size_t who = 6;
    std::size_t what = 8;
    for (const PersonStats& person : part.people) {
        who = std::max(who, person.subject.size());
    }
    for (const std::string& friction : report.table.frictions) {
        what = std::max(what, friction.size());
    }
    std::string text = fmt::format(
        "\n  Person by person: {}, with intervals of this person's own trials; d' {};\n  bits: "
        "plug-in, Miller-Madow, mean of {} permutations (a guesser's), their p, "
        "interval; seconds: geometric means; felt: from the first contact to done\n",
        share_title(report),
        report.yes_no ? "and criterion c with the log-linear correction (Hautus 1995)"
                      : fmt::format("of {} alternatives, unbiased observer (n of n counts as n - "
                                    "1/2)",
                                    report.table.alternatives),
        report.options.permutations);
    text += trimmed_line(
        fmt::format("  {:<{}}  {:<{}}  {:<10}  {:<14}  {:<15}  {:>6}{}  {:<35}  {:>6}  {:>7}  {}",
                    "person", who, "friction", what, "k of n", "Wilson", "Clopper-Pearson", "d'",
                    report.yes_no ? "       c" : "", "bits   MM  null  p      interval", "rt s",
                    "felt s", "confidence"));
    const auto seconds = [](const std::optional<double>& log) {
        return log ? fmt::format("{:.2f}", std::exp(*log)) : std::string("-");
    };
    for (const PersonStats& person : part.people) {
        for (std::size_t f = 0; f < person.cells.size(); ++f) {
            const PersonCell& cell = person.cells[f];
            text += trimmed_line(fmt::format(
                "  {:<{}}  {:<{}}  {:<10}  {:<14}  {:<15}  {:>6}{}  {:<35}  {:>6}  {:>7}  {}",
                person.subject, who, report.table.frictions[f], what,
                fmt::format("{} of {}", cell.k, cell.n),
                fmt::format("{:.3f} to {:.3f}", cell.wilson.low, cell.wilson.high),
                fmt::format("{:.3f} to {:.3f}", cell.clopper_pearson.low,
                            cell.clopper_pearson.high),
                number_or_dash(cell.d_prime, 2),
                report.yes_no ? fmt::format("  {:>6}", number_or_dash(cell.criterion, 2)) : "",
                bits_text(cell.bits), seconds(cell.log_rt), seconds(cell.log_explore),
                number_or_dash(cell.confidence, 2)));
        }
    }
    return text;
}

std::string tests_text(const PeopleTest& test) {
    if (test.values.size() < 2) {
        return "one person: nothing follows for others";
    }
    std::string text = test.t ? fmt::format("t({:.0f}) = {:.3f}, {}, dz {:.2f}; ", test.t->df,
                                            test.t->t, small_p(test.t->p), test.t->dz)
                              : std::string("all the same: no t; ");
    text += fmt::format("sign-flip {}{}; Wilcoxon V = {:g} of {}, {}{}", small_p(test.flip.p),
                        test.flip.exact ? "" : " (drawn)", test.rank.v, test.rank.ranked,
                        small_p(test.rank.p), test.rank.exact ? "" : " (normal)");
    return test.bayes ? text + fmt::format("; BF10 = {:.3g}", *test.bayes) : text;
}

/// In how many people two frictions have different numbers of answers.
std::string uneven_text(const StatsPart& part) {
    std::size_t uneven = 0;
    for (const PersonStats& person : part.people) {
        std::int64_t first = 0;
        bool differs = false;
        for (const PersonCell& cell : person.cells) {
            first = first == 0 ? cell.n : first;
            differs = differs || (cell.n > 0 && cell.n != first);
        }
        uneven += differs ? 1U : 0U;
    }
    return uneven == 0
             ? std::string()
             : fmt::format(
                   "  Of {} the frictions have different numbers of answers: d' is compared with "
                   "the\n  correction of the least of them, which the table above has not; bits of "
                   "fewer answers are\n  higher by chance alone.\n",
                   counted(uneven, "person", "people"));
}

std::string measures_text(const StatsReport& report, const StatsPart& part) {
    const auto& frictions = report.table.frictions;
    std::string text = "\n  Over people: means (Student's interval; of shares on the logit)";
    if (frictions.size() > 1) {
        text += fmt::format(
            ", and what friction changes within person, against {}:\n  paired t "
            "with its interval; sign-flip: all patterns of signs; Wilcoxon: exact, "
            "ties and all; BF10: JZS, Cauchy prior of r = {:.4g}\n  (Rouder et al. "
            "2009; above 1 for an effect, below for none)",
            frictions[0], report.options.prior_scale);
    }
    text += '\n';
    text += frictions.size() > 1 ? uneven_text(part) : std::string();
    for (const Measure& one : part.measures) {
        text += fmt::format("  {}\n", one.title);
        for (std::size_t f = 0; f < frictions.size(); ++f) {
            if (one.means[f]) {
                text += fmt::format("    {:<20} {:>8}   {:<20}  {}\n", frictions[f],
                                    three(one.means[f]->mean), ends_text(one.means[f]->interval),
                                    counted(one.means[f]->people, "person", "people"));
            }
        }
        for (std::size_t f = 1; f < frictions.size(); ++f) {
            if (!one.effects[f] && one.means[f] && one.means[0]) {
                text += fmt::format("    {:<20} {:>8}   nobody has a number under both\n",
                                    fmt::format("{} - {}", frictions[f], frictions[0]), "-");
            }
            if (one.effects[f]) {
                text += fmt::format("    {:<20} {:>8}   {:<20}  {}\n",
                                    fmt::format("{} - {}", frictions[f], frictions[0]),
                                    three(one.effects[f]->mean.mean),
                                    ends_text(one.effects[f]->mean.interval),
                                    tests_text(*one.effects[f]));
                if (const auto gone = without_both(part, one, f); !gone.empty()) {
                    text += fmt::format("    {:<20} without a number under both, left out: {}\n",
                                        "", fmt::join(gone, ", "));
                }
            }
        }
    }
    return text;
}

/// What the protocol stands or falls by, of one friction against the first.
std::string primary_result(const StatsReport& report, const StatsPart& part, std::size_t f) {
    using protocols::PrimaryTest;
    const auto share = std::ranges::find(part.measures, "share", &Measure::key);
    const auto mixed = std::ranges::find(part.mixed, f, &MixedStats::friction);
    if (report.table.primary == PrimaryTest::mixed) {
        if (mixed == part.mixed.end()) {
            return "nothing can be said";
        }
        const double ratio = likelihood_ratio(mixed->laplace, mixed->laplace_null);
        return fmt::format("{} logit, ratio {:.3f}, {}",
                           mixed->laplace.unbounded ? "unbounded" : three(mixed->laplace.effect),
                           ratio, small_p(chi_square_p(ratio, 1)));
    }
    if (share == part.measures.end() || !share->effects[f] ||
        share->effects[f]->values.size() < 2) {
        return "nothing can be said";
    }
    const PeopleTest& test = *share->effects[f];
    const double p = report.table.primary == PrimaryTest::sign_flip   ? test.flip.p
                   : report.table.primary == PrimaryTest::signed_rank ? test.rank.p
                   : test.t                                           ? test.t->p
                                                                      : 1.0;
    return fmt::format("{}, {}, {}", three(test.mean.mean), ends_text(test.mean.interval),
                       small_p(p));
}

std::string primary_text(const StatsReport& report, const StatsPart& part) {
    const auto& frictions = report.table.frictions;
    if (!report.table.primary || frictions.size() < 2) {
        return {};
    }
    std::string text = fmt::format(
        "\n  Primary test, as the protocol says: {}{}\n", title_of(*report.table.primary),
        report.right_known ? "" : " (here of yes: nothing is right or wrong)");
    for (std::size_t f = 1; f < frictions.size(); ++f) {
        text += fmt::format("    {} - {}: {}\n", frictions[f], frictions[0],
                            primary_result(report, part, f));
    }
    return text;
}

std::string estimate_text(double value, const std::optional<double>& se) {
    return number_or_dash(value, 4) + (se ? fmt::format(" (se {:.4f})", *se) : std::string());
}

std::string mixed_text(const StatsReport& report, const MixedStats& mixed) {
    const std::string& other = report.table.frictions[mixed.friction];
    const MixedFit& one = mixed.laplace;
    const MixedFit& two = mixed.quadrature;
    std::string text = fmt::format(
        "\n  Mixed model, second: logit {} ~ friction + (friction | subject), {} against {}, {} "
        "people\n    {:<24} {:<24} adaptive Gauss-Hermite, {} x {} nodes\n",
        report.right_known ? "right" : "yes", other, report.table.frictions[0], mixed.people, "",
        "Laplace", report.options.nodes, report.options.nodes);
    const auto row = [&](const std::string& name, const std::string& first,
                         const std::string& second) {
        text += fmt::format("    {:<24} {:<24} {}\n", name, first, second);
    };
    const auto ended = [](bool unbounded, double value, const std::optional<double>& se) {
        return unbounded ? std::string("unbounded") : estimate_text(value, se);
    };
    row("intercept", ended(one.intercept_unbounded, one.intercept, one.intercept_se),
        ended(two.intercept_unbounded, two.intercept, two.intercept_se));
    row("friction " + other, ended(one.unbounded, one.effect, one.effect_se),
        ended(two.unbounded, two.effect, two.effect_se));
    row("sd of intercepts", fmt::format("{:.4f}", one.sd_intercept),
        fmt::format("{:.4f}", two.sd_intercept));
    row("sd of friction", fmt::format("{:.4f}", one.sd_slope), fmt::format("{:.4f}", two.sd_slope));
    row("their correlation", number_or_dash(one.correlation, 4),
        number_or_dash(two.correlation, 4));
    row("log-likelihood", number_or_dash(one.log_likelihood, 4),
        number_or_dash(two.log_likelihood, 4));
    const auto ratio_text = [](const MixedFit& full, const MixedFit& less) {
        const double ratio = likelihood_ratio(full, less);
        return fmt::format("{:.4f}, {}", ratio, small_p(chi_square_p(ratio, 1)));
    };
    row("no effect: ratio", ratio_text(one, mixed.laplace_null),
        ratio_text(two, mixed.quadrature_null));
    if (mixed.simulated) {
        row("  by simulation", small_p(mixed.simulated->p), "");
    }
    const double slopes = likelihood_ratio(one, mixed.laplace_intercept);
    row("no spread of it: ratio",
        fmt::format("{:.4f}, {}", slopes, small_p(slope_variance_p(slopes))), "");
    text += fmt::format(
        "    No effect: both models keep the spread of friction's effect, so nothing lies on a "
        "boundary, and the ratio is\n    chi-square of 1 df for many people; for few it is larger "
        "by chance more often{}.\n    No spread: a variance on its boundary; half chi-square of 1 "
        "df, half of 2 (Self & Liang 1987, Stram & Lee 1994).\n",
        mixed.simulated ? fmt::format("; beside it stands the p of {} samples of the "
                                      "fitted null, and before it the tests within person",
                                      mixed.simulated->samples)
                        : "");
    for (const std::string& warning : warnings_of(mixed)) {
        text += "    WARNING: " + warning + ".\n";
    }
    return text;
}

std::string confidence_text(const StatsPart& part) {
    if (part.levels.empty()) {
        return {};
    }
    std::string text =
        "\n  Confidence: share correct at each level, mean over the people who used it\n";
    for (const ConfidenceLevel& one : part.levels) {
        text +=
            fmt::format("    {:<8g} {:>8}   {:<20}  {}, {}\n", one.level, three(one.share.mean),
                        ends_text(one.share.interval),
                        counted(one.share.people, "person", "people"), counted(one.n, "answer"));
    }
    return text;
}

/// Where confidence is a probability.
std::string brier_text(const StatsPart& part) {
    std::string text;
    double sum = 0.0;
    double people = 0.0;
    for (const PersonStats& person : part.people) {
        if (person.brier) {
            text +=
                fmt::format("{}{} {:.3f}", text.empty() ? "" : ", ", person.subject, *person.brier);
            sum += *person.brier;
            people += 1.0;
        }
    }
    return text.empty() ? text
                        : fmt::format(
                              "    Brier's score (0: sure and right; 0.25: always .5): {}; "
                              "mean {:.3f}\n",
                              text, sum / people);
}

std::string trends_text(const StatsReport& report, const StatsPart& part) {
    std::string text =
        "\n  Within person, then over people: does confidence know (area under the type 2 ROC, "
        "0.5: "
        "no), and what do\n  time and rest change (joint slopes of least squares on both: of 100 "
        "trials at the same rest, "
        "of 10 trials\n  since the last break at the same trial)\n";
    for (const auto& [key, test] : part.tests) {
        const bool sure = key == "confidence_area" || key == "overconfidence";
        const bool rest = key.ends_with("since_break");
        const double scale = sure ? 1.0 : rest ? 10.0 : 100.0;
        const std::string name =
            key == "confidence_area" ? "confidence, area"
            : key == "overconfidence"
                ? "confidence less share correct"
                : fmt::format("{}, {}", key.starts_with("share") ? share_title(report) : "ln rt",
                              rest ? "10 since a break" : "100 trials");
        std::optional<Interval> interval = test.mean.interval;
        if (interval) {
            interval = Interval{scale * interval->low, scale * interval->high};
        }
        text += fmt::format("    {:<32} {:>8}   {:<20}  {}\n", name, three(scale * test.mean.mean),
                            ends_text(interval), tests_text(test));
    }
    return part.tests.empty() ? std::string() : text;
}

std::string part_text(const StatsReport& report, const StatsPart& part, const std::string& title) {
    std::string text =
        fmt::format("\n{}: {}, {}\n", title, counted(part.people.size(), "person", "people"),
                    counted(part.trials, "answer"));
    text += primary_text(report, part) + cells_text(report, part) + measures_text(report, part);
    for (const MixedStats& mixed : part.mixed) {
        text += mixed_text(report, mixed);
    }
    return text + confidence_text(part) + brier_text(part) + trends_text(report, part);
}

}  // namespace

std::string stats_text(const StatsReport& report) {
    std::string text = title_text(report) + excluded_text(report);
    text += part_text(report, report.applied,
                      report.not_applied ? "Exclusions applied" : "All answers");
    if (report.not_applied) {
        text += part_text(report, *report.not_applied, "Exclusions NOT applied");
    }
    const std::string versions = versions_text(report.table.versions);
    return versions.empty() ? text : text + '\n' + versions;
}

}  // namespace palpate::data
