#include "tests/support/allocations.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/surface_scenes.hpp"

using namespace palpate::engine;

TEST_CASE("without friction a ball pushes back by K times the depth, straight out",
          "[scene][surface][law]") {
    const double r = 0.04;
    const SurfaceScene scene = scene_of(sphere(r), {});
    SurfaceState state;
    double worst = 0.0;
    double worst_at_pole = 0.0;
    int touched = 0;
    for (const Vec3& h : surface_hand(scene.surface(), 1, 6000, 0.004, 0.18, 0.5)) {
        const SurfaceContact c = scene.tick(state, h);
        const double depth = r - glm::length(h);
        const Vec3 exact = depth > 0.0 ? (kStiffness * depth / glm::length(h)) * h : Vec3{};
        const double off = glm::length(c.force - exact);
        // At a distance e from a pole, parameters have 1e-20 m / e digits of the foot.
        (std::hypot(h.x, h.y) > 1e-4 ? worst : worst_at_pole) =
            std::max(std::hypot(h.x, h.y) > 1e-4 ? worst : worst_at_pole, off);
        touched += c.mode != Mode::free ? 1 : 0;
        REQUIRE((c.mode != Mode::free) == (depth > 0.0));
    }
    CHECK(touched > 2000);
    CHECK(worst < 1e-11);
    CHECK(worst_at_pole < 1e-5);
}

TEST_CASE("not looking while out of reach changes no force on a closed surface",
          "[scene][surface][law]") {
    SEED(std::uint64_t{8});
    const SurfaceData data = seed % 2U == 0U ? torus(0.06, 0.025) : sphere(0.04);
    const SurfaceScene plain = scene_of(data, kFriction);
    const SurfaceScene lazy = scene_of(data, kFriction, true);
    SurfaceState a;
    SurfaceState b;
    int touched = 0;
    for (const Vec3& h : surface_hand(plain.surface(), seed, 5000, 0.02, 0.3, 0.5)) {
        const SurfaceContact x = plain.tick(a, h);
        const SurfaceContact y = lazy.tick(b, h);
        REQUIRE(x.mode == y.mode);
        REQUIRE(glm::length(x.force - y.force) < 1e-10);
        REQUIRE(y.cp.distance <= x.cp.distance + 1e-15);
        touched += x.mode != Mode::free ? 1 : 0;
    }
    CHECK(touched > 100);
    CHECK(a.skipped == 0);
    CHECK(b.skipped > 500);
}

TEST_CASE("a tick on a surface allocates nothing", "[scene][surface][law]") {
    for (const Friction& friction : {Friction{}, kFriction}) {
        for (std::uint64_t seed = 0; seed < 4; ++seed) {
            const SurfaceScene scene = scene_of(smooth_object(seed), friction, seed % 2U == 1U);
            const auto path = surface_hand(scene.surface(), seed, 1000, 0.003, 0.2, 0.5);
            SurfaceState state;
            const std::size_t before = allocations();
            for (const Vec3& h : path) {
                static_cast<void>(scene.tick(state, h));
            }
            CHECK(allocations() == before);
        }
    }
}

TEST_CASE("a HIP over a surface that is not finite gives zero force, and the next tick is sane",
          "[scene][surface][law]") {
    const double bad = GENERATE(std::numeric_limits<double>::quiet_NaN(),
                                std::numeric_limits<double>::infinity(), -1e300);
    for (const bool skip : {false, true}) {
        const SurfaceScene scene = scene_of(sphere(0.04), kFriction, skip);
        SurfaceState state;
        static_cast<void>(scene.tick(state, Vec3{0.0, 0.01, 0.05}));
        const SurfaceContact inside = scene.tick(state, Vec3{0.0, 0.01, 0.037});
        REQUIRE(inside.mode != Mode::free);
        for (int axis = 0; axis < 3; ++axis) {
            Vec3 h{0.0, 0.01, 0.037};
            h[axis] = bad;
            const SurfaceContact refused = scene.tick(state, h);
            CHECK(refused.refused);
            CHECK(refused.force == Vec3{});
            const SurfaceContact again = scene.tick(state, Vec3{0.0, 0.01, 0.037});
            CHECK(glm::length(again.force - inside.force) < 1e-10);
        }
        SurfaceState fresh;
        CHECK(scene.tick(fresh, Vec3{bad}).refused);
        CHECK(scene.tick(fresh, Vec3{0.0, 0.0, 0.05}).mode == Mode::free);
    }
}

TEST_CASE("a surface scene refuses values out of range, with the value and the remedy",
          "[scene][surface]") {
    const auto refuse = [](const SceneSpec& spec) {
        return SurfaceScene(shared(plane(0.05)), spec);
    };
    CHECK_THROWS_WITH(refuse({.stiffness = 0.0}), Has("stiffness is 0", "above 0"));
    CHECK_THROWS_WITH(refuse({.period = -0.001}), Has("tick period"));
    CHECK_THROWS_WITH(refuse({.friction = {.mu_s = 0.4, .mu_d = 0.5}}),
                      Has("mu_s is 0.4", "not below mu_d"));
    CHECK_THROWS_WITH(refuse({.friction = {.mu_s = 0.4, .mu_d = -0.5}}), Has("mu_d is -0.5"));
    CHECK_THROWS_WITH(refuse({.compliance = 1e-4}), Has("compliance"));
    CHECK_THROWS_WITH(SurfaceScene(nullptr, SceneSpec{}), Has("give a surface"));
}
