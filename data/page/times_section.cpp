#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "data/inference/stats_report.hpp"
#include "data/page/sections.hpp"

namespace palpate::data {
namespace {

/// Of palpate stats, the tests within person of slopes over trials, or the others: of confidence.
Results tests_of(const PageNumbers& numbers, const char* caption, bool slopes) {
    Results results{.table = within_table(*numbers.stats, numbers.stats->applied),
                    .command = numbers.stats_words,
                    .caption = caption};
    std::erase_if(results.table.rows, [&](const auto& row) {
        const std::string& key = std::get<Named>(row.front()).key;
        return (key.ends_with("_per_trial") || key.ends_with("_since_break")) != slopes;
    });
    return results;
}

/// A mean over people with its interval at each place.
void add_trend(Panel& panel,
               const Rows& rows,
               std::string_view x,
               const std::string& value,
               const std::string& low,
               const std::string& high) {
    panel.series.push_back(
        {.x = rows.numbers(x), .y = rows.numbers(value), .ink = Ink::blue, .mark = Mark::both});
    panel.bands.push_back({.x = rows.numbers(x),
                           .low = rows.numbers(low),
                           .high = rows.numbers(high),
                           .name = "95 % over people",
                           .ink = Ink::blue});
}

/// A band of two people can be a thousand times what was measured: cut, so that means are no line
/// at 0. @return it is
bool keep_means_visible(Panel& panel) {
    constexpr double kTimesMeans = 3.0;
    const auto largest = [](const std::vector<double>& all) {
        return std::accumulate(all.begin(), all.end(), 0.0,
                               [](double a, double b) { return std::fmax(a, b); });
    };
    const double means = largest(panel.series.back().y);
    const double ends = largest(panel.bands.back().high);
    const bool cut = means > 0.0 && ends > kTimesMeans * means;
    if (cut) {
        panel.y.low = 0.0;
        panel.y.high = kTimesMeans * means;
    }
    return cut;
}

void add_response_times(PageWriter& page, const Study& study, bool tested) {
    const std::vector<std::string> frictions = frictions_of(study);
    PageFigure figure{
        .id = "times", .title = "How long it took", .data = study.ask(page_query("times"))};
    for (const auto& [column, title] : {std::pair{"response_s", "question to answer"},
                                        std::pair{"exploration_s", "first contact to done"}}) {
        PairedPanel pairs = pairs_of(figure.data, column, frictions, Scale::logarithms);
        pairs.title = title;
        pairs.label = "geometric mean";
        pairs.unit = "s";
        figure.panels.push_back(paired_panel(pairs));
    }
    figure.caption = fmt::format(
        "A thin line is a person, a broken one whom the protocol's rules leave out; bars: means "
        "over people with 95 % intervals, of logarithms.{}",
        tested ? " Their tests stand with the effect of friction above." : "");
    page.figure(figure);

    PageFigure deciles{.id = "deciles",
                       .title = "Response times, decile by decile",
                       .data = study.ask(page_query("deciles"))};
    Panel& panel = deciles.panels.emplace_back();
    panel = {.x = {.label = "share of answers that were as fast", .low = 0.0, .high = 1.0},
             .y = {.label = "response time", .unit = "s"}};
    for (std::size_t f = 0; f < frictions.size(); ++f) {
        const Rows mine = deciles.data.where("friction", frictions[f]);
        panel.series.push_back({.name = "friction " + frictions[f],
                                .x = mine.numbers("share"),
                                .y = mine.numbers("response_s"),
                                .ink = ink_of(f),
                                .stroke = f == 0 ? Stroke::solid : Stroke::dashed,
                                .mark = Mark::both});
    }
    deciles.caption = "Each person's deciles, then their geometric mean over people.";
    page.figure(deciles);
}

/// What the confidence is worth, where an answer is right or wrong.
void add_calibration(PageWriter& page, const Study& study, const PageNumbers& numbers) {
    PageFigure figure{.id = "confidence",
                      .title = "Is confidence worth something?",
                      .data = study.ask(page_query("confidence"))};
    const Rows& rows = figure.data;
    Panel panel{.title = "share correct at each level",
                .x = {.label = "confidence"},
                .y = {.label = "share correct", .low = 0.0, .high = 1.0}};
    Series dots{.ink = Ink::blue, .mark = Mark::both, .width = 1.0};
    for (std::size_t row = 0; row < rows.cells.size(); ++row) {
        const double level = rows.number(row, "level");
        const double share = rows.number(row, "share");
        if (!std::isfinite(share)) {
            continue;
        }
        dots.add(level, share);
        panel.x.names.emplace_back(level, fmt::format("{:g}", level));
        if (!rows.text(row, "share_low").empty()) {
            panel.series.push_back(interval_bar(level, rows.number(row, "share_low"), level,
                                                rows.number(row, "share_high"), Ink::blue));
        }
    }
    if (dots.x.empty()) {
        return;
    }
    panel.x.low = dots.x.front() - 0.5;
    panel.x.high = dots.x.back() + 0.5;
    panel.series.push_back(std::move(dots));
    figure.panels.push_back(std::move(panel));
    figure.caption =
        "Means over the people who used the level, 95 % intervals over people. Where only one did, "
        "or all had the same share, there is none.";
    if (numbers.stats) {
        figure.results.push_back(tests_of(
            numbers, "Does confidence know? Each person's number, then over people", false));
    }
    page.figure(figure);
}

void add_confidence(PageWriter& page, const Study& study, const PageNumbers& numbers) {
    PageFigure figure{
        .id = "sure", .title = "How sure people were", .data = study.ask(page_query("sure"))};
    if (figure.data.cells.empty()) {
        return;
    }
    PairedPanel pairs = pairs_of(figure.data, "confidence", frictions_of(study));
    pairs.title = "mean confidence";
    pairs.label = "from 1, a guess, to 4, sure";
    figure.panels.push_back(paired_panel(pairs));
    figure.caption =
        "A thin line is a person, a broken one whom the protocol's rules leave out; bars: means "
        "over people with 95 % intervals. Levels are taken as numbers with equal steps.";
    page.figure(figure);
    add_calibration(page, study, numbers);
}

/// Where an answer is neither right nor a yes to what was felt, as of ratings, two intervals and
/// rules, no share of answers means anything: times alone.
void add_learning(PageWriter& page, const Study& study, const PageNumbers& numbers) {
    const char* query = numbers.stats ? "learning" : "learning_times";
    PageFigure figure{
        .id = "learning",
        .title = "From the first trial to the last",
        .data = study.ask(fmt::format("{}\n{}", page_query("tenths"), page_query(query)))};
    if (numbers.stats) {
        const Measure* share = find_measure(numbers.stats->applied, "share");
        Panel answers{.title = share == nullptr ? "" : share->title,
                      .x = {.label = "tenth of a person's trials"},
                      .y = {.label = share == nullptr ? "share" : share->title}};
        add_trend(answers, figure.data, "tenth", "share", "share_low", "share_high");
        figure.panels.push_back(std::move(answers));
        figure.results.push_back(tests_of(numbers, "Slopes within person, against 0", true));
    }
    Panel times{.title = "response time",
                .x = {.label = "tenth of a person's trials"},
                .y = {.label = "geometric mean", .unit = "s"}};
    add_trend(times, figure.data, "tenth", "response_s", "response_low", "response_high");
    figure.caption = "Means over people of each tenth of their main trials, exclusions applied.";
    if (keep_means_visible(times)) {
        figure.caption += " The 95 % band goes beyond the figure: its ends are in the table.";
    }
    figure.panels.push_back(std::move(times));
    page.figure(figure);
}

}  // namespace

void add_times(PageWriter& page, const Study& study, const PageNumbers& numbers) {
    if (study.ask("SELECT 1 FROM main WHERE counts LIMIT 1").cells.empty()) {
        return;
    }
    page.section("times", "Times, confidence, learning");
    add_response_times(page, study, numbers.stats.has_value());
    add_confidence(page, study, numbers);
    add_learning(page, study, numbers);
}

}  // namespace palpate::data
