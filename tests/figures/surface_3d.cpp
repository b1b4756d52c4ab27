// Figures 3.2.5 to 3.2.7: friction on a NURBS surface.
#include "tests/figures/make.hpp"
#include "tests/figures/surface_run.hpp"
#include "tests/figures/surface_view.hpp"

namespace palpate::figures {
namespace {

using namespace palpate::engine;

constexpr int kSamples = 60;             // a line
constexpr double kArrowPerNewton = 2.0;  // mm of a drawn force
constexpr Eye kEye{58.0, 29.0};

Series net(const NurbsSurface& surface) {
    return surface_net("surface", surface, kEye, 13, kSamples, Ink::grey);
}

Panel moment(const NurbsSurface& surface, const SurfaceTick& tick, std::string title) {
    Panel panel = surface_panel(std::move(title), 250.0);
    const std::array<Vec2, 2> spring{kEye(tick.go), kEye(tick.hip)};
    const Stroke stroke = tick.mode == engine::Mode::free ? Stroke::dotted : Stroke::solid;
    panel.series = {net(surface), path_mm("", spring, {Ink::black, 1.0, stroke}),
                    dot_mm("HIP", kEye(tick.hip), Ink::vermillion),
                    dot_mm("GO", kEye(tick.go), Ink::blue)};
    if (glm::length(tick.force) > 0.0) {
        const Vec2 from = kMillimetres * kEye(tick.go);
        const Vec2 way = kArrowPerNewton * kEye(tick.force);
        panel.arrows = {{from.x, from.y, way.x, way.y, "force", Ink::green}};
    }
    return panel;
}

std::vector<CsvColumn> place_table(const SurfaceRun& run) {
    std::vector<CsvColumn> table{column("time_s", run, &SurfaceTick::t),
                                 column("mode", run, &SurfaceTick::mode)};
    add_vectors(table, "hip", "m", run, &SurfaceTick::hip);
    add_vectors(table, "go", "m", run, &SurfaceTick::go);
    table.push_back(column("go_u", run, &SurfaceTick::go_u));
    table.push_back(column("go_v", run, &SurfaceTick::go_v));
    return table;
}

/// HIP and GO seen from the side: y along v, z up.
Panel side(const NurbsSurface& surface, const SurfaceRun& run) {
    Panel panel = plane_mm("(b) From the side, with instants of the run", 300.0, "y", "z");
    const auto from_side = [](const Vec3& p) {
        return Vec2{p.y, p.z};
    };
    std::vector<Vec2> cut;
    for (int k = 0; k <= kSamples; ++k) {
        cut.push_back(from_side(surface.at(kSurfaceU, static_cast<double>(k) / kSamples).point));
    }
    panel.series = go_and_hip(run, from_side);
    panel.series.insert(panel.series.begin(),
                        path_mm(fmt::format("surface at u = {:g}", kSurfaceU), cut, {Ink::black}));
    panel.markers = numbered(find_markers(run),
                             [&](std::size_t i) { return kMillimetres * from_side(run[i].hip); });
    look_at(panel, -26.0, 14.0, 20.0, 38.0);
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
    Panel panel = surface_panel("(a) On the surface", 300.0);
    double drift = 0.0;
    for (const SurfaceTick& tick : run) {
        drift = std::max(drift, std::fabs(tick.go_u - kSurfaceU));
    }
    panel.series = go_and_hip(run, kEye);
    panel.series.insert(panel.series.begin(), net(*surface));
    Figure figure{.id = "fig_3_2_6",
                  .title = "Figure 3.2.6: the trajectory along v of the surface",
                  .panels = {panel, side(*surface, run)},
                  .columns = 2,
                  .share_x = false,
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
    Panel normal = time_panel("(a) Normal force", "F_N", "N", 220.0);
    normal.series = {over_time("", run, &SurfaceTick::normal_force)};
    normal.markers = numbered(at, [&](std::size_t i) {
        return Vec2{run[i].t, run[i].normal_force};
    });
    Panel friction = time_panel("(b) Friction force", "|F_T|", "N", 220.0);
    friction.series = {
        over_time("friction", run, &SurfaceTick::friction_force),
        over_time("μ F_N", run, [](const SurfaceTick& t) { return t.mu * t.normal_force; },
                  {Ink::vermillion, 1.2, Stroke::dashed})};
    friction.markers = numbered(at, [&](std::size_t i) {
        return Vec2{run[i].t, run[i].friction_force};
    });
    Figure figure{.id = "fig_3_2_7",
                  .title = "Figure 3.2.7: normal and friction force on the surface",
                  .panels = {normal, friction},
                  .width = 980.0};
    figure.caption = fmt::format(
        "K = 1000 N/m, μ_s = 0.7, μ_d = 0.5. 1 contact begins, 2 HIP begins to move along v, 3 "
        "GO breaks away, 4 HIP goes deeper, 5 GO sticks, 6 it goes no deeper, 7 GO breaks away, "
        "8 μ is relaxed. As in the plane, and other than the thesis tells, GO sticks at once "
        "when HIP is pressed deeper (5 lies on 4), and friction does not rise with the load: "
        "{:.3f} N at 4, {:.3f} N at 6. It falls a little since HIP goes along the normal of its "
        "closest point, and that of GO, which lags behind on a curved surface, is another.",
        friction_at(run, at[3]), friction_at(run, at[5]));
    std::vector<CsvColumn> markers{{"marker", {}}, {"time_s", {}}};
    for (std::size_t k = 0; k < at.size(); ++k) {
        add_row(markers, {static_cast<double>(k + 1), at[k] ? run[*at[k]].t : std::nan("")});
    }
    return {svg(figure),
            {{"",
              {column("time_s", run, &SurfaceTick::t), column("mode", run, &SurfaceTick::mode),
               column("normal_n", run, &SurfaceTick::normal_force),
               column("friction_n", run, &SurfaceTick::friction_force),
               column("mu", run, &SurfaceTick::mu)}},
             {"_markers", markers}}};
}

}  // namespace palpate::figures
