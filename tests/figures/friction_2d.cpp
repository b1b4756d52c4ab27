// Figures 3.2.2 to 3.2.4: forces, coefficient and parameters over the pre-determined path.
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

/// Value of each instant of ours.
template <class Value>
std::vector<data::Marker> marked(const Runs& runs, const Value& value) {
    return numbered(runs.markers, [&](std::size_t i) {
        return engine::Vec2{runs.gos[i].t, std::invoke(value, runs.gos[i])};
    });
}

/// Ours, and the thesis' law to compare.
template <class Value>
std::vector<Series> both_over_time(const Runs& runs, const Value& value) {
    return {
        over_time("ours (god-object spring)", runs.gos, value),
        over_time("thesis, latched", runs.latched, value, {Ink::vermillion, 1.2, Stroke::dashed})};
}

double size_of_friction(const FrictionTick& tick) {
    return std::fabs(tick.friction_force);
}

double size_of_force(const FrictionTick& tick) {
    return glm::length(tick.force);
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
        add_row(table, {static_cast<double>(k + 1), time(runs.gos, runs.markers[k]),
                        time(runs.latched, runs.latched_markers[k])});
    }
    return table;
}

void add_run(std::vector<CsvColumn>& table, const std::string& law, const FrictionRun& run) {
    table.push_back(column(law + "_mode", run, &FrictionTick::mode));
    table.push_back(column(law + "_friction_n", run, &FrictionTick::friction_force));
    table.push_back(column(law + "_normal_n", run, &FrictionTick::normal_force));
    add_vectors(table, law + "_force", "n", run, &FrictionTick::force);
    table.push_back(column(law + "_mu", run, &FrictionTick::mu));
}

std::vector<CsvColumn> time_column(const Runs& runs) {
    return {column("time_s", runs.gos, &FrictionTick::t)};
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
Series parameter_series(std::string name,
                        const FrictionRun& run,
                        std::size_t FrictionTick::*curve,
                        double FrictionTick::*u,
                        const Look& look) {
    Series series{.name = std::move(name)};
    for (std::size_t i = 0; i < run.size(); ++i) {
        if (i > 0 && run[i].*curve != run[i - 1].*curve) {
            series.add(run[i].t, std::numeric_limits<double>::quiet_NaN());
        }
        series.add(run[i].t, run[i].*u);
    }
    return with_look(std::move(series), look);
}

Panel places_panel(std::string title, const FrictionRun& run) {
    Panel panel = time_panel(std::move(title), "u", "", 230.0);
    panel.y.low = -0.03;
    panel.y.high = 1.08;
    panel.series = {parameter_series("closest point", run, &FrictionTick::cp_curve,
                                     &FrictionTick::cp_u, {Ink::sky, 3.0}),
                    parameter_series("god-object", run, &FrictionTick::go_curve,
                                     &FrictionTick::go_u, {Ink::black})};
    return panel;
}

}  // namespace

MadeFigure make_friction_forces() {
    const Runs runs = both();
    Panel friction = time_panel("(a) Friction force", "|F_T|", "N", 270.0);
    friction.series = both_over_time(runs, &size_of_friction);
    friction.markers = marked(runs, &size_of_friction);
    Panel total = time_panel("(b) Total force", "|F|", "N", 270.0);
    total.series = both_over_time(runs, &size_of_force);
    total.markers = marked(runs, &size_of_force);
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
    panel.series = both_over_time(runs, mu);
    panel.markers = marked(runs, mu);
    const FrictionTick& end = runs.latched[runs.markers[7].value_or(0)];
    Figure figure{.id = "fig_3_2_3",
                  .title = "Figure 3.2.3: the coefficient of friction over the path",
                  .panels = {panel},
                  .width = 980.0};
    figure.caption = fmt::format(
        "While GO moves, our μ falls from μ_s to μ_d with a time constant of {:g} ms; while it "
        "rests, μ heals with {:g} ms. The thesis takes μ from how far GO lags behind the closest "
        "point: at 8, sliding on at 20 mm/s, its μ still stands at {:.3f}, and would stand "
        "higher the faster the hand goes, the opposite of the Stribeck effect. Gaps: no contact.",
        1e3 * tests::kStudyFriction.tau_slip, 1e3 * tests::kStudyFriction.tau_heal, end.mu);
    std::vector<CsvColumn> table = time_column(runs);
    table.push_back(column("gos_mu", runs.gos, mu));
    table.push_back(column("thesis_latched_mu", runs.latched, mu));
    return {svg(figure), {{"", table}, {"_markers", marker_table(runs)}}};
}

MadeFigure make_places() {
    const Runs runs = both();
    Panel ours = places_panel("(a) Ours (god-object spring)", runs.gos);
    ours.markers = marked(runs, &FrictionTick::go_u);
    const Panel theirs = places_panel("(b) Thesis, latched", runs.latched);
    Figure figure{.id = "fig_3_2_4",
                  .title = "Figure 3.2.4: parameters of god-object and closest point",
                  .panels = {ours, theirs},
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
        const std::string name(law);
        table.push_back(column(name + "_mode", *run, &FrictionTick::mode));
        table.push_back(column(name + "_cp_curve", *run, &FrictionTick::cp_curve));
        table.push_back(column(name + "_cp_u", *run, &FrictionTick::cp_u));
        table.push_back(column(name + "_go_curve", *run, &FrictionTick::go_curve));
        table.push_back(column(name + "_go_u", *run, &FrictionTick::go_u));
    }
    return {svg(figure), {{"", table}, {"_markers", marker_table(runs)}}};
}

}  // namespace palpate::figures
