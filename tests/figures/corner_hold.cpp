// Figure 3.1.4: static friction at a corner: HIP in the region of another curve than the one on
// which GO stands.
#include "engine/rendering/scene.hpp"
#include "tests/figures/drawing.hpp"
#include "tests/figures/friction_run.hpp"
#include "tests/figures/make.hpp"
#include "tests/figures/region_drawing.hpp"
#include "tests/support/frame.hpp"

namespace palpate::figures {
namespace {

using namespace palpate::engine;

constexpr double kCornerAt = 0.93;       // u on the first curve where HIP goes in
constexpr double kCornerAbove = 0.003;   // m
constexpr double kCornerDepth = 0.008;   // m
constexpr double kCornerAcross = 0.012;  // m, level over the border of two regions
constexpr double kCornerSpeed = 0.02;    // m/s
constexpr double kCornerArrow = 1.5;     // mm of arrow

struct CornerTick {
    double t = 0.0;  ///< s
    Vec2 hip{};
    Vec2 cp{};
    Vec2 go{};
    Vec2 force{};
    Mode mode = Mode::free;
    int region = 0;  ///< internal one of HIP
};

/// In along the normal near the corner, then level across the border.
std::vector<CornerTick> corner_run(const RegionMap& map) {
    const auto curves = curves_of(three_curves());
    const auto outline = std::make_shared<const engine::Outline>(curves, true);
    const engine::Scene scene(outline,
                              {.stiffness = kFrictionStiffness,
                               .period = kTick,
                               .friction = {.mu_s = kFrictionStatic, .mu_d = kFrictionDynamic}});
    engine::ContactState state;
    const engine::Frame at = engine::frame_at(curves.front().spans().front().curve, kCornerAt);
    const int in = static_cast<int>((kCornerAbove + kCornerDepth) / (kCornerSpeed * kTick));
    const int across = static_cast<int>(kCornerAcross / (kCornerSpeed * kTick));
    std::vector<CornerTick> run;
    for (int i = 0; i <= in + across; ++i) {
        const double below = std::min(i, in) * kCornerSpeed * kTick - kCornerAbove;
        const Vec2 along{std::max(i - in, 0) * kCornerSpeed * kTick, 0.0};
        const Vec2 hip = at.point - below * at.normal + along;
        const engine::ClosestPoint cp = map.feet().closest(hip);
        const engine::Contact contact = shown(scene.tick(state, hip), cp);
        run.push_back({.t = i * kTick,
                       .hip = hip,
                       .cp = cp.point,
                       .go = contact.go,
                       .force = contact.force,
                       .mode = contact.mode,
                       .region = map.at(hip)});
    }
    return run;
}

}  // namespace

MadeFigure make_corner_hold() {
    const Polygons object = three_curves();
    const RegionMap map(curves_of(object));
    const std::vector<CornerTick> run = corner_run(map);
    // The last tick that sticks, HIP being in the second region.
    const auto last = std::find_if(run.rbegin(), run.rend(),
                                   [](const CornerTick& tick) { return tick.mode == Mode::stuck; });
    const CornerTick& now = last == run.rend() ? run.back() : *last;
    Panel panel = plane_mm("", 460.0);
    const std::vector<Border> pieces = borders(map, kLattice);
    std::vector<Vec2> way;
    for (const CornerTick& tick : run) {
        if (tick.t <= now.t) {
            way.push_back(tick.hip);
        }
    }
    panel.series = {outline_mm(curves_of(object)),
                    border_series(map, pieces, false),
                    path_mm("path of HIP", way, {Ink::grey}),
                    dot_mm("CP", now.cp, Ink::orange),
                    dot_mm("HIP", now.hip, Ink::vermillion),
                    dot_mm("GO", now.go, Ink::blue)};
    panel.arrows.push_back({kMillimetres * now.hip.x, kMillimetres * now.hip.y,
                            kCornerArrow * now.force.x, kCornerArrow * now.force.y, "force",
                            Ink::green});
    look_at(panel, -30.0, 26.0, 14.0, 50.0);
    Figure figure{.id = "fig_3_1_4",
                  .title = "Figure 3.1.4: static friction at a corner",
                  .panels = {panel},
                  .width = 860.0};
    figure.caption = fmt::format(
        "The object of figure 2.1.4 with its internal Voronoi regions. HIP went in along the "
        "normal of the first curve, {:g} mm deep, and level into the region of the second; here "
        "is the last tick before break-away. The closest point is on the second curve, the "
        "god-object still stands on the first, and the force is that of the spring between it and "
        "HIP: no switch of regions releases what sticks.",
        kMillimetres * kCornerDepth);
    std::vector<CsvColumn> table{column("time_s", run, &CornerTick::t),
                                 column("mode", run, &CornerTick::mode),
                                 column("region", run, &CornerTick::region)};
    add_vectors(table, "hip", "m", run, &CornerTick::hip);
    add_vectors(table, "cp", "m", run, &CornerTick::cp);
    add_vectors(table, "go", "m", run, &CornerTick::go);
    add_vectors(table, "force", "n", run, &CornerTick::force);
    return {svg(figure), {{"", table}}};
}

}  // namespace palpate::figures
