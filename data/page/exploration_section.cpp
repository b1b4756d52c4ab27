#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "protocols/design/object_outline.hpp"
#include "data/page/sections.hpp"

namespace palpate::data {
namespace {

/// People of which the maps show a trial, for each object and friction.
constexpr int kPeopleOfMaps = 2;

std::string of_felt(std::string_view query) {
    return fmt::format("{}\n{}", page_query("felt"), page_query(query));
}

/// Of each object and friction the first interval that counts of the first people that have one.
std::string map_sql() {
    return fmt::format(
        R"({}
, first AS (
    SELECT trial_id, interval, felt_object, friction, person,
           row_number() OVER (PARTITION BY felt_object, friction, person ORDER BY trial_id, interval) AS n
    FROM felt),
shown AS (
    SELECT *, row_number() OVER (PARTITION BY felt_object, friction ORDER BY person) AS place
    FROM first WHERE n = 1)
SELECT felt_object AS felt, friction, count(DISTINCT sample.trial_id) AS trials,
       group_concat(DISTINCT sample.trial_id) AS trial_ids, segment,
       avg(go_x_m) AS x_m, avg(go_y_m) AS y_m, count(*) AS ticks
FROM shown CROSS JOIN sample ON sample.trial_id = shown.trial_id AND sample.interval = shown.interval
WHERE place <= {} AND mode <> 'free'
GROUP BY CAST(go_x_m * 400 + 1000 AS INTEGER), CAST(go_y_m * 400 + 1000 AS INTEGER), segment, friction, felt_object
ORDER BY felt_object, friction, segment, x_m, y_m)",
        page_query("felt"), kPeopleOfMaps);
}

void add_hands(PageWriter& page, const Study& study, const std::vector<std::string>& frictions) {
    PageFigure figure{.id = "hand",
                      .title = "What the hand did",
                      .width = 264.0,
                      .data = study.ask(of_felt("by_person"))};
    struct Column {
        const char* name;
        const char* title;
        const char* unit;
        double factor;
    };
    constexpr Column kColumns[] = {
        {"strokes_before_vertex", "strokes before the vertex", "", 1.0},
        {"strokes_after_vertex", "strokes after the vertex", "", 1.0},
        {"reversals", "reversals", "", 1.0},
        {"stick_events", "stick events", "", 1.0},
        {"vertex_share", "dwell at the vertex", "% of contact", 100.0},
        {"covered_share", "outline covered", "%", 100.0},
        {"speed_p10_m_per_s", "speed, 10 %", "mm/s", 1e3},
        {"speed_p50_m_per_s", "speed, median", "mm/s", 1e3},
        {"speed_p90_m_per_s", "speed, 90 %", "mm/s", 1e3},
        {"normal_force_p10_n", "normal force, 10 %", "N", 1.0},
        {"normal_force_p50_n", "normal force, median", "N", 1.0},
        {"normal_force_p90_n", "normal force, 90 %", "N", 1.0},
    };
    for (const Column& one : kColumns) {
        PairedPanel pairs =
            pairs_of(figure.data, one.name, frictions, Scale::numbers, "", one.factor);
        pairs.title = one.title;
        pairs.unit = one.unit;
        pairs.left_out.clear();
        pairs.height = 150.0;
        figure.panels.push_back(paired_panel(pairs));
    }
    figure.caption =
        "A mean a trial of each person, as pairs; bars: means over people with 95 % "
        "intervals. Trials that count, exclusions applied.";
    page.figure(figure);
}

/// The object's outline, and what was visited: the area of a dot is the time there.
Panel map_panel(const Study& study,
                std::size_t object,
                const std::string& friction,
                std::size_t friction_place,
                const Rows& rows) {
    const std::string& name = study.protocol.objects[object].name;
    Panel panel{.title = name + ", friction " + friction,
                .x = {},
                .y = {},
                .equal_aspect = true,
                .height = 165.0};
    Series outline{.ink = Ink::black, .width = 1.0};
    for (const engine::Vec2& point : protocols::plan_of(study.protocol, object)) {
        outline.add(1e3 * point.x, 1e3 * point.y);
    }
    outline.add(outline.x.front(), outline.y.front());
    panel.series.push_back(std::move(outline));
    const Rows there = rows.where("felt", name).where("friction", friction);
    Series dots{.x = there.numbers("x_m", 1e3),
                .y = there.numbers("y_m", 1e3),
                .ink = ink_of(friction_place),
                .mark = Mark::points,
                .sizes = there.numbers("ticks"),
                .opacity = 0.55};
    const double ticks = there.sum("ticks");
    for (double& size : dots.sizes) {
        size = std::clamp(40.0 * std::sqrt(size / ticks), 0.8, 20.0);
    }
    panel.series.push_back(std::move(dots));
    return panel;
}

void add_maps(PageWriter& page, const Study& study, const std::vector<std::string>& frictions) {
    PageFigure figure{
        .id = "maps", .title = "Where on the object", .width = 400.0, .data = study.ask(map_sql())};
    if (figure.data.cells.empty()) {
        const bool kept = !study.ask(of_felt("kept")).cells.empty();
        page.paragraph(kept ? "Nobody touched the object in the trials that a map would show."
                            : "No ticks are kept of these trials: there is no map of the object.");
        return;
    }
    const auto felt = figure.data.levels("felt");
    for (std::size_t object = 0; object < study.protocol.objects.size(); ++object) {
        for (std::size_t f = 0;
             std::ranges::find(felt, study.protocol.objects[object].name) != felt.end() &&
             f < frictions.size();
             ++f) {
            figure.panels.push_back(map_panel(study, object, frictions[f], f, figure.data));
        }
    }
    figure.caption = fmt::format(
        "mm. The area of a dot is the time that the god-object spent there. Not all trials: for "
        "each "
        "object and friction the first that counts of {} people; trial_ids in the table say which.",
        kPeopleOfMaps);
    page.figure(figure);
}

void add_each_trial(PageWriter& page, const Study& study) {
    const Rows rows = study.ask(of_felt("each_trial"));
    std::string html =
        "<p class=\"from\"><span class=\"bar\" style=\"--a:40%;--b:55%\"></span> contact before "
        "the "
        "vertex, on it, after it. Speeds in mm/s and normal forces in N: the 10 %, 50 % and 90 % "
        "quantiles.</p>\n";
    const auto number = [&](std::size_t row, const char* name, double factor, int digits) {
        const double value = factor * rows.number(row, name);
        return std::isfinite(value) ? fmt::format("{:.{}f}", value, digits) : std::string("\u2013");
    };
    html += "<div class=\"trials\">\n";
    std::string before;
    for (std::size_t row = 0; row < rows.cells.size(); ++row) {
        const std::string& person = rows.text(row, "person");
        if (person != before) {
            html += before.empty() ? "" : "</tbody></table></div></details>\n";
            html += fmt::format(
                "<details><summary>Person {0}</summary>\n<div class=\"scroll\" "
                "role=\"region\" tabindex=\"0\" aria-label=\"Trials of person {0}\"><table>\n"
                "<caption>Person {0}: exploration, trial by trial</caption>\n<thead><tr>",
                html_text(person));
            for (const char* name :
                 {"trial", "felt", "friction", "where", "contact s", "strokes before", "after",
                  "reversals", "sticks", "vertex s", "covered %", "speed", "force"}) {
                html += fmt::format("<th scope=\"col\">{}</th>", name);
            }
            html += "</tr></thead>\n<tbody>\n";
            before = person;
        }
        const std::string bar = html_bar(rows, row);
        html += fmt::format(
            "<tr><th scope=\"row\">{}</th><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td>"
            "<td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{} {} {}</td><td>{} {} "
            "{}</td></tr>\n",
            rows.text(row, "trial_id") +
                (rows.text(row, "interval") == "2" ? ", interval 2" : std::string()),
            html_text(rows.text(row, "felt")), html_text(rows.text(row, "friction")),
            bar.empty() ? "\u2013" : bar, number(row, "contact_s", 1.0, 2),
            number(row, "strokes_before_vertex", 1.0, 0),
            number(row, "strokes_after_vertex", 1.0, 0), number(row, "reversals", 1.0, 0),
            number(row, "stick_events", 1.0, 0), number(row, "vertex_s", 1.0, 2),
            number(row, "covered_share", 100.0, 0), number(row, "speed_p10_m_per_s", 1e3, 0),
            number(row, "speed_p50_m_per_s", 1e3, 0), number(row, "speed_p90_m_per_s", 1e3, 0),
            number(row, "normal_force_p10_n", 1.0, 2), number(row, "normal_force_p50_n", 1.0, 2),
            number(row, "normal_force_p90_n", 1.0, 2));
    }
    html += before.empty() ? "</div>\n" : "</tbody></table></div></details>\n</div>\n";
    PageFigure panel{.id = "trials",
                     .title = "Each trial",
                     .html = std::move(html),
                     .has_table = true,
                     .data = rows};
    panel.caption = fmt::format(
        "Answered main trials that count, also of people who are left out. One with its path and "
        "every tick: palpate report {} --trial {} -o trial.html",
        study.file, rows.cells.empty() ? "7" : rows.text(0, "trial_id"));
    page.figure(panel);
}

}  // namespace

void add_exploration(PageWriter& page, const Study& study) {
    page.section("exploration", "Exploration");
    const std::vector<std::string> frictions = frictions_of(study);
    add_hands(page, study, frictions);
    add_maps(page, study, frictions);
    add_each_trial(page, study);
}

}  // namespace palpate::data
