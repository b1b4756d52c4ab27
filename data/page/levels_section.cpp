#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "data/analysis/summary.hpp"
#include "data/fit/fit_report.hpp"
#include "data/page/sections.hpp"
#include "data/store/analysed.hpp"

namespace palpate::data {
namespace {

Results fit_results(const PageNumbers& numbers) {
    Results results{.command = numbers.fit_words,
                    .caption = "Thresholds, JND and slopes with 95 % intervals"};
    for (const FittedCurve& curve : numbers.fit->curves) {
        Table table = estimates_table(*numbers.fit, curve);
        for (auto& row : table.rows) {
            row.insert(row.begin(), {curve.answers.participant, curve.answers.condition});
            row.push_back(single_answers(curve) ? Cell(Nothing{kNoGoodness.data()})
                                                : cell_of(curve.samples.deviance_p));
            results.table.rows.push_back(std::move(row));
        }
        results.table.columns = std::move(table.columns);
    }
    auto& columns = results.table.columns;
    columns.insert(columns.begin(), {{.key = "person"}, {.key = "condition"}});
    columns.push_back({.key = "deviance_p"});
    return results;
}

void add_curves(PageWriter& page, const Study& study, const PageNumbers& numbers) {
    const FitReport& fit = *numbers.fit;
    PageFigure figure{.id = "curves", .title = "Psychometric functions"};
    figure.data = study.ask(fmt::format(
        "SELECT person, condition, stimulus, count(*) AS n, sum(k) AS k, avg(k) AS share\nFROM "
        "({}) JOIN person USING (participant_code)\nWHERE study_name = {{study}} AND session_kind "
        "= {{kind}}\nGROUP BY person, condition, stimulus ORDER BY person, condition, stimulus",
        kGradedAnswers));
    figure.panels = fit_figure(fit).panels;
    for (Panel& panel : figure.panels) {
        panel.title = "person " + panel.title;
        panel.y.label = study.protocol.response.kind == protocols::ResponseKind::two_interval
                          ? "share, comparison named"
                          : "share of yes";
    }
    figure.caption = fmt::format(
        "Dots: shares of the answers at each level, larger for more of them. Lines: {} functions, "
        "guess {}, lapse {}. Bands: "
        "95 % of {} bootstrap samples at each level. Bars: profile intervals of the thresholds.",
        word_of(fit.options.spec.family), guess_text(fit.options.spec),
        lapse_text(fit.options.spec), fit.options.bootstrap);
    figure.results.push_back(fit_results(numbers));
    if (!fit.curves.empty()) {
        page.figure(figure);
    }
    for (const NotFitted& one : fit.left_out) {
        page.paragraph("Not fitted: " + text_of(one));
    }
    for (const OverPeople& one : fit.people) {
        if (!one.left_out.empty()) {
            page.paragraph(fmt::format(
                "Mean {} over {}; {}.{}", one.what, counted(one.mean.people, "person", "people"),
                without_text(one.left_out),
                one.median ? fmt::format(" Median of all, what is unbounded by its rank: {:.4g}.",
                                         *one.median)
                           : std::string()));
        }
    }
    for (const FittedCurve& curve : fit.curves) {
        for (const std::string& one : warnings_of(fit, curve)) {
            page.paragraph(fmt::format(
                "Person {}: {}", name_of(curve.answers.participant, curve.answers.condition), one));
        }
    }
}

/// @param conditions  of the fit, whose colours the runs have
void add_tracks(PageWriter& page, const Study& study, const std::vector<std::string>& conditions) {
    const bool constant = constant_stimuli(study.protocol);
    PageFigure figure{
        .id = "tracks",
        .title = constant ? "Levels in the order in which they came" : "Adaptive tracks",
        .data = study.ask(page_query("tracks"))};
    std::vector<std::string> runs = figure.data.levels("run_name");
    std::ranges::sort(runs, {}, [&](const std::string& run) {  // in the fit's colours
        return std::pair(std::ranges::find(conditions, run), run);
    });
    const std::vector<std::string> people = figure.data.levels("person");
    bool estimates = false;
    for (const std::string& person : people) {
        Panel& panel = figure.panels.emplace_back();
        panel = {.title = "person " + person,
                 .x = {.label = "answer of the run"},
                 .y = {.label = stimulus_text(study.protocol)},
                 .height = 170.0};
        for (std::size_t run = 0; run < runs.size(); ++run) {
            Series track{.name = runs[run], .ink = ink_of(run), .mark = Mark::both, .width = 1.0};
            Series estimate{.ink = ink_of(run), .stroke = Stroke::dashed};
            const Rows rows = figure.data.where("person", person).where("run_name", runs[run]);
            for (std::size_t row = 0; row < rows.cells.size(); ++row) {
                const double at = rows.number(row, "run_trial_number");
                const bool again = !track.x.empty() && at <= track.x.back();
                if (again) {  // the next session
                    track.gap();
                }
                track.add(at, rows.number(row, "stimulus"));
                estimate.add(again ? std::nan("") : at, rows.number(row, "estimate"));
                estimates = estimates || std::isfinite(estimate.y.back());
            }
            track.sizes.assign(track.x.size(), 2.0);
            panel.series.push_back(std::move(track));
            panel.series.push_back(std::move(estimate));
        }
    }
    figure.caption = estimates ? "Levels that each run's rule chose; broken: what the rule "
                                 "believed after each answer."
                   : constant  ? "Levels of each run, in an order drawn for it, whatever was "
                                 "answered."
                               : "Levels that each run's rule chose.";
    if (!figure.panels.empty()) {
        page.figure(figure);
    }
}

}  // namespace

void add_levels(PageWriter& page, const Study& study, const PageNumbers& numbers) {
    if (!numbers.fit && !study.protocol.procedure) {
        return;
    }
    page.section("levels", "Psychometric functions and tracks");
    if (numbers.fit) {
        add_curves(page, study, numbers);
    }
    if (study.protocol.procedure) {
        add_tracks(page, study, numbers.fit ? numbers.fit->conditions : std::vector<std::string>());
    }
}

}  // namespace palpate::data
