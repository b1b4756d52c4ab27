// Figures 3.2.2 to 3.2.4: forces, coefficient and parameters over the pre-determined path.
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "tests/figures/drawing.hpp"
#include "tests/figures/friction_run.hpp"
#include "tests/figures/make.hpp"

namespace palpate::figures {
namespace {

using engine::Mode;

struct Runs {
    FrictionRun gos;
    FrictionRun latched;
    FrictionMarkers markers;          ///< of gos
    FrictionMarkers latched_markers;  ///< of latched
};

Runs both() {
    const auto path = friction_path();
    Runs runs{.gos = felt_by_gos(path),
              .latched = felt_by_thesis(path, true),
              .markers = {},
              .latched_markers = {}};
    runs.markers = find_markers(runs.gos);
    runs.latched_markers = find_markers(runs.latched);
    return runs;
}

template <class Value>
Series over_time(std::string name, const FrictionRun& run, Value&& value) {
    Series series{.name = std::move(name)};
    for (const FrictionTick& tick : run) {
        series.x.push_back(tick.t);
        series.y.push_back(value(tick));
    }
    return series;
}

template <class Value>
std::vector<data::Marker> numbered(const Runs& runs, Value&& value) {
    std::vector<data::Marker> out;
    for (std::size_t k = 0; k < runs.markers.size(); ++k) {
        if (runs.markers[k]) {
            const FrictionTick& tick = runs.gos[*runs.markers[k]];
            out.push_back({tick.t, value(tick), std::to_string(k + 1)});
        }
    }
    return out;
}

double size_of_friction(const FrictionTick& tick) {
    return std::fabs(tick.friction_force);
}

double size_of_force(const FrictionTick& tick) {
    return glm::length(tick.force);
}

Series compared(Series series) {
    series.ink = Ink::vermillion;
    series.stroke = Stroke::dashed;
    series.width = 1.2;
    return series;
}

Panel time_panel(std::string title, std::string what, std::string unit, double height) {
    return {.title = std::move(title),
            .x = {.label = "time", .unit = "s"},
            .y = {.label = std::move(what), .unit = std::move(unit)},
            .height = height};
}

double at_marker(const Runs& runs, std::size_t number, double (*value)(const FrictionTick&)) {
    const auto& at = runs.markers[number - 1];
    return at ? value(runs.gos[*at]) : std::numeric_limits<double>::quiet_NaN();
}

/// The instants as a table: number and time by each law, empty where a law has none.
std::vector<CsvColumn> marker_table(const Runs& runs) {
    std::vector<CsvColumn> table{{"marker", {}}, {"gos_time_s", {}}, {"thesis_latched_time_s", {}}};
    for (std::size_t k = 0; k < runs.markers.size(); ++k) {
        const auto time = [](const FrictionRun& run, const std::optional<std::size_t>& at) {
            return at ? run[*at].t : std::numeric_limits<double>::quiet_NaN();
        };
        table[0].values.push_back(static_cast<double>(k + 1));
        table[1].values.push_back(time(runs.gos, runs.markers[k]));
        table[2].values.push_back(time(runs.latched, runs.latched_markers[k]));
    }
    return table;
}

void add_run(std::vector<CsvColumn>& table, const std::string& law, const FrictionRun& run) {
    using Tick = FrictionTick;
    table.push_back(
        column(law + "_mode", run, [](const Tick& t) { return static_cast<int>(t.mode); }));
    table.push_back(
        column(law + "_friction_n", run, [](const Tick& t) { return t.friction_force; }));
    table.push_back(column(law + "_normal_n", run, [](const Tick& t) { return t.normal_force; }));
    table.push_back(column(law + "_force_x_n", run, [](const Tick& t) { return t.force.x; }));
    table.push_back(column(law + "_force_y_n", run, [](const Tick& t) { return t.force.y; }));
    table.push_back(column(law + "_mu", run, [](const Tick& t) { return t.mu; }));
}

std::vector<CsvColumn> time_column(const Runs& runs) {
    return {column("time_s", runs.gos, [](const FrictionTick& t) { return t.t; })};
}

/// Does Algorithm 1 as written go from slipping to stuck while HIP presses deeper?
bool literal_sticks_while_pressed(const Runs& runs) {
    const FrictionRun literal = felt_by_thesis(friction_path(), false);
    const auto from = runs.markers[2];
    const auto to = runs.markers[4];
    for (std::size_t i = from.value_or(1); to && i <= *to; ++i) {
        if (literal[i].mode == Mode::stuck) {
            return true;
        }
    }
    return false;
}

/// |F_T| / F_N of the thesis' law at instant 8: sliding on, after it has stuck and slipped again.
double late_ratio(const Runs& runs) {
    const FrictionTick& tick = runs.latched[runs.markers[7].value_or(0)];
    return size_of_friction(tick) / tick.normal_force;
}

std::string forces_caption(const Runs& runs) {
    const std::size_t from = runs.markers[10].value_or(1);
    const auto fired = runs.latched_markers[3];
    return fmt::format(
        "K = 1000 N/m, μ_s = 0.7, μ_d = 0.5, ticks of 1 ms. Numbers are found in our run: 1 HIP "
        "begins to move along, 2 GO breaks away, 3 HIP presses deeper, 4 GO sticks, 5 it is "
        "pressed no deeper, 6 GO breaks away, 7 μ is relaxed, 8 HIP leaves, 9 to 10 no contact, "
        "11 level towards the second curve, 12 GO breaks away, 13 μ is relaxed. Three things "
        "differ from what the thesis tells. Between 3 and 5 nothing drags the contact along, so "
        "friction keeps its value ({:.3f} N at 3, {:.3f} N at 5; on a straight edge the two "
        "would be the same) while the load rises; the thesis' law multiplies the load and lets "
        "friction climb. Sticking follows pressing at once (4 lies on 3); Algorithm 1 as written "
        "{} between 3 and 5, since it asks for 40 % more load within a tick; read as load since "
        "slipping began, it sticks at {:.2f} N, then keeps an offset, so that at 8 friction is "
        "{:.2f} times the load. Over the vertex no law is free of change: from 11 on, the "
        "largest step of the force in a tick is {:.2f} N for ours, whose god-object turns "
        "through the vertex at a limited rate, and {:.2f} N for the thesis'.",
        at_marker(runs, 3, &size_of_friction), at_marker(runs, 5, &size_of_friction),
        literal_sticks_while_pressed(runs) ? "sticks" : "never sticks",
        fired ? runs.latched[*fired].normal_force : 0.0, late_ratio(runs),
        largest_jump(runs.gos, from, runs.gos.size() - 1),
        largest_jump(runs.latched, from, runs.latched.size() - 1));
}

/// u of a place, with a gap where it passes to another curve.
template <class Curve, class Parameter>
Series parameter_series(std::string name, const FrictionRun& run, Curve&& curve, Parameter&& u) {
    Series series{.name = std::move(name)};
    for (std::size_t i = 0; i < run.size(); ++i) {
        if (i > 0 && curve(run[i]) != curve(run[i - 1])) {
            series.x.push_back(run[i].t);
            series.y.push_back(std::numeric_limits<double>::quiet_NaN());
        }
        series.x.push_back(run[i].t);
        series.y.push_back(u(run[i]));
    }
    return series;
}

Panel places_panel(std::string title, const FrictionRun& run) {
    Panel panel = time_panel(std::move(title), "u", "", 230.0);
    panel.y.low = -0.03;
    panel.y.high = 1.08;
    panel.series = {parameter_series(
                        "closest point", run, [](const FrictionTick& t) { return t.cp_curve; },
                        [](const FrictionTick& t) { return t.cp_u; }),
                    parameter_series(
                        "god-object", run, [](const FrictionTick& t) { return t.go_curve; },
                        [](const FrictionTick& t) { return t.go_u; })};
    panel.series[0].ink = Ink::sky;
    panel.series[0].width = 3.0;
    panel.series[1].ink = Ink::black;
    return panel;
}

}  // namespace

MadeFigure make_friction_forces() {
    const Runs runs = both();
    Panel friction = time_panel("(a) Friction force", "|F_T|", "N", 270.0);
    friction.series = {over_time("ours (god-object spring)", runs.gos, &size_of_friction),
                       compared(over_time("thesis, latched", runs.latched, &size_of_friction))};
    friction.markers = numbered(runs, &size_of_friction);
    Panel total = time_panel("(b) Total force", "|F|", "N", 270.0);
    total.series = {over_time("ours (god-object spring)", runs.gos, &size_of_force),
                    compared(over_time("thesis, latched", runs.latched, &size_of_force))};
    total.markers = numbered(runs, &size_of_force);
    Figure figure{.id = "fig_3_2_2",
                  .title = "Figure 3.2.2: friction and total force over the pre-determined path",
                  .panels = {friction, total},
                  .caption = forces_caption(runs),
                  .width = 980.0};
    std::vector<CsvColumn> table = time_column(runs);
    add_run(table, "gos", runs.gos);
    add_run(table, "thesis_latched", runs.latched);
    return {svg(figure), {{"", table}, {"_markers", marker_table(runs)}}};
}

MadeFigure make_stribeck() {
    const Runs runs = both();
    const auto mu = [](const FrictionTick& t) {
        return t.mode == Mode::free ? std::numeric_limits<double>::quiet_NaN() : t.mu;
    };
    Panel panel = time_panel("", "coefficient of friction μ", "", 280.0);
    panel.y.low = 0.47;
    panel.y.high = 0.74;
    panel.series = {over_time("ours (god-object spring)", runs.gos, mu),
                    compared(over_time("thesis, latched", runs.latched, mu))};
    panel.markers = numbered(runs, mu);
    const FrictionTick& end = runs.latched[runs.markers[7].value_or(0)];
    Figure figure{.id = "fig_3_2_3",
                  .title = "Figure 3.2.3: the coefficient of friction over the path",
                  .panels = {panel},
                  .caption = "",
                  .width = 980.0};
    figure.caption = fmt::format(
        "While GO moves, our μ falls from μ_s to μ_d with a time constant of {:g} ms; while it "
        "rests, μ heals with {:g} ms. The thesis takes μ from how far GO lags behind the closest "
        "point: at 8, sliding on at 20 mm/s, its μ still stands at {:.3f}, and would stand "
        "higher the faster the hand goes, the opposite of the Stribeck effect. Gaps: no contact.",
        1e3 * kFrictionSlip, 1e3 * kFrictionHeal, end.mu);
    std::vector<CsvColumn> table = time_column(runs);
    table.push_back(column("gos_mu", runs.gos, mu));
    table.push_back(column("thesis_latched_mu", runs.latched, mu));
    return {svg(figure), {{"", table}, {"_markers", marker_table(runs)}}};
}

MadeFigure make_places() {
    const Runs runs = both();
    Panel ours = places_panel("(a) Ours (god-object spring)", runs.gos);
    ours.markers = numbered(runs, [](const FrictionTick& t) { return t.go_u; });
    const Panel theirs = places_panel("(b) Thesis, latched", runs.latched);
    Figure figure{.id = "fig_3_2_4",
                  .title = "Figure 3.2.4: parameters of god-object and closest point",
                  .panels = {ours, theirs},
                  .caption = "",
                  .width = 980.0};
    figure.caption =
        "u from 0 to 1 on each curve. GO stands while stuck, and the closest point goes ahead. "
        "Under our law GO then follows at the distance that friction keeps, μ times the load "
        "over the stiffness, as long as HIP slides; under the thesis' law the two come together. "
        "From 11 on the closest point passes to the second curve (u drops to near 0) while GO is "
        "still stuck on the first: crossing into another Voronoi region does not free it. After "
        "12 our GO walks to the end of its own curve and round the vertex; the thesis puts it on "
        "the second curve at once.";
    std::vector<CsvColumn> table = time_column(runs);
    for (const auto& [law, run] :
         {std::pair{"gos", &runs.gos}, {"thesis_latched", &runs.latched}}) {
        using Tick = FrictionTick;
        const std::string name(law);
        table.push_back(
            column(name + "_mode", *run, [](const Tick& t) { return static_cast<int>(t.mode); }));
        table.push_back(column(name + "_cp_curve", *run, [](const Tick& t) { return t.cp_curve; }));
        table.push_back(column(name + "_cp_u", *run, [](const Tick& t) { return t.cp_u; }));
        table.push_back(column(name + "_go_curve", *run, [](const Tick& t) { return t.go_curve; }));
        table.push_back(column(name + "_go_u", *run, [](const Tick& t) { return t.go_u; }));
    }
    return {svg(figure), {{"", table}, {"_markers", marker_table(runs)}}};
}

}  // namespace palpate::figures
