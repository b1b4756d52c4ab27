#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "engine/base/text.hpp"
#include "protocols/file/keys.hpp"
#include "data/inference/power.hpp"
#include "data/statistics/distributions.hpp"
#include "data/tables/table.hpp"

namespace palpate::data {
namespace {

/// Of a share of so many studies: never without width, as a standard error of 0 would be.
Interval share_interval(const MonteCarlo& share, std::size_t studies) {
    return wilson(std::llround(share.value * static_cast<double>(studies)),
                  static_cast<std::int64_t>(studies));
}

/// A row a number of participants.
Table points_table(const PowerReport& report) {
    Table table{
        .place = "points/-",
        .columns = heads({"participants|people", "power", "power_95|interval",
                          "type_i_error|type I error|4", "type_i_error_95|interval|4",
                          "interval_width|interval width", "interval_width_se|se",
                          "exaggeration|exaggeration|2", "exaggeration_se|se|2",
                          "wrong_sign|wrong sign|4", "wrong_sign_95|interval|4"}),
        .notes = {"Intervals: Wilson's of 95 %, of the share of studies; se: of Monte Carlo. "
                  "Interval width: of the 95 %\n  interval of the difference of shares, over "
                  "people. Exaggeration and wrong sign: of significant studies, size of\n  the "
                  "difference by the true one, and share of those that point the other way."}};
    const auto of = [](const std::optional<MonteCarlo>& value, double MonteCarlo::*member) {
        return value ? cell_of((*value).*member) : Cell(Nothing{});
    };
    for (std::size_t i = 0; i < report.points.size(); ++i) {
        const PowerPoint& one = report.points[i];
        const MonteCarlo& null = report.null[i].power;
        const auto found = static_cast<std::size_t>(
            std::lround(one.power.value * static_cast<double>(report.spec.studies)));
        table.rows.push_back(
            {cell_of(one.participants), one.power.value,
             share_interval(one.power, report.spec.studies), null.value,
             share_interval(null, report.null_studies), one.width.value, one.width.se,
             of(one.exaggeration, &MonteCarlo::value), of(one.exaggeration, &MonteCarlo::se),
             of(one.wrong_sign, &MonteCarlo::value),
             one.wrong_sign ? Cell(share_interval(*one.wrong_sign, found)) : Cell(Nothing{})});
    }
    return table;
}

const PowerPoint* point_of(const PowerReport& report, std::size_t participants) {
    const auto found = std::ranges::find(report.points, participants, &PowerPoint::participants);
    return found == report.points.end() ? nullptr : &*found;
}

std::string least_text(const PowerReport& report) {
    std::string text;
    for (const LeastPeople& one : report.least) {
        const auto number = [&](const std::optional<std::size_t>& people) {
            return people ? fmt::format("{}", *people) : fmt::format("more than {}", report.max);
        };
        text += fmt::format("  Power of {:.2g} takes {} people", one.power, number(one.people));
        text += one.low == one.high
                  ? std::string(".\n")
                  : fmt::format(": {} to {} by the Monte-Carlo error (95 %) of {} studies{}.\n",
                                number(one.low), number(one.high), report.spec.studies,
                                one.studies
                                    ? fmt::format("; about {} tell it to one person: --studies {}",
                                                  *one.studies, *one.studies)
                                    : std::string());
    }
    return text;
}

/// For the number of participants that the protocol plans, where it was asked for; else for that of
/// power .8.
std::string sentence(const PowerReport& report) {
    const PowerPoint* point = point_of(report, report.planned);
    if (point == nullptr) {
        point = &report.points.back();
    }
    const std::string design = fmt::format(
        "The primary test is the {}, {} against {}, two-sided with alpha = {:g}. In {} simulated "
        "studies of {} participants and {} trials under each friction, whose hands and percepts "
        "palpate simulated, ",
        title_of(report.spec.test), report.friction, report.against, report.spec.alpha,
        report.spec.studies, point->participants, report.trials);
    const Interval ends = share_interval(point->power, report.spec.studies);
    const std::string error =
        point->power.se > 0.0
            ? fmt::format("Monte-Carlo standard error {:.3f}", point->power.se)
            : fmt::format("Wilson's 95 % interval {:.3f} to {:.3f}", ends.low, ends.high);
    if (report.none) {
        return fmt::format(
            "There is no effect to be found ({}): no number of people finds it, and what is "
            "significant is type I error.\n  \"{}it is significant in a share of {:.3f} ({}) where "
            "there is no effect.\"\n",
            report.effect, design, point->power.value, error);
    }
    return fmt::format(
        "For the pre-registration:\n  \"{}it finds an effect of {} with a power of {:.2f} "
        "({}).{}\"\n",
        design, report.effect, point->power.value, error,
        point->exaggeration
            ? fmt::format(
                  " Where it is significant, the effect seems {:.2f} times as large as it is.",
                  point->exaggeration->value)
            : "");
}

Series series_of(const std::vector<PowerPoint>& points, std::string name, Ink ink) {
    Series series{.name = std::move(name), .ink = ink, .mark = Mark::both};
    for (const PowerPoint& point : points) {
        series.add(static_cast<double>(point.participants), point.power.value);
    }
    return series;
}

void add_errors(Panel& panel, const std::vector<PowerPoint>& points, std::size_t studies, Ink ink) {
    for (const PowerPoint& point : points) {
        const auto x = static_cast<double>(point.participants);
        const Interval ends = share_interval(point.power, studies);
        panel.series.push_back(interval_bar(x, ends.low, x, ends.high, ink));
    }
}

}  // namespace

std::string_view title_of(protocols::PrimaryTest test) {
    constexpr std::array<std::string_view, 4> kWords{
        "paired t of the share of right answers, within people",
        "exact sign-flip test of the share of right answers, within people",
        "Wilcoxon signed-rank test of the share of right answers, within people",
        "likelihood ratio of the logistic mixed model, correct ~ friction + (friction | person)"};
    return kWords[static_cast<std::size_t>(test)];
}

std::string power_text(const PowerReport& report) {
    std::string text = fmt::format(
        "{}: {} against {}, {} trials of a person under each; everybody is SIMULATED\n"
        "  Primary test: {}; two-sided, alpha = {:g}.\n"
        "  Effect: {}: the share of right answers goes from {:.3f} by {:+.3f}. Without it people "
        "differ by {:.2f} logit.\n"
        "  {} studies each, {} without an effect, judged from {} trials that the hands of {} "
        "felt.\n",
        report.study, report.friction, report.against, report.trials, title_of(report.spec.test),
        report.spec.alpha, report.effect, report.share_without, report.true_difference,
        report.people_sd, report.spec.studies, report.null_studies, report.felt_trials,
        counted(report.hands, "person", "people"));
    text += table_text(points_table(report));
    return text + least_text(report) + '\n' + sentence(report);
}

std::string power_json(const PowerReport& report) {
    Json all = {{"study", report.study},
                {"friction", report.friction},
                {"against", report.against},
                {"test", protocols::word_of(report.spec.test)},
                {"alpha", report.spec.alpha},
                {"effect", report.effect},
                {"share_without", report.share_without},
                {"true_difference", report.true_difference},
                {"people_sd_logit", report.people_sd},
                {"trials", report.trials},
                {"studies", report.spec.studies},
                {"null_studies", report.null_studies},
                {"hands", report.hands},
                {"felt_trials", report.felt_trials},
                {"points", Json::array()},
                {"least_people", Json::array()}};
    put_table(all, points_table(report));
    const auto number = [](const std::optional<std::size_t>& people) {
        return people ? Json(*people) : Json(nullptr);
    };
    for (const LeastPeople& one : report.least) {
        all["least_people"].push_back({{"power", one.power},
                                       {"people", number(one.people)},
                                       {"low", number(one.low)},
                                       {"high", number(one.high)},
                                       {"looked_up_to", report.max}});
    }
    return json_text(all) + '\n';
}

Figure power_figure(const PowerReport& report) {
    Panel panel{.x = {.label = "participants", .low = 0.0},
                .y = {.label = "share of studies", .low = 0.0, .high = 1.0},
                .height = 300.0};
    panel.series.push_back(
        series_of(report.points, fmt::format("power, {}", report.effect), Ink::blue));
    panel.series.push_back(series_of(report.null, "type I error", Ink::vermillion));
    add_errors(panel, report.points, report.spec.studies, Ink::blue);
    add_errors(panel, report.null, report.null_studies, Ink::vermillion);
    const auto last = static_cast<double>(report.points.back().participants);
    for (const double level : {report.spec.alpha, 0.8, 0.9}) {
        panel.series.push_back({.x = {0.0, last},
                                .y = {level, level},
                                .ink = Ink::grey,
                                .stroke = Stroke::dotted,
                                .width = 1.0});
    }
    std::string caption = fmt::format(
        "{}; {} against {}, {} trials of a person under each. {} simulated studies a point, {} "
        "without an effect; bars are 95 % intervals of Wilson.",
        title_of(report.spec.test), report.friction, report.against, report.trials,
        report.spec.studies, report.null_studies);
    for (const LeastPeople& one : report.least) {
        caption += one.people && one.low && one.high
                     ? fmt::format(" A power of {:.2g} takes {} people ({} to {}).", one.power,
                                   *one.people, *one.low, *one.high)
                     : "";
    }
    return {.id = "power",
            .title = fmt::format("Power of {}", report.study),
            .panels = {panel},
            .caption = caption};
}

}  // namespace palpate::data
