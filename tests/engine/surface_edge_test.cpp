#include "tests/support/catch.hpp"
#include "tests/support/outlines.hpp"
#include "tests/support/surface_cuts.hpp"
#include "tests/support/surface_scenes.hpp"

using namespace palpate::engine;

namespace {

constexpr double kHalf = 0.05;

/// A roof of two sides: as an outline in the plane, and as two surfaces along y.
struct Ridge {
    double left = 0.0;  ///< fall of the left side, per width
    double right = 0.0;

    [[nodiscard]] Scene plane(const SceneSpec& spec) const {
        return {polyline({{-kHalf, -left * kHalf}, {0.0, 0.0}, {kHalf, -right * kHalf}}), spec};
    }
    [[nodiscard]] SurfaceScene space(const SceneSpec& spec, int turns = 0) const {
        auto sides = roof(kHalf, left, right);
        sides[0] = turned_by(sides[0], turns);
        sides[1] = turned_by(sides[1], turns / 4);
        return {made(sides), SurfaceSceneSpec{.contact = spec}};
    }
};

/// To and fro over the ridge, a few millimetres deep: at t seconds, in the plane.
struct Swing {
    double hz[2];
    double phase;
    double depth;

    explicit Swing(Random& random)
        : hz{random.in(0.5, 2.0), random.in(0.2, 1.0)},
          phase(random.in(0.0, 6.0)),
          depth(random.in(0.002, 0.006)) {}
    [[nodiscard]] Vec2 at(double t, const Ridge& ridge) const {
        const double x = 0.02 * std::sin(6.283185307179586 * hz[0] * t + phase);
        const double surface = x < 0.0 ? ridge.left * x : -ridge.right * x;
        return {x, surface - depth * (0.7 + std::sin(6.283185307179586 * hz[1] * t))};
    }
};

Ridge some_ridge(Random& random) {
    const double left = random.in(-0.3, 1.0);
    return {left, random.in(0.1, 1.2) - left};
}

}  // namespace

TEST_CASE(
    "over a convex edge a surface is felt as its outline in the plane, with vertex slew and "
    "damper") {
    SEEDED(random, std::uint64_t{24});
    const Ridge ridge = some_ridge(random);
    SceneSpec spec{.friction = seed % 3U == 0U ? Friction{} : some_friction(seed)};
    spec.slew = seed % 4U == 3U ? Slew{} : Slew{random.in(0.05, 0.4), random.in(0.001, 0.005)};
    spec.damping = seed % 2U == 0U ? 0.0 : random.in(0.1, 2.0);
    const Scene plane = ridge.plane(spec);
    const SurfaceScene space = ridge.space(spec, static_cast<int>(seed));
    const Swing swing(random);
    ContactState in_plane;
    SurfaceState in_space;
    double worst = 0.0;
    int slewed = 0;
    int touched = 0;
    for (int k = 0; k < 4000; ++k) {
        const Vec2 h = swing.at(k * kPeriod, ridge);
        const Contact a = plane.tick(in_plane, h);
        const SurfaceContact b = space.tick(in_space, Vec3{h.x, 0.0, h.y});
        worst = std::max(worst, glm::length(b.force - Vec3{a.force.x, 0.0, a.force.y}));
        CAPTURE(k, a.force.x, a.force.y, b.force.x, b.force.z);
        REQUIRE(worst < 1e-8);
        slewed += b.vertex_slew ? 1 : 0;
        touched += b.mode != Mode::free ? 1 : 0;
    }
    CHECK(touched > 1000);
    CHECK((slewed > 5) == !spec.slew.none());
}

TEST_CASE("a convex edge is felt alike at 1 and at 10 kHz with vertex slew") {
    SEEDED(random, std::uint64_t{5}, 60U);
    const Ridge ridge = some_ridge(random);
    const Swing swing(random);
    const auto forces = [&](double rate, const Slew& slew) {
        const SurfaceScene scene = ridge.space({.period = 1.0 / rate, .slew = slew});
        SurfaceState state;
        std::vector<Vec3> felt;
        const int every = static_cast<int>(std::lround(rate / 1000.0));
        for (int k = 0; k < 1000 * every; ++k) {
            const Vec2 h = swing.at(k / rate, ridge);
            const SurfaceContact c = scene.tick(state, Vec3{h.x, 0.01 * h.x, h.y});
            if (k % every == 0) {
                felt.push_back(c.force);
            }
        }
        return felt;
    };
    const auto apart = [](const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
        double sum = 0.0;
        for (std::size_t k = 0; k < a.size(); ++k) {
            sum += glm::dot(a[k] - b[k], a[k] - b[k]);
        }
        return std::sqrt(sum / static_cast<double>(a.size()));
    };
    const Slew slew{0.2, 0.003};
    const auto exact = forces(100'000.0, slew);
    const double at_1 = apart(forces(1000.0, slew), exact);
    const double at_10 = apart(forces(10'000.0, slew), exact);
    CHECK(at_1 < 0.1);
    CHECK(at_10 < 0.012);
}

TEST_CASE("in the fan of an edge the god-object goes along with the hand") {
    SEEDED(random, std::uint64_t{8});
    const Ridge ridge{0.0, random.in(0.5, 2.0)};
    const double mu = seed % 2U == 0U ? 0.0 : random.in(0.1, 0.4);
    const SurfaceScene scene = ridge.space(
        {.friction = {.mu_s = mu, .mu_d = mu}, .slew = {0.05, 0.02}}, static_cast<int>(seed));
    SurfaceState state;
    int in_fan = 0;
    for (int k = 0; k < 400; ++k) {  // over the edge, and along it
        const Vec3 h{-0.002 + 2e-5 * k, 1e-4 * k - 0.02, -0.003};
        const SurfaceContact c = scene.tick(state, h);
        const double reach = mu * c.normal_force / kStiffness;
        if (state.fan.on) {
            ++in_fan;
            REQUIRE(std::fabs(c.go.x) < 1e-15);
            REQUIRE(std::fabs(c.go.y - h.y) <=
                    reach + 5e-5 * mu + 1e-9);  // the load falls as it turns
            REQUIRE(std::fabs(c.go.z) < 1e-15);
        }
        REQUIRE(c.tangential_force <= mu * c.normal_force + 1e-9);
    }
    CHECK(in_fan > 30);
}

TEST_CASE("the work of a tick on a surface is bounded, and what it could not do is said") {
    // A sheet that is nearly a line under different weights: no search can prove its closest point.
    Random random(7);
    SurfaceData d = random_surface(random, 1.0, 3.0, 5, true);
    for (auto& row : d.points) {
        for (Vec3& p : row) {
            p = Vec3{p.x, 1e-9 * p.y, 1e-9 * p.z};
        }
    }
    const SurfaceFeet feet(made(d));
    SurfaceTrack patient;
    SurfaceTrack hurried;
    int given_up = 0;
    for (int k = 0; k < 10; ++k) {
        const Vec3 h{random.in(-0.4, 0.4), random.in(-0.1, 0.1), random.in(-0.1, 0.1)};
        const SurfaceClosest first = feet.track(hurried, h, 300'000);
        const SurfaceClosest all = feet.track(patient, h, 30'000'000);
        given_up += first.proven ? 0 : 1;
        if (first.proven && all.proven) {
            CHECK(first.distance == Approx(all.distance).margin(1e-14));
        }
    }
    CHECK(given_up > 0);
}
