// The god-object over the edge of an object of four NURBS surfaces (thesis 2.1.4 and 3.1.2), with
// the trackers of the thesis beside it.
#include "tests/figures/instants.hpp"
#include "tests/figures/make.hpp"
#include "tests/figures/surface_run.hpp"
#include "tests/figures/surface_view.hpp"
#include "tests/figures/thesis/surface_tracker.hpp"

namespace palpate::figures {
namespace {

using namespace palpate::engine;

using Patches = std::vector<std::shared_ptr<const NurbsSurface>>;

constexpr double kHandSpeed = 0.04;  // m/s
constexpr double kShown = 0.15;      // s before and after the edge

/// A side of a ridge that runs along y: bicubic, from its foot at x = `foot` to the ridge at x = 0.
NurbsSurface ridge_side(double foot, double shoulder) {
    constexpr std::array<double, 4> kAcross{1.0, 0.62, 0.3, 0.0};          // of the foot
    constexpr std::array<double, 4> kForward{-0.04, -0.014, 0.014, 0.04};  // m
    constexpr std::array<double, 4> kTop{0.020, 0.027, 0.024, 0.019};      // m
    std::vector<std::vector<Vec3>> points(4);
    for (std::size_t i = 0; i < 4; ++i) {
        const std::size_t from_left = foot < 0.0 ? i : 3 - i;
        for (std::size_t j = 0; j < 4; ++j) {
            const std::array<double, 4> rise{0.0, shoulder, 0.5 + 0.5 * shoulder, 1.0};
            points[i].push_back(
                {foot * kAcross.at(from_left), kForward.at(j), kTop.at(j) * rise.at(from_left)});
        }
    }
    const std::vector<double> knots{0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0};
    return {3, 3, knots, knots, points};
}

/// Each side in two.
Patches ridge() {
    Patches patches;
    for (const NurbsSurface& side : {ridge_side(-0.045, 0.55), ridge_side(0.035, 0.75)}) {
        patches.push_back(std::make_shared<const NurbsSurface>(side.part(0.0, 1.0, 0.0, 0.5)));
        patches.push_back(std::make_shared<const NurbsSurface>(side.part(0.0, 1.0, 0.5, 1.0)));
    }
    return patches;
}

/// In from the left, below the ridge to the right, and over the joint of two pieces on the way.
std::vector<Vec3> hand() {
    const std::array<Vec3, 4> stops{Vec3{-0.022, -0.014, 0.022}, Vec3{-0.018, -0.012, 0.010},
                                    Vec3{0.016, 0.011, 0.011}, Vec3{0.020, 0.013, 0.026}};
    std::vector<Vec3> path{stops[0]};
    for (std::size_t k = 1; k < stops.size(); ++k) {
        go_straight(path, stops.at(k), kHandSpeed);
    }
    return path;
}

SurfaceRun felt_over(const Patches& patches, const engine::Slew& slew) {
    return felt_along(
        engine::SurfaceScene(patches,
                             engine::SurfaceSceneSpec{.contact = {.stiffness = kFrictionStiffness,
                                                                  .period = kTick,
                                                                  .friction = tests::kStudyFriction,
                                                                  .slew = slew}}),
        hand());
}

/// The first tick on the right side of the ridge, which has surfaces 2 and 3.
std::size_t crossing(const SurfaceRun& run) {
    for (std::size_t k = 0; k < run.size(); ++k) {
        if (run[k].mode != Mode::free && run[k].surface > 1) {
            return k;
        }
    }
    return run.size() - 1;
}

Panel view(const Patches& patches, const SurfaceRun& run) {
    constexpr Eye kEdgeEye{-65.0, 32.0};
    constexpr std::array<Ink, 4> kInks{Ink::grey, Ink::green, Ink::purple, Ink::orange};
    Panel panel = surface_panel("(a) Four surfaces, HIP and GO", 330.0);
    for (std::size_t k = 0; k < patches.size(); ++k) {
        panel.series.push_back(surface_net(fmt::format("surface {}", k + 1), *patches[k], kEdgeEye,
                                           7, 30, kInks.at(k)));
    }
    std::ranges::move(go_and_hip(run, kEdgeEye, {Ink::blue, 3.0}),
                      std::back_inserter(panel.series));
    const Vec2 edge = kMillimetres * kEdgeEye(run[crossing(run)].go);
    panel.markers = {{edge.x, edge.y, "1"}};
    return panel;
}

/// |F| and its change a tick round the edge.
Panel forces(const SurfaceRun& slewed, const SurfaceRun& plain, bool change) {
    const double at = slewed[crossing(slewed)].t;
    Panel panel{.title = change ? "(c) Its change from tick to tick" : "(b) Force at the edge",
                .x = {.label = "time", .unit = "s", .low = at - kShown, .high = at + kShown},
                .y = {.label = change ? "|ΔF|" : "F along x", .unit = "N"},
                .height = 200.0};
    for (const SurfaceRun* run : {&plain, &slewed}) {
        Series series{.name = run == &plain ? "without vertex slew" : "with vertex slew",
                      .ink = run == &plain ? Ink::vermillion : Ink::blue};
        for (std::size_t k = 1; k < run->size(); ++k) {
            const SurfaceTick& tick = (*run)[k];
            if (std::fabs(tick.t - at) <= kShown) {
                series.add(tick.t,
                           change ? glm::length(tick.force - (*run)[k - 1].force) : tick.force.x);
            }
        }
        panel.series.push_back(series);
    }
    return panel;
}

struct WindowFoot {
    const char* name;
    const char* column;
    TrackerSpec spec;
    std::vector<double> excess{};  ///< m, a tick
    std::uint64_t switches = 0;
};

/// How much farther from HIP than the nearest point of all each tracker is.
std::vector<WindowFoot> followed(const Patches& patches) {
    const auto object = std::make_shared<const engine::SurfaceObject>(patches);
    const engine::SurfaceFeet feet(object);
    const double gain = feedback_gain(*object, 1.0, kTick);
    std::vector<WindowFoot> all{
        {"feedback, K T |S_u|² = 0.1",
         "feedback_slow",
         {.kind = TrackerKind::feedback, .gain = 0.1 * gain}},
        {"feedback, K T |S_u|² = 1", "feedback", {.kind = TrackerKind::feedback, .gain = gain}},
        {"Newton, one step", "newton", {.kind = TrackerKind::newton}}};
    const std::vector<Vec3> path = hand();
    std::vector<double> exact;
    engine::SurfaceTrack track;
    for (const Vec3& hip : path) {
        exact.push_back(feet.track(track, hip).distance);
    }
    for (WindowFoot& one : all) {
        const SurfaceTracker tracker(object, one.spec);
        SurfaceTrackerState state = tracker.start(path.front());
        for (std::size_t k = 0; k < path.size(); ++k) {
            one.excess.push_back(tracker.step(state, path[k], kTick).distance - exact[k]);
        }
        one.switches = state.switches;
    }
    return all;
}

/// The largest change of the force in a tick about the crossing, N.
double largest(const SurfaceRun& run) {
    const std::size_t at = crossing(run);
    double max = 0.0;
    for (std::size_t k = at - 20; k < at + 120 && k < run.size(); ++k) {
        max = std::max(max, glm::length(run[k].force - run[k - 1].force));
    }
    return max;
}

}  // namespace

MadeFigure make_surface_patches() {
    const Patches patches = ridge();
    const SurfaceRun slewed = felt_over(patches, tests::kStudySlew);
    const SurfaceRun plain = felt_over(patches, {});
    const std::vector<WindowFoot> trackers = followed(patches);
    Panel errors{.title = "(d) Trackers: how much farther than the nearest point",
                 .x = {.label = "time", .unit = "s"},
                 .y = {.label = "excess", .unit = "m", .log = true, .low = 1e-18, .high = 1e-1},
                 .height = 200.0};
    std::vector<CsvColumn> table{
        column("time_s", slewed, &SurfaceTick::t), column("mode", slewed, &SurfaceTick::mode),
        column("surface", slewed, [](const SurfaceTick& t) { return t.surface + 1; })};
    constexpr std::array<const char*, 3> kAxes{"x", "y", "z"};
    for (int k = 0; k < 3; ++k) {
        const char* axis = kAxes.at(static_cast<std::size_t>(k));
        table.push_back(column(fmt::format("hip_{}_m", axis), slewed,
                               [k](const SurfaceTick& t) { return t.hip[k]; }));
        table.push_back(column(fmt::format("go_{}_m", axis), slewed,
                               [k](const SurfaceTick& t) { return t.go[k]; }));
        table.push_back(column(fmt::format("force_{}_n", axis), slewed,
                               [k](const SurfaceTick& t) { return t.force[k]; }));
        table.push_back(column(fmt::format("force_without_slew_{}_n", axis), plain,
                               [k](const SurfaceTick& t) { return t.force[k]; }));
    }
    for (const WindowFoot& one : trackers) {
        errors.series.push_back({.name = one.name, .x = table[0].values, .y = one.excess});
        table.push_back({std::string(one.column) + "_excess_m", one.excess});
    }
    Figure figure{.id = "fig_3_1_2_patches",
                  .title = "Over the edge of an object of four NURBS surfaces",
                  .panels = {view(patches, slewed), forces(slewed, plain, false),
                             forces(slewed, plain, true), errors},
                  .columns = 2,
                  .share_x = false,
                  .width = 1120.0};
    figure.caption = fmt::format(
        "Two sides of a ridge, each in two pieces: four surfaces, joined along their borders. HIP "
        "goes through below the ridge at {:g} mm/s, with friction (μ_s = 0.7, μ_d = 0.5). The "
        "god-object (GO) crosses the joint of two pieces without a trace, and the ridge at 1. "
        "There the force changes by {:.2f} N in one tick without vertex slew, and by {:.2f} N "
        "where its normal turns through the fan of the edge (v_r = {:g} m/s, ρ_v = {:g} mm). The "
        "thesis' trackers, with its state machine of faces, edges and corners, follow one "
        "feature: below the ridge they stay on their side when the other is nearer already "
        "({}, {} and {} switches).",
        1e3 * kHandSpeed, largest(plain), largest(slewed), tests::kStudySlew.speed,
        1e3 * tests::kStudySlew.radius, trackers[0].switches, trackers[1].switches,
        trackers[2].switches);
    return {svg(figure), {{"", table}}};
}

}  // namespace palpate::figures
