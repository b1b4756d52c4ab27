// Figure 2.1.8: forces over time while HIP touches an object now and then.
#include "engine/rendering/scene.hpp"
#include "tests/figures/drawing.hpp"
#include "tests/figures/make.hpp"
#include "tests/support/frame.hpp"

namespace palpate::figures {
namespace {

using namespace palpate::engine;

constexpr double kTouchStiffness = 100.0;  // N/m
constexpr double kTouchSeconds = 6.0;      // of the run
constexpr double kTouchAt = 0.5;           // u in the middle of where the first curve is touched
constexpr double kTouchSwing = 0.2;        // of u to both sides
constexpr double kTouchDepth = 0.012;      // m
constexpr double kTouchLift = 0.006;       // m outside between two touches

struct Touch {
    double t = 0.0;  ///< s
    Vec2 hip{};
    double depth = 0.0;  ///< behind the closest point, m; 0 outside
    Mode mode = Mode::free;
    Vec2 force{};
};

/// In and out of the first curve by a sine, while going along it and back by a slower one.
std::vector<Touch> touches() {
    const auto curves = curves_of(three_curves());
    const auto outline = std::make_shared<const engine::Outline>(curves, true);
    const engine::Scene scene(outline, {.stiffness = kTouchStiffness, .period = kTick});
    engine::ContactState state;
    engine::TrackState track;
    std::vector<Touch> run;
    for (int i = 0; i * kTick <= kTouchSeconds; ++i) {
        const double t = i * kTick;
        const engine::Frame at = engine::frame_at(
            curves.front().spans().front().curve,
            kTouchAt + kTouchSwing * std::sin(2.0 * std::numbers::pi * t / kTouchSeconds));
        const double middle = 0.5 * (kTouchDepth - kTouchLift);
        const double below =
            middle - 0.5 * (kTouchDepth + kTouchLift) * std::cos(2.0 * std::numbers::pi * t / 1.5);
        const Vec2 hip = at.point - below * at.normal;
        const engine::Contact contact = scene.tick(state, hip);
        const engine::ClosestPoint cp = scene.closest(track, hip);
        run.push_back({.t = t,
                       .hip = hip,
                       .depth = cp.inside ? cp.distance : 0.0,
                       .mode = contact.mode,
                       .force = contact.force});
    }
    return run;
}

}  // namespace

MadeFigure make_touches() {
    const Polygons object = three_curves();
    const std::vector<Touch> run = touches();
    Panel plane = plane_mm("(a) Object and path of HIP", 330.0);
    std::vector<Vec2> path;
    for (const Touch& touch : run) {
        path.push_back(touch.hip);
    }
    plane.series = {outline_mm(curves_of(object)), path_mm("HIP", path, {Ink::vermillion})};
    Panel force = time_panel("(b) Force", "force", "N", 330.0);
    force.series = {
        over_time("F_x", run, [](const Touch& touch) { return touch.force.x; }),
        over_time("F_y", run, [](const Touch& touch) { return touch.force.y; }),
        over_time("|F|", run, [](const Touch& touch) { return glm::length(touch.force); })};
    Figure figure{.id = "fig_2_1_8",
                  .title = "Figure 2.1.8: force while HIP touches the object now and then",
                  .panels = {plane, force},
                  .columns = 2,
                  .share_x = false,
                  .width = 1000.0};
    figure.caption = fmt::format(
        "HIP goes {:g} mm into the first curve of the object of figure 2.1.4 and {:g} mm out of "
        "it, four times, and along it and back; no friction, K = {:g} N/m as in the thesis. The "
        "thesis recorded this with a person at its pantograph (figure 2.1.7 is a picture of that); "
        "this is our renderer on a given path.",
        kMillimetres * kTouchDepth, kMillimetres * kTouchLift, kTouchStiffness);
    std::vector<CsvColumn> table{column("time_s", run, &Touch::t),
                                 column("mode", run, &Touch::mode)};
    add_vectors(table, "hip", "m", run, &Touch::hip);
    table.push_back(column("depth_m", run, &Touch::depth));
    add_vectors(table, "force", "n", run, &Touch::force);
    return {svg(figure), {{"", table}}};
}

}  // namespace palpate::figures
