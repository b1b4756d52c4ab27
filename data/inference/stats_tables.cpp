#include <algorithm>
#include <cmath>
#include <ranges>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "engine/base/text.hpp"
#include "protocols/file/keys.hpp"
#include "data/csv/json_text.hpp"
#include "data/inference/power.hpp"
#include "data/inference/stats_report.hpp"
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
            "  Person by person: {}, with intervals of this person's own trials{};\n  bits: "
            "plug-in, Miller-Madow, mean of {} permutations (a guesser's), their p, interval;\n  "
            "seconds: geometric means; felt: from the first contact to done",
            share_title(report),
            report.yes_no ? report.right_known
                              ? "; d' and criterion c with the log-linear correction (Hautus 1995)"
                              : ""
            : report.table.alternatives < 2
                ? std::string()
                : fmt::format("; d' of {} alternatives, unbiased observer (n of n counts as n - "
                              "1/2)",
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
                 of_bits(bits.bits.plug_in), of_bits(bits.bits.corrected),
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
        return {
            name,
            mixed->laplace.unbounded ? Cell(Nothing{"unbounded"}) : cell_of(mixed->laplace.effect),
            Nothing{}, cell_of(likelihood_ratio(mixed->laplace, mixed->laplace_null)),
            no_effect_p(*mixed)};
    }
    if (report.table.primary == PrimaryTest::mixed || share == part.measures.end() ||
        !share->effects[f] || share->effects[f]->values.size() < 2) {
        return {name, none, none, Nothing{}, none};
    }
    const PeopleTest& test = *share->effects[f];
    const Cell p = report.table.primary == PrimaryTest::sign_flip   ? Cell(test.flip.p)
                 : report.table.primary == PrimaryTest::signed_rank ? Cell(test.rank.p)
                 : test.t                                           ? Cell(test.t->p)
                          : Cell(Nothing{"all the same: no t"});
    return {name, cell_of(test.mean.mean), cell_of(test.mean.interval), Nothing{}, p};
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
    } else if (table.alternatives < 2) {
        text +=
            "\n  Answers name the one shape that was felt: all are right. --alternatives says how "
            "many were pictured";
    } else {
        text += fmt::format("\n  Answers name one of {} shapes: chance is {:.3f}",
                            table.alternatives, 1.0 / static_cast<double>(table.alternatives));
    }
    return text + fmt::format(
                      ".\n  Intervals are of 95 %. Nothing here pools the trials of several "
                      "people: the person is the unit. Seed {}.\n",
                      report.options.seed);
}

std::string excluded_text(const StatsReport& report) {
    const auto& account = report.table.left_out;
    std::string text = account ? left_out_text(*account) : std::string();
    if (report.excluded.empty()) {
        return text +
               (account ? "  Rules and marks leave nothing out: with and without these it is the "
                          "same.\n"
                        : "  Nothing is excluded: with and without exclusions it is the same.\n");
    }
    text += "  Excluded, and below left out first, then left in:\n";
    for (const ExcludedTrials& one : report.excluded) {
        text += fmt::format("    {}  {}: {}\n", one.subject, counted(one.trials, "trial"), one.why);
    }
    return text;
}

std::string part_text(const StatsReport& report, const StatsPart& part, const std::string& title) {
    std::string text =
        fmt::format("\n{}: {}, {}\n", title, counted(part.people.size(), "person", "people"),
                    counted(part.trials, "answer"));
    for (const Table& table : stats_tables(report, part)) {
        text += table_text(table);
    }
    return text;
}

Json part_json(const StatsReport& report, const StatsPart& part) {
    Json one = {{"answers", part.trials},         {"primary", Json::object()},
                {"people", Json::object()},       {"measures", Json::object()},
                {"mixed_model", Json::object()},  {"confidence", Json::array()},
                {"within_person", Json::object()}};
    for (const Table& table : stats_tables(report, part)) {
        put_table(one, table);
    }
    return one;
}

/// A string of R, in ASCII: read the same in every locale.
std::string r_string(std::string_view text) {
    std::string out = "\"";
    while (!text.empty()) {
        const Character one = first_character(text);
        const bool plain =
            one.code >= U' ' && one.code < 127 && one.code != U'"' && one.code != U'\\';
        out += plain ? std::string(1, text.front())
             : one.code == U'"' || one.code == U'\\'
                 ? fmt::format("\\{}", text.front())
                 : fmt::format("\\U{{{:x}}}", static_cast<unsigned>(one.code));
        text.remove_prefix(std::max<std::size_t>(one.length, 1));
    }
    return out + '"';
}

std::string list_of(const std::vector<std::string>& all) {
    return fmt::format("c({})", fmt::join(std::views::transform(all, r_string), ", "));
}

}  // namespace

double no_effect_p(const MixedStats& mixed) {
    return chi_square_p(likelihood_ratio(mixed.laplace, mixed.laplace_null), 1);
}

std::string primary_title(const StatsReport& report) {
    const bool logit = report.table.primary == protocols::PrimaryTest::mixed;
    return fmt::format("{}{}{}",
                       title_of(report.table.primary.value_or(protocols::PrimaryTest::paired_t)),
                       logit ? ", in logit" : "",
                       report.right_known ? "" : " (here of yes: nothing is right or wrong)");
}

Table primary_table(const StatsReport& report, const StatsPart& part) {
    Table table{.place = "primary/*",
                .columns = heads({"comparison", "estimate", "interval_95|interval",
                                  "chi_square|ratio", "p|p|p"})};
    if (!report.table.primary) {
        return table;
    }
    table.title = "  Primary test, as the protocol says: " + primary_title(report);
    for (std::size_t f = 1; f < report.table.frictions.size(); ++f) {
        table.rows.push_back(primary_row(report, part, f));
    }
    if (table.rows.size() > 1) {
        table.notes.push_back(
            fmt::format("{} comparisons, no p corrected for the others. The primary one, as in "
                        "palpate power: {}, the largest friction.",
                        table.rows.size(), report.table.primary_friction));
    }
    return table;
}

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

std::string stats_json(const StatsReport& report) {
    const TrialTable& table = report.table;
    const StatsOptions& options = report.options;
    Json all = {
        {"source", table.source},
        {"study", table.study.empty() ? Json(nullptr) : Json(table.study)},
        {"kind", table.kind.empty() ? Json(nullptr) : Json(table.kind)},
        {"answers", report.yes_no ? "yes_no" : "identification"},
        {"alternatives", report.yes_no ? Json(nullptr) : Json(table.alternatives)},
        {"signals", options.signals},
        {"outcome", report.right_known ? "correct" : "yes"},
        {"frictions", table.frictions},
        {"primary_test", table.primary ? Json(protocols::word_of(*table.primary)) : Json(nullptr)},
        {"seed", options.seed},
        {"permutations", options.permutations},
        {"simulations", options.simulations},
        {"bayes_prior", {{"name", "JZS"}, {"scale_r", options.prior_scale}}},
        {"versions", versions_json(table.versions)},
        {"left_out", table.left_out ? left_out_json(*table.left_out) : Json(nullptr)},
        {"excluded", Json::array()}};
    for (const ExcludedTrials& one : report.excluded) {
        all["excluded"].push_back(
            {{"subject", one.subject}, {"why", one.why}, {"trials", one.trials}});
    }
    all["applied"] = part_json(report, report.applied);
    all["not_applied"] =
        report.not_applied ? part_json(report, *report.not_applied) : Json(nullptr);
    return json_text(all) + '\n';
}

std::string_view stats_script();  // stats.R

std::string stats_r(const StatsReport& report, const std::string& trials) {
    const auto& account = report.table.left_out;
    return fmt::format(
        "# The numbers of `palpate stats --json` again, by R, from the trials beside this "
        "script.\n{}# Each line that it prints is a place in that JSON (a JSON pointer, with \\t, "
        "\\n and \\r for\n# tabs and ends of lines), a tab, and the number.\n"
        "# Base R; the mixed model by Laplace needs lme4 (r-cran-lme4). What palpate draws by "
        "chance\n"
        "# (permutations, the simulated null) is not drawn again.\n"
        "data <- {}\nfrictions <- {}  # differences are from the first\nyes_no <- {}\n"
        "signals <- {}  # of yes/no: for which yes is right\nalternatives <- {}\n"
        "prior_scale <- {}\n\n{}",
        account ? remarked(left_out_text(without_words(*account))) : std::string(),
        r_string(trials), list_of(report.table.frictions), report.yes_no ? "TRUE" : "FALSE",
        list_of(report.options.signals), report.table.alternatives, report.options.prior_scale,
        stats_script());
}

}  // namespace palpate::data
