#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "data/page/sections.hpp"

namespace palpate::data {
namespace {

/// Shares of each level, a bar for each friction, side by side.
Panel levels_panel(const Rows& rows,
                   const std::string& felt,
                   const std::vector<std::string>& frictions,
                   std::size_t levels) {
    const double max = static_cast<double>(levels);
    Panel panel{.title = felt,
                .x = {.label = "level", .low = 0.4, .high = max + 0.6},
                .y = {.label = "share of answers", .low = 0.0},
                .height = 150.0};
    for (std::size_t level = 1; level <= levels; ++level) {
        panel.x.names.emplace_back(static_cast<double>(level), fmt::format("{}", level));
    }
    const double width = 0.8 / static_cast<double>(frictions.size());
    double highest = 0.0;
    for (std::size_t f = 0; f < frictions.size(); ++f) {
        Series outline{.name = "friction " + frictions[f],
                       .ink = ink_of(f),
                       .stroke = f % 2 == 0 ? Stroke::solid : Stroke::dashed,
                       .width = 1.4};
        const Rows mine = rows.where("felt", felt).where("friction", frictions[f]);
        for (std::size_t row = 0; row < mine.cells.size(); ++row) {
            const double left =
                mine.number(row, "level") - 0.4 + width * static_cast<double>(f) + 0.02;
            const double right = left + width - 0.04;
            const double share = mine.number(row, "share");
            highest = std::max(highest, share);
            panel.bands.push_back(
                {.x = {left, right}, .low = {0.0, 0.0}, .high = {share, share}, .ink = ink_of(f)});
            outline.add(left, 0.0);
            outline.add(left, share);
            outline.add(right, share);
            outline.add(right, 0.0);
            outline.gap();
        }
        panel.series.push_back(std::move(outline));
    }
    panel.y.high = std::min(1.0, std::max(0.1, 1.08 * highest));
    return panel;
}

/// A row of results: a mean over people, or of differences within person.
std::vector<Cell> mean_cells(const std::string& felt,
                             const std::string& what,
                             const PeopleMean& mean,
                             const Cell& p) {
    return {felt, what, cell_of(mean.people), cell_of(mean.mean), cell_of(mean.interval), p};
}

void add_means(PageWriter& page,
               const Study& study,
               const std::vector<std::string>& felt,
               const std::vector<std::string>& frictions) {
    PageFigure figure{.id = "rated",
                      .title = "Mean level by friction, within person",
                      .width = 264.0,
                      .data = study.ask(page_query("means"))};
    Results results{
        .table = {.columns = heads(
                      {"felt|", "what|", "people|", "mean|", "interval_95|", "sign_flip_p|"})},
        .command = summary_words(study),
        .caption = "Means over people and differences within person, with 95 % intervals"};
    for (const std::string& object : felt) {
        PairedPanel pairs = pairs_of(figure.data, "mean_level", frictions, Scale::numbers, object);
        pairs.title = object;
        pairs.label = "mean level";
        pairs.height = 170.0;
        for (std::size_t f = 0; f < frictions.size(); ++f) {
            std::vector<double> differences;
            for (const auto& mine : pairs.people) {
                if (f > 0 && std::isfinite(mine[f]) && std::isfinite(mine[0])) {
                    differences.push_back(mine[f] - mine[0]);
                }
            }
            if (pairs.means[f]) {
                results.table.rows.push_back(
                    mean_cells(object, "friction " + frictions[f], *pairs.means[f], Nothing{}));
            }
            if (!differences.empty()) {
                results.table.rows.push_back(
                    mean_cells(object, fmt::format("{} \u2212 {}", frictions[f], frictions[0]),
                               mean_over_people(differences), sign_flip(differences).p));
            }
        }
        figure.panels.push_back(paired_panel(pairs));
    }
    figure.results.push_back(std::move(results));
    figure.caption =
        "Level 1 is the lowest. A thin line is a person; bars: means over people with 95 % "
        "intervals (Student's; the person is the unit). Broken lines: people whom the protocol's "
        "rules leave out, in no mean. Levels are taken as numbers with equal steps.";
    page.figure(figure);
}

}  // namespace

std::string summary_words(const Study& study) {
    return fmt::format("palpate summary {}", study.file);
}

void add_ratings(PageWriter& page, const Study& study) {
    const protocols::ResponseSpec& asked = study.protocol.response;
    if (asked.kind != protocols::ResponseKind::rating) {
        return;
    }
    page.section("ratings", "Ratings");
    PageFigure figure{.id = "levels-apart",
                      .title = "Which level was said of what",
                      .width = 400.0,
                      .data = study.ask(page_query("levels"))};
    if (figure.data.cells.empty()) {
        page.paragraph("No rating counts yet.");
        return;
    }
    const std::vector<std::string> frictions = frictions_of(study);
    const std::vector<std::string> felt = figure.data.levels("felt");
    for (const std::string& object : felt) {
        figure.panels.push_back(levels_panel(figure.data, object, frictions, asked.levels));
    }
    const auto label = [](const std::string& text) {
        return text.empty() ? std::string() : fmt::format(" (\u201c{}\u201d)", text);
    };
    figure.caption = fmt::format(
        "From 1{} to {}{}. Shares of the answers to each object under each friction, all people "
        "together, exclusions applied: they describe, and no test rests on them.",
        label(asked.low), asked.levels, label(asked.high));
    page.figure(figure);
    add_means(page, study, felt, frictions);
}

}  // namespace palpate::data
