// Figure 3.2.1: the pre-determined path, and HIP and god-object at moments of it.
#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "tests/figures/drawing.hpp"
#include "tests/figures/friction_run.hpp"
#include "tests/figures/make.hpp"

namespace palpate::figures {
namespace {

using engine::Vec2;

constexpr double kPerNewton = 1.5;  // mm of a drawn force
constexpr double kEnds = 0.014;     // m, length of a drawn end normal
constexpr double kHalfView = 13.0;  // mm, of a snapshot

/// Normals at the ends of both curves: the borders of their external regions.
Series end_normals(const std::vector<engine::NurbsCurve<2>>& curves) {
    std::vector<Vec2> lines;
    for (const auto& curve : curves) {
        for (const double u : {curve.front(), curve.back()}) {
            const engine::Jet<2> jet = curve.at(u);
            const Vec2 n = engine::perp(jet.first) / glm::length(jet.first);
            lines.insert(lines.end(), {jet.point, jet.point + kEnds * n, gap()});
        }
    }
    Series series = path_mm("normals at the ends", lines);
    series.ink = Ink::grey;
    series.stroke = Stroke::dashed;
    series.width = 1.1;
    return series;
}

std::vector<Vec2> places(const FrictionRun& run, Vec2 FrictionTick::*what) {
    std::vector<Vec2> out;
    for (const FrictionTick& tick : run) {
        out.push_back(tick.*what);
    }
    return out;
}

/// One moment: its letter, which tick, and what happens.
struct Moment {
    std::string letter;
    std::size_t tick = 0;
    std::string what;
};

std::size_t between(const FrictionMarkers& at, std::size_t a, std::size_t b, double share = 0.5) {
    const auto from = static_cast<double>(at[a - 1].value_or(0));
    const auto to = static_cast<double>(at[b - 1].value_or(0));
    return static_cast<std::size_t>(from + share * (to - from));
}

std::vector<Moment> moments(const FrictionRun& run, const FrictionMarkers& at) {
    const auto tick = [&](std::size_t number) {
        return at[number - 1].value_or(0);
    };
    return {{"b", 0, "HIP outside"},
            {"c", tick(1), "pressed in (1)"},
            {"d", between(at, 1, 2), "stuck (1 to 2)"},
            {"e", between(at, 2, 3), "sliding (2 to 3)"},
            {"f", between(at, 3, 5), "pressed deeper (3 to 5)"},
            {"g", between(at, 5, 6), "stuck again (5 to 6)"},
            {"h", between(at, 7, 8), "sliding (7 to 8)"},
            {"i", between(at, 9, 10, 0.95), "out (9 to 10)"},
            {"j", tick(11), "pressed in near the vertex (11)"},
            {"k", tick(12) - 1, "stuck past the border (to 12)"},
            {"l", std::min(tick(13) + 200, run.size() - 1), "on the second curve (after 13)"}};
}

Panel snapshot(const std::vector<engine::NurbsCurve<2>>& curves,
               const FrictionRun& run,
               const Moment& moment) {
    const FrictionTick& now = run[moment.tick];
    Panel panel = plane_mm(fmt::format("({}) {}", moment.letter, moment.what), 200.0);
    Series trace =
        path_mm("path of HIP so far",
                places({run.begin(), run.begin() + static_cast<std::ptrdiff_t>(moment.tick + 1)},
                       &FrictionTick::hip));
    trace.ink = Ink::grey;
    trace.width = 1.0;
    const std::array<Vec2, 1> hip{now.hip};
    const std::array<Vec2, 1> go{now.go};
    const std::array<Vec2, 1> cp{now.cp};
    Series hip_dot = dots_mm("HIP", hip);
    hip_dot.ink = Ink::vermillion;
    Series go_dot = dots_mm("GO", go);
    go_dot.ink = Ink::blue;
    Series cp_dot = dots_mm("CP", cp);
    cp_dot.ink = Ink::orange;
    Series object = outline_mm(curves);
    object.name = "";
    trace.name = "";
    panel.series = {object, trace, cp_dot, hip_dot, go_dot};
    if (glm::length(now.force) > 0.0) {
        panel.arrows.push_back({kMillimetres * now.hip.x, kMillimetres * now.hip.y,
                                kPerNewton * now.force.x, kPerNewton * now.force.y, "force",
                                Ink::green});
    }
    const Vec2 middle = 0.5 * kMillimetres * (now.hip + now.go);
    panel.x.low = middle.x - kHalfView;
    panel.x.high = middle.x + kHalfView;
    panel.y.low = middle.y - kHalfView * 0.7;
    panel.y.high = middle.y + kHalfView * 0.9;
    return panel;
}

}  // namespace

MadeFigure make_friction_path() {
    const Polygons object = tests::two_polygons();
    const auto curves = curves_of(object);
    const FrictionRun run = felt_by_gos(friction_path());
    const FrictionMarkers at = find_markers(run);
    Panel panel = plane_mm("", 430.0);
    panel.series = control_points_mm(object);
    panel.series.push_back(outline_mm(curves));
    panel.series.push_back(end_normals(curves));
    Series go = path_mm("GO in contact", {});
    for (const FrictionTick& tick : run) {
        const Vec2 p = tick.mode == engine::Mode::free ? gap() : kMillimetres * tick.go;
        go.x.push_back(p.x);
        go.y.push_back(p.y);
    }
    go.ink = Ink::sky;
    go.width = 4.0;
    panel.series.push_back(go);
    Series hip = path_mm("HIP", places(run, &FrictionTick::hip));
    hip.ink = Ink::vermillion;
    panel.series.push_back(hip);
    for (std::size_t k = 0; k < at.size(); ++k) {
        if (at[k]) {
            const Vec2 p = kMillimetres * run[*at[k]].hip;
            panel.markers.push_back({p.x, p.y, std::to_string(k + 1)});
        }
    }
    panel.y.low = 8.0;
    panel.y.high = 46.0;
    panel.x.low = -52.0;
    panel.x.high = 52.0;
    Figure figure{
        .id = "fig_3_2_1",
        .title = "Figure 3.2.1 (a): the object of two curves and the pre-determined path",
        .panels = {panel},
        .caption =
            "Two convex cubics of four control points each meet at a vertex of 22 degrees. HIP "
            "goes in along the normal (to 1), along at constant depth (to 3), deeper along the "
            "normal (to 5), along (to 8) and out; then in near the vertex (10 to 11) and level "
            "over it. Numbers are instants of our run (figure 3.2.2). The thick line is where "
            "the god-object went while in contact.",
        .width = 980.0};
    std::vector<CsvColumn> table{
        column("time_s", run, [](const FrictionTick& t) { return t.t; }),
        column("hip_x_m", run, [](const FrictionTick& t) { return t.hip.x; }),
        column("hip_y_m", run, [](const FrictionTick& t) { return t.hip.y; }),
        column("go_x_m", run, [](const FrictionTick& t) { return t.go.x; }),
        column("go_y_m", run, [](const FrictionTick& t) { return t.go.y; }),
        column("mode", run, [](const FrictionTick& t) { return static_cast<int>(t.mode); })};
    return {svg(figure), {{"", table}, {"_object", control_point_table(object)}}};
}

MadeFigure make_friction_moments() {
    const auto curves = curves_of(tests::two_polygons());
    const FrictionRun run = felt_by_gos(friction_path());
    const std::vector<Moment> at = moments(run, find_markers(run));
    Figure figure{
        .id = "fig_3_2_1_snapshots",
        .title = "Figure 3.2.1 (b) to (l): HIP and god-object at moments of the path",
        .panels = {},
        .columns = 3,
        .share_x = false,
        .caption =
            "GO is on the surface, HIP where the hand is; the force on the user goes from HIP "
            "towards GO, 1.5 mm a newton. Grey: where HIP has been. In (k) the closest point "
            "(CP) is on the second curve already, and GO still stands on the first.",
        .width = 1080.0};
    std::vector<CsvColumn> table{{"time_s", {}},    {"hip_x_m", {}}, {"hip_y_m", {}},
                                 {"go_x_m", {}},    {"go_y_m", {}},  {"force_x_n", {}},
                                 {"force_y_n", {}}, {"mode", {}}};
    for (const Moment& moment : at) {
        const FrictionTick& t = run[moment.tick];
        figure.panels.push_back(snapshot(curves, run, moment));
        const std::array<double, 8> row{t.t,    t.hip.x,   t.hip.y,   t.go.x,
                                        t.go.y, t.force.x, t.force.y, static_cast<double>(t.mode)};
        for (std::size_t i = 0; i < row.size(); ++i) {
            table[i].values.push_back(row[i]);
        }
    }
    return {svg(figure), {{"", table}}};
}

}  // namespace palpate::figures
