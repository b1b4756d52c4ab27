#include "tests/figures/friction_run.hpp"

#include "engine/rendering/scene.hpp"
#include "tests/figures/objects.hpp"
#include "tests/figures/thesis/thesis_scene.hpp"
#include "tests/support/frame.hpp"

namespace palpate::figures {
namespace {

using namespace palpate::engine;

constexpr double kAbove = 0.005;   // m outside, to begin with and to end
constexpr double kCorner = 0.968;  // u of the second touch, near the vertex
constexpr double kLevel = 0.014;   // m along the level stretch over the vertex
constexpr double kReleaseGain =
    40.0;  // 1/s where the curve is fastest: GO after break-away, thesis

/// Draws HIP's path, a place a tick, over the first curve.
class PathPen {
public:
    PathPen(const engine::NurbsCurve<2>& curve, Vec2 start) : curve_(&curve), path_{start} {}

    void line(const Vec2& to, double speed) { go_straight(path_, to, speed); }
    /// From u on, `depth` below the curve, so far. @return u at the end
    double below(double u, double depth, double length, double speed) {
        const int ticks = static_cast<int>(std::ceil(length / (speed * kFrictionTick)));
        const double step = length / ticks;
        for (int i = 0; i < ticks; ++i) {
            const double half = u + 0.5 * step / rate(u, depth);
            u += step / rate(half, depth);
            path_.push_back(at(u, depth));
        }
        return u;
    }
    [[nodiscard]] Vec2 at(double u, double depth) const {
        const Frame f = frame(u);
        return f.point - depth * f.normal;
    }
    [[nodiscard]] std::vector<Vec2> take() { return std::move(path_); }

private:
    [[nodiscard]] Frame frame(double u) const {
        return engine::frame_at(curve_->spans().front().curve, u);
    }
    /// Metres of the path below the curve per unit of u.
    [[nodiscard]] double rate(double u, double depth) const {
        const Frame f = frame(u);
        return f.speed * (1.0 - f.curvature * depth);
    }

    const engine::NurbsCurve<2>* curve_;
    std::vector<Vec2> path_;
};

}  // namespace

std::vector<Vec2> friction_path() {
    const auto curves = curves_of(tests::two_polygons());
    const PathPen eye(curves.front(), {});
    PathPen pen(curves.front(), eye.at(kFirst, -kAbove));
    pen.line(eye.at(kFirst, kDepth), kInwards);
    double u = pen.below(kFirst, kDepth, kSlideOne, kAlong);
    pen.line(eye.at(u, kDeeper), kPress);
    u = pen.below(u, kDeeper, kSlideTwo, kAlong);
    pen.line(eye.at(u, -kAbove), kInwards);
    pen.line(eye.at(kCorner, -kAbove), kAlong);
    const Vec2 pressed = eye.at(kCorner, kDepth);
    pen.line(pressed, kInwards);
    pen.line(pressed + Vec2{kLevel, 0.0}, kAlong);
    return pen.take();
}

FrictionRun felt_by_gos(const std::vector<Vec2>& path) {
    const auto outline =
        std::make_shared<const engine::Outline>(curves_of(tests::two_polygons()), false);
    const engine::Scene scene(outline, {.stiffness = kFrictionStiffness,
                                        .period = kFrictionTick,
                                        .friction = tests::kStudyFriction,
                                        .slew = tests::kStudySlew});
    engine::ContactState state;
    engine::TrackState track;
    FrictionRun run;
    for (const Vec2& hip : path) {
        const engine::Contact felt = scene.tick(state, hip);
        const engine::ClosestPoint closest = scene.closest(track, hip);
        const engine::Contact c = shown(felt, closest);
        const engine::SegmentPlace cp = engine::segment_place(*outline, closest.place);
        const engine::SegmentPlace go = engine::segment_place(*outline, c.place);
        run.push_back({.t = static_cast<double>(run.size()) * kFrictionTick,
                       .hip = hip,
                       .mode = c.mode,
                       .cp = closest.point,
                       .go = c.go,
                       .force = c.force,
                       .depth = closest.inside ? closest.distance : 0.0,
                       .normal_force = c.normal_force,
                       .friction_force = c.tangential_force,
                       .mu = c.mu,
                       .cp_curve = cp.segment,
                       .cp_u = cp.u,
                       .go_curve = go.segment,
                       .go_u = go.u});
    }
    return run;
}

FrictionRun felt_by_thesis(const std::vector<Vec2>& path, bool latched) {
    const auto curves = curves_of(tests::two_polygons());
    const double release =
        feedback_gain(curves.front(), kReleaseGain * kFrictionTick, kFrictionTick);
    const ThesisScene scene(curves, false,
                            {.stiffness = kFrictionStiffness,
                             .period = kFrictionTick,
                             .tracker = {.kind = TrackerKind::newton, .iterations = 2},
                             .release = TrackerSpec{.kind = TrackerKind::feedback, .gain = release},
                             .law = latched ? ThesisLaw::latched : ThesisLaw::literal,
                             .mu_s = kFrictionStatic,
                             .mu_d = kFrictionDynamic,
                             .dead_band = 0.001});
    ThesisState state;
    FrictionRun run;
    for (const Vec2& hip : path) {
        const ThesisTick c = scene.tick(state, hip);
        run.push_back({.t = static_cast<double>(run.size()) * kFrictionTick,
                       .hip = hip,
                       .mode = c.mode,
                       .cp = c.cp,
                       .go = c.go,
                       .force = c.force,
                       .depth = c.mode == Mode::free ? 0.0 : glm::length(c.cp - hip),
                       .normal_force = c.fn,
                       .friction_force = c.ft,
                       .mu = c.mu,
                       .cp_curve = c.cp_segment,
                       .cp_u = c.cp_u,
                       .go_curve = c.segment,
                       .go_u = c.u});
    }
    return run;
}

FrictionMarkers find_markers(const FrictionRun& run) {
    using enum Instant;
    const auto found =
        instants_of(run, std::array{touches, moves, breaks, deepens, sticks, is_deep, breaks,
                                    relaxed, leaves, lifts, touches, moves, breaks, relaxed});
    FrictionMarkers at;
    std::copy(found.begin() + 1, found.end(), at.begin());  // the first touch is not marked
    return at;
}

double largest_jump(const FrictionRun& run, std::size_t from, std::size_t to) {
    double max = 0.0;
    for (std::size_t i = std::max<std::size_t>(from, 1); i <= to && i < run.size(); ++i) {
        max = std::max(max, glm::length(run[i].force - run[i - 1].force));
    }
    return max;
}

}  // namespace palpate::figures
