#include "tests/support/allocations.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/surface_cuts.hpp"
#include "tests/support/surface_scenes.hpp"

using namespace palpate::engine;

using Catch::Matchers::Contains;

namespace {

SurfaceScene scene_of(const std::vector<SurfaceData>& pieces, const Friction& friction) {
    return {made(pieces), SurfaceSceneSpec{.contact = {.friction = friction}}};
}

/// The middle of a knot interval, or a knot.
double somewhere(const std::vector<double>& knots, int degree, Random& random) {
    const auto p = static_cast<std::size_t>(degree);
    const std::size_t k = p + random.index(knots.size() - 2 * p - 1);
    return random.coin() && knots[k] > knots.front() ? knots[k] : 0.5 * (knots[k] + knots[k + 1]);
}

}  // namespace

TEST_CASE("a surface that is cut into four is felt as if it were whole") {
    SEEDED(random, std::uint64_t{20}, 900U);
    const SurfaceData whole = seed % 2U == 0U ? bicubic_8x8(random, 0.7) : bicubic_8x8(random, 0.0);
    const double u = somewhere(whole.knots_u, 3, random);
    const double v = somewhere(whole.knots_v, 3, random);
    const SurfaceData knotted = turned_by(creased_u(turned_by(creased_u(whole, u), 1), v), 3);
    const Friction friction = seed % 5U == 4U ? Friction{} : some_friction(seed);
    const SurfaceScene one = scene_of(knotted, friction);
    const SurfaceScene four = scene_of(quarters(whole, u, v, random), friction);
    SurfaceState state_one;
    SurfaceState state_four;
    double worst = 0.0;
    int touched = 0;
    std::array<int, 4> on{};
    for (const Vec3& h : surface_hand(one.surface(), seed, 6000, 0.002, 0.25)) {
        const SurfaceContact a = one.tick(state_one, h);
        const SurfaceContact b = four.tick(state_four, h);
        REQUIRE(b.cp.proven);
        REQUIRE(std::fabs(b.cp.distance - a.cp.distance) < 1e-15);
        REQUIRE(a.mode == b.mode);
        worst = std::max(worst, glm::length(a.force - b.force));
        touched += b.mode != Mode::free ? 1 : 0;
        ++on.at(static_cast<std::size_t>(b.surface));
    }
    CHECK(touched > 1000);
    CHECK(std::count_if(on.begin(), on.end(), [](int n) { return n > 0; }) >= 2);
    CHECK(worst < 1e-8);
}

TEST_CASE("the closest point of several surfaces is the nearest of all of theirs") {
    SEEDED(random, std::uint64_t{6}, 40U);
    const SurfaceData whole = seed % 3U == 0U ? torus(0.06, 0.02)
                            : seed % 3U == 1U ? bicubic_8x8(random, 0.7, 0.03)
                                              : sphere(0.05);
    const bool ball = seed % 3U == 2U;  // its knots in v end at 2
    const auto pieces = quarters(whole, ball ? 1.5 : 2.0, ball ? 1.0 : random.in(0.5, 1.5), random);
    const SurfaceFeet feet(std::make_shared<const SurfaceObject>(made(pieces)));
    std::vector<SurfaceOracle> oracles(pieces.begin(), pieces.end());
    SurfaceTrack track;
    Vec3 h{};
    for (int k = 0; k < 25; ++k) {
        const bool jump = k % 5 == 0;
        const double reach = jump ? 0.08 : 0.003;
        h = (jump ? Vec3{} : h) +
            Vec3{random.in(-reach, reach), random.in(-reach, reach), random.in(-reach, reach)};
        long double exact = 1e300L;
        for (SurfaceOracle& oracle : oracles) {
            exact = std::min(exact, oracle.distance(h, 12));
        }
        const SurfaceClosest found = feet.track(track, h);
        CHECK(found.proven);
        CHECK(std::fabs(found.distance - static_cast<double>(exact)) < 1e-15);
    }
}

TEST_CASE("from a box of six sides distance, closest point and side are the closed forms") {
    SEEDED(random, std::uint64_t{10});
    const Vec3 half{random.in(0.01, 0.05), random.in(0.01, 0.05), random.in(0.01, 0.05)};
    const SurfaceFeet feet(std::make_shared<const SurfaceObject>(made(box_sides(half, random))));
    for (int k = 0; k < 400; ++k) {
        Vec3 h{};
        for (int c = 0; c < 3; ++c) {
            h[c] = half[c] * random.in(-1.5, 1.5);
        }
        const Vec3 out = glm::max(glm::abs(h) - half, Vec3{});
        const Vec3 room = half - glm::abs(h);
        const bool inside = glm::length(out) == 0.0;
        const double exact = inside ? std::min({room.x, room.y, room.z}) : glm::length(out);
        const SurfaceClosest found = feet.closest(h);
        REQUIRE(found.proven);
        REQUIRE(std::fabs(found.distance - exact) < 2e-17);
        REQUIRE(found.inside == inside);
    }
}

TEST_CASE("from below a valley a hand meets the surface, in the crease and beside it") {
    // Through a rising crease HIP comes from nowhere nearer to a side than to the crease.
    SEEDED(random, std::uint64_t{20});
    const double left = random.in(0.2, 2.0);
    const double right = random.in(0.2, 2.0);
    const SurfaceScene scene =
        scene_of(roof(0.05, -left, -right), seed % 4U == 0U ? Friction{} : some_friction(seed));
    SurfaceState state;
    const Vec3 way{random.in(-0.3, 0.3) / left, random.in(-0.2, 0.2), -1.0};
    Vec3 last{};
    const double step = 2e-5;
    for (int k = -20; k < 200; ++k) {
        const Vec3 h = (step * k) * way;
        const SurfaceContact c = scene.tick(state, h);
        if (k <= 0) {
            continue;
        }
        REQUIRE(c.mode != Mode::free);
        REQUIRE(c.settled);
        if (k > 1) {
            REQUIRE(glm::length(c.force - last) < (2.0 + 2.0 * c.mu) * kStiffness * step *
                                                      glm::length(way) *
                                                      (1.0 + std::max(left, right)));
        }
        last = c.force;
    }
}

TEST_CASE("surfaces that cannot be one object are refused with what to give") {
    const auto object = [](const std::vector<SurfaceData>& pieces) {
        return SurfaceObject(made(pieces));
    };
    auto pieces = roof(0.05, 1.0, 0.5);
    CHECK_NOTHROW(object(pieces));
    CHECK_THROWS_WITH(object({}), Contains("give at least one"));

    auto gap = pieces;
    gap[1].points[0][0].z += 1e-6;
    CHECK_THROWS_WITH(object(gap), Contains("border u = 1 of surface 1") && Contains("m apart") &&
                                       Contains("surface 2"));
    auto flipped = pieces;
    std::reverse(flipped[1].points.begin(), flipped[1].points.end());
    CHECK_THROWS_WITH(object(flipped), Contains("in the other order"));
    auto third = pieces;
    third.push_back(pieces[1]);
    CHECK_THROWS_WITH(object(third), Contains("more than one neighbour"));

    // A side that is longer than its neighbour, and one with another pace along the same border.
    auto longer = pieces;
    for (auto& row : longer[1].points) {
        row[1].y = 0.08;
    }
    CHECK_THROWS_WITH(object(longer), Contains("runs along") && Contains("cut"));
    auto pace = pieces;
    pace[1].weights = {{1.0, 3.0}, {1.0, 3.0}};
    CHECK_THROWS_WITH(object(pace), Contains("runs along") && Contains("weights"));
    auto scaled = pieces;  // all weights times one number is the same surface
    scaled[1].weights = {{3.0, 3.0}, {3.0, 3.0}};
    CHECK_NOTHROW(object(scaled));
}

TEST_CASE("without friction a ball pushes back by K times the depth, straight out") {
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

TEST_CASE("not looking while out of reach changes no force on a closed surface") {
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

TEST_CASE("a tick on a surface allocates nothing") {
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

TEST_CASE("a HIP over a surface that is not finite gives zero force, and the next tick is sane") {
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

TEST_CASE("a surface scene refuses values out of range, with the value and the remedy") {
    const auto refuse = [](const SceneSpec& spec) {
        return SurfaceScene(made(plane(0.05)), spec);
    };
    CHECK_THROWS_WITH(refuse({.stiffness = 0.0}), Has("stiffness is 0", "above 0"));
    CHECK_THROWS_WITH(refuse({.period = -0.001}), Has("tick period"));
    CHECK_THROWS_WITH(refuse({.friction = {.mu_s = 0.4, .mu_d = 0.5}}),
                      Has("mu_s is 0.4", "not below mu_d"));
    CHECK_THROWS_WITH(refuse({.friction = {.mu_s = 0.4, .mu_d = -0.5}}), Has("mu_d is -0.5"));
    CHECK_THROWS_WITH(refuse({.compliance = 1e-4}), Has("compliance"));
    CHECK_THROWS_WITH(SurfaceScene(nullptr, SceneSpec{}), Has("give a surface"));
}
