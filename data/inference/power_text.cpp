#include <algorithm>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include "data/inference/power.hpp"
#include "data/statistics/wilson.hpp"

namespace palpate::data {
namespace {

std::string with_error(const std::optional<MonteCarlo>& value, int digits) {
    return value ? fmt::format("{:.{}f} ({:.{}f})", value->value, digits, value->se, digits)
                 : std::string("-");
}

/// Of a share that was 0 or 1 in all studies the standard error would be 0: the other end of
/// Wilson's interval.
std::string share_text(const MonteCarlo& share, std::size_t studies, int digits) {
    if (share.se > 0.0) {
        return with_error(share, digits);
    }
    const auto n = static_cast<std::int64_t>(studies);
    const bool all = share.value > 0.5;
    const Interval ends = wilson(all ? n : 0, n);
    return fmt::format("{:.{}f} ({} {:.{}f})", share.value, digits, all ? "from" : "to",
                       all ? ends.low : ends.high, digits);
}

Interval power_interval(const PowerPoint& point, std::size_t studies) {
    return wilson(std::llround(point.power.value * static_cast<double>(studies)),
                  static_cast<std::int64_t>(studies));
}

std::string wrong_text(const PowerPoint& point, std::size_t studies) {
    const double found = point.power.value * static_cast<double>(studies);
    return point.wrong_sign
             ? share_text(*point.wrong_sign, static_cast<std::size_t>(std::lround(found)), 4)
             : std::string("-");
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
    const Interval ends = power_interval(*point, report.spec.studies);
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
        series.x.push_back(static_cast<double>(point.participants));
        series.y.push_back(point.power.value);
    }
    return series;
}

void add_errors(Panel& panel, const std::vector<PowerPoint>& points, std::size_t studies, Ink ink) {
    for (const PowerPoint& point : points) {
        const auto x = static_cast<double>(point.participants);
        const Interval ends = power_interval(point, studies);
        panel.series.push_back({.x = {x, x}, .y = {ends.low, ends.high}, .ink = ink, .width = 3.0});
    }
}

}  // namespace

std::string_view title_of(protocols::PrimaryTest test) {
    switch (test) {
        case protocols::PrimaryTest::paired_t:
            return "paired t of the share of right answers, within people";
        case protocols::PrimaryTest::sign_flip:
            return "exact sign-flip test of the share of right answers, within people";
        case protocols::PrimaryTest::signed_rank:
            return "Wilcoxon signed-rank test of the share of right answers, within people";
        case protocols::PrimaryTest::mixed:
            break;
    }
    return "likelihood ratio of the logistic mixed model, correct ~ friction + (friction | person)";
}

std::string power_text(const PowerReport& report) {
    std::string text = fmt::format(
        "{}: {} against {}, {} trials of a person under each; everybody is SIMULATED\n"
        "  Primary test: {}; two-sided, alpha = {:g}.\n"
        "  Effect: {}: the share of right answers goes from {:.3f} by {:+.3f}. Without it people "
        "differ "
        "by {:.2f} logit.\n"
        "  {} studies each, {} without an effect, judged from {} hands that felt once. In "
        "brackets: "
        "Monte-Carlo standard errors; of none or all of the studies the 95 % bound of Wilson.\n\n",
        report.study, report.friction, report.against, report.trials, title_of(report.spec.test),
        report.spec.alpha, report.effect, report.share_without, report.true_difference,
        report.people_sd, report.spec.studies, report.null_studies, report.hands);
    text += fmt::format("  {:>6}  {:<18}  {:<18}  {:<15}  {:<14}  {}\n", "people", "power",
                        "type I error", "interval width", "exaggeration", "wrong sign");
    for (std::size_t i = 0; i < report.points.size(); ++i) {
        const PowerPoint& one = report.points[i];
        text += fmt::format("  {:>6}  {:<18}  {:<18}  {:<15}  {:<14}  {}\n", one.participants,
                            share_text(one.power, report.spec.studies, 3),
                            share_text(report.null[i].power, report.null_studies, 4),
                            with_error(one.width, 3), with_error(one.exaggeration, 2),
                            wrong_text(one, report.spec.studies));
    }
    text +=
        "\n  Interval width: of the 95 % interval of the difference of shares, over people. "
        "Exaggeration and wrong sign:\n  of significant studies, size of the difference by the "
        "true "
        "one, and share of those that point the other way.\n";
    return text + least_text(report) + '\n' + sentence(report);
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
