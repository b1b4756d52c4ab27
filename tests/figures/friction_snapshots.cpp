// Figure 3.2.1: the pre-determined path, and HIP and god-object at moments of it.
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
    return path_mm("normals at the ends", lines, {Ink::grey, 1.1, Stroke::dashed});
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
    std::vector<Vec2> so_far;
    for (std::size_t i = 0; i <= moment.tick; ++i) {
        so_far.push_back(run[i].hip);
    }
    panel.series = {outline_mm(curves), path_mm("", so_far, {Ink::grey, 1.0}),
                    dot_mm("CP", now.cp, Ink::orange), dot_mm("HIP", now.hip, Ink::vermillion),
                    dot_mm("GO", now.go, Ink::blue)};
    panel.series.front().name = "";
    if (glm::length(now.force) > 0.0) {
        panel.arrows.push_back({kMillimetres * now.hip.x, kMillimetres * now.hip.y,
                                kPerNewton * now.force.x, kPerNewton * now.force.y, "force",
                                Ink::green});
    }
    const Vec2 middle = 0.5 * kMillimetres * (now.hip + now.go);
    look_at(panel, middle.x - kHalfView, middle.x + kHalfView, middle.y - kHalfView * 0.7,
            middle.y + kHalfView * 0.9);
    return panel;
}

}  // namespace

MadeFigure make_friction_path() {
    const Polygons object = tests::two_polygons();
    const auto curves = curves_of(object);
    const FrictionRun run = felt_by_gos(friction_path());
    Panel panel = plane_mm("", 430.0);
    panel.series = control_points_mm(object);
    panel.series.push_back(outline_mm(curves));
    panel.series.push_back(end_normals(curves));
    std::ranges::move(go_and_hip(run, std::identity()), std::back_inserter(panel.series));
    panel.markers =
        numbered(find_markers(run), [&](std::size_t i) { return kMillimetres * run[i].hip; });
    look_at(panel, -52.0, 52.0, 8.0, 46.0);
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
    std::vector<CsvColumn> table{column("time_s", run, &FrictionTick::t)};
    add_vectors(table, "hip", "m", run, &FrictionTick::hip);
    add_vectors(table, "go", "m", run, &FrictionTick::go);
    table.push_back(column("mode", run, &FrictionTick::mode));
    return {svg(figure), {{"", table}, {"_object", control_point_table(object)}}};
}

MadeFigure make_friction_moments() {
    const auto curves = curves_of(tests::two_polygons());
    const FrictionRun run = felt_by_gos(friction_path());
    const std::vector<Moment> at = moments(run, find_markers(run));
    Figure figure{
        .id = "fig_3_2_1_snapshots",
        .title = "Figure 3.2.1 (b) to (l): HIP and god-object at moments of the path",
        .columns = 3,
        .share_x = false,
        .caption =
            "GO is on the surface, HIP where the hand is; the force on the user goes from HIP "
            "towards GO, 1.5 mm a newton. Grey: where HIP has been. In (k) the closest point "
            "(CP) is on the second curve already, and GO still stands on the first.",
        .width = 1080.0};
    std::vector<FrictionTick> ticks;
    for (const Moment& moment : at) {
        ticks.push_back(run[moment.tick]);
        figure.panels.push_back(snapshot(curves, run, moment));
    }
    std::vector<CsvColumn> table{column("time_s", ticks, &FrictionTick::t)};
    add_vectors(table, "hip", "m", ticks, &FrictionTick::hip);
    add_vectors(table, "go", "m", ticks, &FrictionTick::go);
    add_vectors(table, "force", "n", ticks, &FrictionTick::force);
    table.push_back(column("mode", ticks, &FrictionTick::mode));
    return {svg(figure), {{"", table}}};
}

}  // namespace palpate::figures
