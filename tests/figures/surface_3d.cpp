// Figures 3.2.5 to 3.2.7: friction on a NURBS surface.
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "tests/figures/drawing.hpp"
#include "tests/figures/make.hpp"
#include "tests/figures/surface_run.hpp"

namespace palpate::figures {
namespace {

using namespace palpate::engine;

constexpr int kLines = 13;               // of the net, each way
constexpr int kSamples = 60;             // a line
constexpr double kArrowPerNewton = 2.0;  // mm of a drawn force

/// What an eye far away sees, m: right and up.
Vec2 seen(const Vec3& p) {
    constexpr double kTurn = 58.0 * std::numbers::pi / 180.0;
    constexpr double kRise = 29.0 * std::numbers::pi / 180.0;
    const Vec3 right{-std::sin(kTurn), std::cos(kTurn), 0.0};
    const Vec3 up{-std::cos(kTurn) * std::sin(kRise), -std::sin(kTurn) * std::sin(kRise),
                  std::cos(kRise)};
    return {glm::dot(p, right), glm::dot(p, up)};
}

/// Lines of constant u and of constant v.
Series net(const NurbsSurface& surface) {
    std::vector<Vec2> points;
    for (const bool along_u : {false, true}) {
        for (int i = 0; i < kLines; ++i) {
            const double still = static_cast<double>(i) / (kLines - 1);
            for (int k = 0; k <= kSamples; ++k) {
                const double moving = static_cast<double>(k) / kSamples;
                points.push_back(seen(along_u ? surface.at(moving, still).point
                                              : surface.at(still, moving).point));
            }
            points.push_back(gap());
        }
    }
    Series series = path_mm("surface", points);
    series.ink = Ink::grey;
    series.width = 0.7;
    return series;
}

Panel view(std::string title, double height) {
    return plane_mm(std::move(title), height, "right in the view", "up in the view");
}

Series one_dot(const std::string& name, const Vec2& at, Ink ink) {
    const std::array<Vec2, 1> place{at};
    Series series = dots_mm(name, place);
    series.ink = ink;
    return series;
}

Panel moment(const NurbsSurface& surface, const SurfaceTick& tick, std::string title) {
    Panel panel = view(std::move(title), 250.0);
    const std::array<Vec2, 2> spring{seen(tick.go), seen(tick.hip)};
    Series stretch = path_mm("", spring);
    stretch.ink = Ink::black;
    stretch.width = 1.0;
    stretch.stroke = tick.mode == engine::Mode::free ? Stroke::dotted : Stroke::solid;
    panel.series = {net(surface), stretch, one_dot("HIP", seen(tick.hip), Ink::vermillion),
                    one_dot("GO", seen(tick.go), Ink::blue)};
    if (glm::length(tick.force) > 0.0) {
        const Vec2 from = kMillimetres * seen(tick.go);
        const Vec2 way = kArrowPerNewton * seen(tick.force);
        panel.arrows = {{from.x, from.y, way.x, way.y, "force", Ink::green}};
    }
    return panel;
}

std::vector<data::Marker> numbered(const SurfaceRun& run, Vec2 (*place)(const SurfaceTick&)) {
    const SurfaceMarkers at = find_markers(run);
    std::vector<data::Marker> markers;
    for (std::size_t k = 0; k < at.size(); ++k) {
        if (at[k]) {
            const Vec2 p = place(run[*at[k]]);
            markers.push_back({p.x, p.y, std::to_string(k + 1)});
        }
    }
    return markers;
}

std::vector<CsvColumn> place_table(const SurfaceRun& run) {
    using Tick = SurfaceTick;
    std::vector<CsvColumn> table{
        column("time_s", run, [](const Tick& t) { return t.t; }),
        column("mode", run, [](const Tick& t) { return static_cast<int>(t.mode); })};
    constexpr std::array<std::string_view, 3> kAxes{"x_m", "y_m", "z_m"};
    for (int k = 0; k < 3; ++k) {
        const std::string_view axis = kAxes.at(static_cast<std::size_t>(k));
        table.push_back(
            column(fmt::format("hip_{}", axis), run, [k](const Tick& t) { return t.hip[k]; }));
    }
    for (int k = 0; k < 3; ++k) {
        const std::string_view axis = kAxes.at(static_cast<std::size_t>(k));
        table.push_back(
            column(fmt::format("go_{}", axis), run, [k](const Tick& t) { return t.go[k]; }));
    }
    table.push_back(column("go_u", run, [](const Tick& t) { return t.go_u; }));
    table.push_back(column("go_v", run, [](const Tick& t) { return t.go_v; }));
    return table;
}

/// HIP and GO seen from the side: y along v, z up.
Panel side(const NurbsSurface& surface, const SurfaceRun& run) {
    Panel panel = plane_mm("(b) From the side, with instants of the run", 300.0, "y", "z");
    std::vector<Vec2> cut;
    for (int k = 0; k <= kSamples; ++k) {
        const Vec3 p = surface.at(kSurfaceU, static_cast<double>(k) / kSamples).point;
        cut.push_back({p.y, p.z});
    }
    std::vector<Vec2> hip;
    std::vector<Vec2> go;
    for (const SurfaceTick& tick : run) {
        hip.push_back({tick.hip.y, tick.hip.z});
        go.push_back(tick.mode == engine::Mode::free ? gap() : Vec2{tick.go.y, tick.go.z});
    }
    panel.series = {path_mm(fmt::format("surface at u = {:g}", kSurfaceU), cut),
                    path_mm("GO in contact", go), path_mm("HIP", hip)};
    panel.series[0].ink = Ink::black;
    panel.series[1].ink = Ink::sky;
    panel.series[1].width = 4.0;
    panel.series[2].ink = Ink::vermillion;
    panel.markers = numbered(run, [](const SurfaceTick& t) {
        return Vec2{kMillimetres * t.hip.y, kMillimetres * t.hip.z};
    });
    panel.x.low = -26.0;
    panel.x.high = 14.0;
    panel.y.low = 20.0;
    panel.y.high = 38.0;
    return panel;
}

Panel force_panel(std::string title,
                  std::string label,
                  const SurfaceRun& run,
                  double SurfaceTick::*force) {
    Panel panel{.title = std::move(title),
                .x = {.label = "time", .unit = "s"},
                .y = {.label = std::move(label), .unit = "N"},
                .height = 220.0};
    Series series{.name = ""};
    for (const SurfaceTick& tick : run) {
        series.x.push_back(tick.t);
        series.y.push_back(tick.*force);
    }
    panel.series = {series};
    return panel;
}

double friction_at(const SurfaceRun& run, const std::optional<std::size_t>& at) {
    return at ? run[*at].friction_force : std::nan("");
}

}  // namespace

MadeFigure make_surface_collision() {
    const auto surface = dome();
    const SurfaceRun run = felt_on_dome(surface);
    const std::size_t inside = find_markers(run)[1].value_or(run.size() - 1);
    const std::array<SurfaceTick, 2> shown{run.front(), run[inside]};
    Figure figure{.id = "fig_3_2_5",
                  .title = "Figure 3.2.5: a NURBS surface before and after the collision",
                  .panels = {moment(*surface, shown[0], "(a) Before"),
                             moment(*surface, shown[1], "(b) After")},
                  .columns = 2,
                  .share_x = false,
                  .caption = "",
                  .width = 1000.0};
    figure.caption = fmt::format(
        "A rational bicubic dome of 4 x 4 control points, 0.1 m wide, seen from afar at a rise "
        "of 29 degrees. Outside, the god-object (GO) is the closest point and the force is zero. "
        "Inside, {:g} mm deep, it stands on the surface, HIP below it, and the force of {:.2f} N "
        "points along the normal ({:g} mm a newton).",
        std::round(1e5 * shown[1].depth) / 100.0, glm::length(shown[1].force), kArrowPerNewton);
    return {svg(figure), {{"", place_table({shown.begin(), shown.end()})}}};
}

MadeFigure make_surface_path() {
    const auto surface = dome();
    const SurfaceRun run = felt_on_dome(surface);
    Panel panel = view("(a) On the surface", 300.0);
    std::vector<Vec2> hip;
    std::vector<Vec2> go;
    double drift = 0.0;
    for (const SurfaceTick& tick : run) {
        hip.push_back(seen(tick.hip));
        go.push_back(tick.mode == engine::Mode::free ? gap() : seen(tick.go));
        drift = std::max(drift, std::fabs(tick.go_u - kSurfaceU));
    }
    panel.series = {net(*surface), path_mm("GO in contact", go), path_mm("HIP", hip)};
    panel.series[1].ink = Ink::sky;
    panel.series[1].width = 4.0;
    panel.series[2].ink = Ink::vermillion;
    Figure figure{.id = "fig_3_2_6",
                  .title = "Figure 3.2.6: the trajectory along v of the surface",
                  .panels = {panel, side(*surface, run)},
                  .columns = 2,
                  .share_x = false,
                  .caption = "",
                  .width = 1080.0};
    figure.caption = fmt::format(
        "HIP stays below the line u = {:g}: in along the normal (1 to 2), along v at constant "
        "depth (to 4), deeper along the normal (to 6), along v again. GO is free to leave that "
        "line, and does so by {:.2g} of u at most.",
        kSurfaceU, drift);
    return {svg(figure), {{"", place_table(run)}}};
}

MadeFigure make_surface_forces() {
    const SurfaceRun run = felt_on_dome(dome());
    const SurfaceMarkers at = find_markers(run);
    Panel normal = force_panel("(a) Normal force", "F_N", run, &SurfaceTick::normal_force);
    normal.markers = numbered(run, [](const SurfaceTick& t) { return Vec2{t.t, t.normal_force}; });
    Panel friction = force_panel("(b) Friction force", "|F_T|", run, &SurfaceTick::friction_force);
    friction.markers = numbered(run, [](const SurfaceTick& t) {
        return Vec2{t.t, t.friction_force};
    });
    Series max{.name = "μ F_N", .x = {}, .y = {}, .ink = Ink::vermillion};
    for (const SurfaceTick& tick : run) {
        max.x.push_back(tick.t);
        max.y.push_back(tick.mu * tick.normal_force);
    }
    max.stroke = Stroke::dashed;
    max.width = 1.2;
    friction.series.push_back(max);
    friction.series.front().name = "friction";
    Figure figure{.id = "fig_3_2_7",
                  .title = "Figure 3.2.7: normal and friction force on the surface",
                  .panels = {normal, friction},
                  .caption = "",
                  .width = 980.0};
    figure.caption = fmt::format(
        "K = 1000 N/m, μ_s = 0.7, μ_d = 0.5. 1 contact begins, 2 HIP begins to move along v, 3 "
        "GO breaks away, 4 HIP goes deeper, 5 GO sticks, 6 it goes no deeper, 7 GO breaks away, "
        "8 μ is relaxed. As in the plane, and other than the thesis tells, GO sticks at once "
        "when HIP is pressed deeper (5 lies on 4), and friction does not rise with the load: "
        "{:.3f} N at 4, {:.3f} N at 6. It falls a little since HIP goes along the normal of its "
        "closest point, and that of GO, which lags behind on a curved surface, is another.",
        friction_at(run, at[3]), friction_at(run, at[5]));
    using Tick = SurfaceTick;
    std::vector<CsvColumn> markers{{"marker", {}}, {"time_s", {}}};
    for (std::size_t k = 0; k < at.size(); ++k) {
        markers[0].values.push_back(static_cast<double>(k + 1));
        markers[1].values.push_back(at[k] ? run[*at[k]].t : std::nan(""));
    }
    return {svg(figure),
            {{"",
              {column("time_s", run, [](const Tick& t) { return t.t; }),
               column("mode", run, [](const Tick& t) { return static_cast<int>(t.mode); }),
               column("normal_n", run, [](const Tick& t) { return t.normal_force; }),
               column("friction_n", run, [](const Tick& t) { return t.friction_force; }),
               column("mu", run, [](const Tick& t) { return t.mu; })}},
             {"_markers", markers}}};
}

}  // namespace palpate::figures
