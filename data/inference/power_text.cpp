#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "data/inference/power.hpp"

namespace palpate::data {
namespace {

std::string with_error(const std::optional<MonteCarlo>& value, int digits) {
    return value ? fmt::format("{:.{}f} ({:.{}f})", value->value, digits, value->se, digits)
                 : std::string("-");
}

const PowerPoint* point_of(const PowerReport& report, std::size_t participants) {
    const auto found = std::ranges::find(report.points, participants, &PowerPoint::participants);
    return found == report.points.end() ? nullptr : &*found;
}

std::string least_text(const PowerReport& report) {
    std::string text;
    for (const auto& [power, least] : report.least) {
        text += least ? fmt::format("  Power of {:.2g} takes {} people.\n", power, *least)
                      : fmt::format("  Power of {:.2g} takes more than {} people.\n", power,
                                    report.most);
    }
    return text;
}

/// For the number of participants that the protocol plans, where it was asked for; else for that of power .8.
std::string sentence(const PowerReport& report) {
    const PowerPoint* point = point_of(report, report.planned);
    if (point == nullptr) {
        point = &report.points.back();
    }
    return fmt::format(
        "For the pre-registration:\n  \"The primary test is the {}, {} against {}, two-sided with "
        "alpha = {:g}. In {} simulated studies of {} participants and {} trials under each "
        "friction, "
        "whose hands and percepts palpate simulated, it finds an effect of {} with a power of "
        "{:.2f} "
        "(Monte-Carlo standard error {:.3f}).{}\"\n",
        title_of(report.spec.test), report.friction, report.against, report.spec.alpha,
        report.spec.studies, point->participants, report.trials, report.effect, point->power.value,
        point->power.se,
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

void add_errors(Panel& panel, const std::vector<PowerPoint>& points, Ink ink) {
    for (const PowerPoint& point : points) {
        const auto x = static_cast<double>(point.participants);
        panel.series.push_back({.x = {x, x},
                                .y = {std::max(0.0, point.power.value - 2.0 * point.power.se),
                                      std::min(1.0, point.power.value + 2.0 * point.power.se)},
                                .ink = ink,
                                .width = 3.0});
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
        "Monte-Carlo standard errors.\n\n",
        report.study, report.friction, report.against, report.trials, title_of(report.spec.test),
        report.spec.alpha, report.effect, report.share_without, report.true_difference,
        report.people_sd, report.spec.studies, report.null_studies, report.hands);
    text += fmt::format("  {:>6}  {:<14}  {:<16}  {:<15}  {:<14}  {}\n", "people", "power",
                        "type I error", "interval width", "exaggeration", "wrong sign");
    for (std::size_t i = 0; i < report.points.size(); ++i) {
        const PowerPoint& one = report.points[i];
        text += fmt::format("  {:>6}  {:<14}  {:<16}  {:<15}  {:<14}  {}\n", one.participants,
                            with_error(one.power, 3), with_error(report.null[i].power, 4),
                            with_error(one.width, 3), with_error(one.exaggeration, 2),
                            with_error(one.wrong_sign, 4));
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
    add_errors(panel, report.points, Ink::blue);
    add_errors(panel, report.null, Ink::vermillion);
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
        "without an effect; bars are two Monte-Carlo standard errors to each side.",
        title_of(report.spec.test), report.friction, report.against, report.trials,
        report.spec.studies, report.null_studies);
    for (const auto& [power, least] : report.least) {
        caption += least ? fmt::format(" A power of {:.2g} takes {} people.", power, *least) : "";
    }
    return {.id = "power",
            .title = fmt::format("Power of {}", report.study),
            .panels = {panel},
            .caption = caption};
}

}  // namespace palpate::data
