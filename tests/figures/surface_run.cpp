#include "tests/figures/surface_run.hpp"

#include "tests/figures/instants.hpp"

namespace palpate::figures {
namespace {

using namespace palpate::engine;

constexpr double kOutside = 0.006;  // m outside, to begin with

/// HIP below the surface's point at (kSurfaceU, v); depth < 0 above it.
Vec3 below(const NurbsSurface& surface, double v, double depth) {
    return surface.at(kSurfaceU, v).point - depth * surface.normal(kSurfaceU, v);
}

/// Along v at constant depth. @return v at the end
double along(
    const NurbsSurface& surface, std::vector<Vec3>& path, double v, double depth, double length) {
    constexpr double kDifference = 1e-5;  // of v
    const int ticks = static_cast<int>(std::ceil(length / (kAlong * kFrictionTick)));
    for (int i = 0; i < ticks; ++i) {
        const double rate = glm::length(below(surface, v + kDifference, depth) -
                                        below(surface, v - kDifference, depth)) /
                            (2.0 * kDifference);
        v += length / ticks / rate;
        path.push_back(below(surface, v, depth));
    }
    return v;
}

std::vector<Vec3> path_over(const NurbsSurface& surface) {
    std::vector<Vec3> path{below(surface, kFirst, -kOutside)};
    go_straight(path, below(surface, kFirst, kDepth), kInwards);
    double v = along(surface, path, kFirst, kDepth, kSlideOne);
    go_straight(path, below(surface, v, kDeeper), kPress);
    v = along(surface, path, v, kDeeper, kSlideTwo);
    return path;
}

}  // namespace

std::shared_ptr<const NurbsSurface> dome() {
    constexpr std::array<double, 4> kFlat{-0.05, -0.0167, 0.0167, 0.05};  // m
    std::vector<std::vector<Vec3>> points(4);
    std::vector<std::vector<double>> weights(4);
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) {
            const bool inner_u = i == 1 || i == 2;
            const bool inner_v = j == 1 || j == 2;
            const double height = inner_u && inner_v ? 0.046 : inner_u || inner_v ? 0.014 : 0.0;
            points[i].push_back({kFlat.at(i), kFlat.at(j), height});
            weights[i].push_back(inner_u && inner_v ? 1.5 : 1.0);
        }
    }
    const std::vector<double> knots{0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0};
    return std::make_shared<const NurbsSurface>(3, 3, knots, knots, points, weights);
}

SurfaceRun felt_along(const engine::SurfaceScene& scene, const std::vector<Vec3>& path) {
    engine::SurfaceState state;
    SurfaceRun run;
    for (const Vec3& hip : path) {
        const engine::SurfaceContact c = scene.tick(state, hip);
        run.push_back({.t = static_cast<double>(run.size()) * kFrictionTick,
                       .hip = hip,
                       .mode = c.mode,
                       .go = c.go,
                       .force = c.force,
                       .depth = c.cp.inside ? c.cp.distance : 0.0,
                       .normal_force = c.normal_force,
                       .friction_force = c.tangential_force,
                       .mu = c.mu,
                       .surface = c.surface,
                       .go_u = c.go_u,
                       .go_v = c.go_v});
    }
    return run;
}

SurfaceRun felt_on_dome(const std::shared_ptr<const NurbsSurface>& surface) {
    return felt_along(
        engine::SurfaceScene(surface, engine::SceneSpec{.stiffness = kFrictionStiffness,
                                                        .period = kFrictionTick,
                                                        .friction = tests::kStudyFriction}),
        path_over(*surface));
}

SurfaceMarkers find_markers(const SurfaceRun& run) {
    using enum Instant;
    return instants_of(
        run, std::array{touches, moves, breaks, deepens, sticks, is_deep, breaks, relaxed});
}

}  // namespace palpate::figures
