#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "data/inference/stats_report.hpp"
#include "data/page/sections.hpp"

namespace palpate::data {
namespace {

/// Of pictures the one that was felt, of yes and no what the signals say.
bool is_right(const StatsReport& stats, const std::string& felt, const std::string& called) {
    const auto& signals = stats.options.signals;
    const bool signal = std::ranges::find(signals, felt) != signals.end();
    return stats.right_known && (stats.yes_no ? (called == "yes") == signal : called == felt);
}

std::string matrix_html(const StatsReport& stats,
                        const Rows& rows,
                        const std::string& friction,
                        const std::vector<std::string>& felt,
                        const std::vector<std::string>& called) {
    std::string out = fmt::format(
        "<div class=\"scroll\" role=\"region\" tabindex=\"0\" aria-label=\"Friction {0}\">\n"
        "<table class=\"matrix\"><caption>Friction <strong>{0}</strong>: felt down, called across; "
        "% of the row, and answers</caption>\n<thead><tr><td></td>",
        html_text(friction));
    for (const std::string& one : called) {
        out += fmt::format("<th scope=\"col\">{}</th>", replaced(html_text(one), "_", "_<wbr>"));
    }
    out += "</tr></thead>\n<tbody>\n";
    for (const std::string& of : felt) {
        out += fmt::format("<tr><th scope=\"row\">{}</th>", html_text(of));
        const Rows row = rows.where("friction", friction).where("felt", of);
        for (const std::string& as : called) {
            const Rows cell = row.where("called", as);
            const double share = cell.sum("row_share");
            out += fmt::format("<td{} style=\"--a:{:.2f}\">{:.0f} %<small>{:.0f}</small></td>",
                               is_right(stats, of, as) ? " class=\"right\"" : "", share,
                               100.0 * share, cell.sum("n"));
        }
        out += "</tr>\n";
    }
    return out + "</tbody></table>\n</div>\n";
}

void add_confusion(PageWriter& page, const Study& study, const StatsReport& stats) {
    PageFigure figure{.id = "confusion",
                      .title = "What was felt and what it was called",
                      .data = study.ask(page_query("confusion"))};
    const std::vector<std::string> felt = figure.data.levels("felt");
    std::vector<std::string> called = figure.data.levels("called");
    for (const std::string& one :
         stats.right_known && !stats.yes_no ? felt : std::vector<std::string>{}) {
        if (std::ranges::find(called, one) == called.end()) {
            called.push_back(one);  // nobody called it so, and it would have been right
        }
    }
    std::ranges::stable_sort(called, {}, [&](const std::string& one) {  // what was felt first
        return std::ranges::find(felt, one) - felt.begin();
    });
    figure.html = "<div class=\"matrices\">\n";
    for (const std::string& friction : stats.table.frictions) {
        figure.html += matrix_html(stats, figure.data, friction, felt, called);
    }
    figure.html += "</div>\n";
    figure.caption = fmt::format(
        "Shares of each row, exclusions applied, all people together: they describe, and no test "
        "rests on them. {} the table has the counts without exclusions too.",
        stats.right_known ? "A frame marks the right answer;" : "No answer is right or wrong;");
    page.figure(figure);
}

/// Each person's difference, and the mean of all below them.
Panel difference_panel(const StatsPart& part,
                       const Study& study,
                       const Measure& share,
                       std::size_t friction,
                       const std::string& words) {
    const PeopleTest& effect = *share.effects[friction];
    Panel panel{.title = "difference within person",
                .x = {.label = words},
                .y = {.label = "person", .low = -1.7}};
    Series zero{.x = {0.0, 0.0}, .y = {-1.7, 0.0}, .ink = Ink::grey, .stroke = Stroke::dashed};
    Series dots{.ink = Ink::grey, .mark = Mark::points};
    double y = 0.0;
    std::vector<std::pair<double, std::string>> sorted;
    for (std::size_t i = 0; i < part.people.size(); ++i) {
        const auto& row = share.values[i];
        if (row[0] && row[friction]) {
            sorted.emplace_back(*row[friction] - *row[0], study.person(part.people[i].subject));
        }
    }
    std::ranges::sort(sorted);
    for (const auto& [difference, person] : sorted) {
        dots.add(difference, y);
        panel.y.names.emplace_back(y, person);
        y += 1.0;
    }
    panel.y.names.emplace_back(-1.0, "mean");
    panel.y.high = zero.y[1] = y - 0.3;
    Series mean{.x = {effect.mean.mean}, .y = {-1.0}, .ink = Ink::black, .mark = Mark::points};
    panel.series = {zero, dots, mean};
    if (const auto& ends = effect.mean.interval) {
        panel.series.push_back(interval_bar(ends->low, -1.0, ends->high, -1.0, Ink::black));
    }
    panel.height = std::max(170.0, 15.0 * (y + 2.0));
    return panel;
}

void add_effects(const StatsReport& stats,
                 const PageNumbers& numbers,
                 const StatsPart& part,
                 bool applied,
                 std::vector<Results>& all) {
    const std::string words = applied ? ", exclusions applied" : ", exclusions not applied";
    all.push_back({.table = effects_table(stats, part),
                   .command = numbers.stats_words,
                   .caption = "Differences within person, with 95 % intervals" + words,
                   .folded = !applied});
    all.push_back({.table = means_table(stats, part),
                   .command = numbers.stats_words,
                   .caption = "Means over people with 95 % intervals" + words,
                   .folded = !applied});
}

void add_effect(PageWriter& page, const Study& study, const PageNumbers& numbers) {
    const StatsReport& stats = *numbers.stats;
    const Measure* share = find_measure(stats.applied, "share");
    if (share == nullptr) {
        return;
    }
    PageFigure figure{.id = "effect",
                      .title = stats.right_known ? "Share correct by friction, within person"
                                                 : "Share of yes by friction, within person",
                      .data = study.ask(page_query("shares"))};
    PairedPanel pairs = pairs_of(*share, stats.table.frictions);
    pairs.height = 260.0;
    pairs.left_out = pairs_of(figure.data, "share", stats.table.frictions).left_out;
    Panel panel = paired_panel(pairs);
    if (stats.table.alternatives > 0) {
        const double chance = 1.0 / static_cast<double>(stats.table.alternatives);
        panel.series.push_back(
            {.name = "chance",
             .x = {-0.5, static_cast<double>(stats.table.frictions.size()) - 0.5},
             .y = {chance, chance},
             .ink = Ink::black,
             .stroke = Stroke::dotted});
    }
    figure.panels.push_back(std::move(panel));
    for (std::size_t f = 1; f < share->effects.size(); ++f) {
        if (share->effects[f]) {
            figure.panels.push_back(difference_panel(
                stats.applied, study, *share, f,
                fmt::format("{}, {} \u2212 {}", share->title, stats.table.frictions[f],
                            stats.table.frictions.front())));
        }
    }
    figure.caption =
        "A thin line is a person. Coloured bars, and the black one: means over people with their "
        "95 % intervals (Student's, of shares on the logit; the person is the unit). Broken lines: "
        "people whom the protocol's rules leave out, in no mean.";
    add_effects(stats, numbers, stats.applied, true, figure.results);
    if (stats.not_applied) {
        add_effects(stats, numbers, *stats.not_applied, false, figure.results);
    }
    page.figure(figure);
}

/// Of yes and no with signals.
void add_sensitivity(PageWriter& page, const Study& study, const PageNumbers& numbers) {
    const StatsReport& stats = *numbers.stats;
    if (!stats.yes_no || !stats.right_known) {
        return;
    }
    PageFigure figure{.id = "sensitivity",
                      .title = "Sensitivity and criterion by friction, within person",
                      .data = study.ask(page_query("sensitivity"))};
    for (const char* key : {"d_prime", "criterion"}) {
        const Measure* measure = find_measure(stats.applied, key);
        if (measure == nullptr) {
            return;
        }
        figure.panels.push_back(paired_panel(pairs_of(*measure, stats.table.frictions)));
    }
    figure.caption = fmt::format(
        "Yes is right for {}. d': how well they are distinguished from the others; c: above 0 "
        "rather no. Log-linear correction (Hautus 1995), of the least answers of a person under a "
        "friction. A thin line is a person; bars: means over people with 95 % intervals. Their "
        "tests stand with the effect of friction above.",
        fmt::join(stats.options.signals, ", "));
    page.figure(figure);
}

void add_mixed_model(PageWriter& page, const PageNumbers& numbers) {
    const StatsReport& stats = *numbers.stats;
    if (stats.applied.mixed.empty()) {
        return;
    }
    page.html("<h3 id=\"mixed\">The mixed model</h3>\n");
    page.paragraph(fmt::format(
        "Second to the tests within person: logit of {} with friction, people differing in level "
        "and effect (random intercepts and slopes), exclusions applied.",
        stats.right_known ? "a right answer" : "yes"));
    for (const MixedStats& mixed : stats.applied.mixed) {
        const Fields fields = fields_of(mixed_table(stats, mixed));
        page.html(html_table(fields.names, fields.rows, "Logits; likelihood ratio of no effect"));
        for (const std::string& one : warnings_of(mixed)) {
            page.paragraph("Warning: " + one);
        }
    }
    page.html(fmt::format("<p class=\"from\">The same numbers: <code>{}</code></p>\n",
                          html_text(numbers.stats_words)));
}

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

void add_answers(PageWriter& page, const Study& study, const PageNumbers& numbers) {
    if (!numbers.stats) {
        return;
    }
    page.section("answers", "Answers and the effect of friction");
    add_confusion(page, study, *numbers.stats);
    add_effect(page, study, numbers);
    add_sensitivity(page, study, numbers);
    add_mixed_model(page, numbers);
}

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
