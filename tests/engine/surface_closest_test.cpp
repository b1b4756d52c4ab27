#include "tests/support/allocations.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/surface_cuts.hpp"
#include "tests/support/surface_scenes.hpp"

using namespace palpate::engine;

namespace {

SurfaceFeet feet_of(const SurfaceData& data) {
    return SurfaceFeet(made(data));
}

Vec3 random_point(Random& random, double size) {
    const double x = size * random.in(-1.0, 1.0);
    const double y = size * random.in(-1.0, 1.0);
    return Vec3{x, y, size * random.in(-1.0, 1.0)};
}

}  // namespace

TEST_CASE("the closest point of any surface is the one an independent search finds") {
    SEEDED(random, 12U);
    const double size = seed % 5U == 4U ? random.decade(-4.0, 3.0) : 0.1;
    const SurfaceData data =
        random_surface(random, size, seed % 3U == 0U ? 0.0 : 1.0, 5, seed % 2U == 0U);
    const SurfaceFeet feet = feet_of(data);
    SurfaceOracle oracle(data);
    for (int k = 0; k < 25; ++k) {
        const Vec3 h = random_point(random, random.coin() ? 0.6 * size : 2.0 * size);
        const SurfaceClosest got = feet.closest(h);
        CAPTURE(k, h.x, h.y, h.z);
        CHECK(got.proven);
        const auto exact = static_cast<double>(oracle.distance(h, 40));
        CHECK(got.distance <= exact + 1e-14 * size);
        // Samples may miss a spike altogether, which the proof does not (seed 7: by 2 mm).
        if (exact - got.distance < 1e-6 * size) {
            CHECK(got.distance >= exact - 1e-14 * size);
        }
        CHECK(glm::length(h - got.point) ==
              Approx(got.distance).epsilon(1e-13).margin(1e-15 * size));
        const Vec3 on = feet.object().surface(0).at(got.u, got.v).point;
        CHECK(glm::length(on - got.point) <= 2e-14 * size);
    }
}

TEST_CASE("closest points of a ball, a ring and a tube are those of their formulas") {
    SEEDED(random, 6U);
    const double r = 0.03;
    const SurfaceFeet ball = feet_of(sphere(r));
    const SurfaceFeet ring = feet_of(torus(0.06, 0.02));
    const SurfaceFeet tube = feet_of(cylinder(r, 0.1));
    for (int k = 0; k < 300; ++k) {
        const Vec3 h = random_point(random, 0.09);
        CAPTURE(k, h.x, h.y, h.z);
        const double axis = std::hypot(h.x, h.y);
        const SurfaceClosest b = ball.closest(h);
        CHECK(std::fabs(b.distance - std::fabs(glm::length(h) - r)) < 2e-16);
        CHECK(b.inside == (glm::length(h) < r));
        const SurfaceClosest t = ring.closest(h);
        const double tube_distance = std::hypot(axis - 0.06, h.z) - 0.02;
        CHECK(std::fabs(t.distance - std::fabs(tube_distance)) < 2e-16);
        CHECK(t.inside == (tube_distance < 0.0));
        const SurfaceClosest c = tube.closest(h);
        const double beyond = h.z < 0.0 ? -h.z : h.z > 0.1 ? h.z - 0.1 : 0.0;
        CHECK(std::fabs(c.distance - std::hypot(axis - r, beyond)) < 2e-16);
        CHECK(c.inside == (beyond == 0.0 && axis < r));
        CHECK((b.proven && t.proven && c.proven));
    }
}

TEST_CASE("borders and corners of an open sheet belong to it") {
    const SurfaceFeet sheet = feet_of(plane(0.05));
    Random random(3);
    for (int k = 0; k < 500; ++k) {
        const Vec3 h = random_point(random, 0.1);
        const Vec3 foot{std::clamp(h.x, -0.05, 0.05), std::clamp(h.y, -0.05, 0.05), 0.0};
        const SurfaceClosest got = sheet.closest(h);
        CHECK(glm::length(got.point - foot) < 1e-16);
        CHECK(got.inside == (h.z < 0.0 && foot.x == h.x && foot.y == h.y));
    }
}

TEST_CASE("centres of curvature, where every point is the closest one, are answered") {
    const double r = 0.03;
    const SurfaceFeet ball = feet_of(sphere(r));
    CHECK(std::fabs(ball.closest(Vec3{}).distance - r) < 1e-16);
    const SurfaceFeet tube = feet_of(cylinder(r, 0.1));
    CHECK(std::fabs(tube.closest(Vec3{0, 0, 0.037}).distance - r) < 1e-16);
    const SurfaceFeet ring = feet_of(torus(0.06, 0.02));
    CHECK(std::fabs(ring.closest(Vec3{}).distance - 0.04) < 1e-16);
    CHECK(std::fabs(ring.closest(Vec3{0.06, 0, 0}).distance - 0.02) < 1e-16);
    Random random(5);
    for (int k = 0; k < 200; ++k) {  // near them: flat valleys in every direction
        const double e = random.decade(-15.0, -3.0);
        const Vec3 h = random_point(random, e);
        CAPTURE(k, e);
        const SurfaceClosest b = ball.closest(h);
        CHECK(b.proven);
        CHECK(std::fabs(b.distance - (r - glm::length(h))) < 1e-15);
        const SurfaceClosest c = tube.closest(h + Vec3{0, 0, 0.05});
        CHECK(c.proven);
        CHECK(std::fabs(c.distance - (r - std::hypot(h.x, h.y))) < 1e-15);
    }
}

TEST_CASE("poles are found from every side") {
    const double r = 0.03;
    const SurfaceFeet ball = feet_of(sphere(r));
    Random random(6);
    for (int k = 0; k < 200; ++k) {
        const double e = random.decade(-15.0, -2.0);
        const double phi = random.in(0.0, 2.0 * std::numbers::pi);
        const double z = random.coin() ? r : -r;
        const Vec3 h = random.in(0.8, 1.2) * Vec3{e * std::cos(phi), e * std::sin(phi), z};
        CAPTURE(k, e, phi, z);
        const SurfaceClosest got = ball.closest(h);
        CHECK(got.proven);
        CHECK(std::fabs(got.distance - std::fabs(glm::length(h) - r)) < 2e-16);
        CHECK(got.inside == (glm::length(h) < r));
    }
}

TEST_CASE("right beside a pole the foot is as near as any heading out of it leads") {
    // So near to the tip the patch is its tangents there, S(u, v) = tip + 2 u (P1(v) - tip) +
    // O(u^2), P1(v) the second row's Bezier curve: the foot is at most as far as the nearest of
    // 2,001 of them.
    SurfaceData patch;
    patch.degree_u = 2;
    patch.degree_v = 2;
    patch.knots_u = {0, 0, 0, 1, 1, 1};
    patch.knots_v = patch.knots_u;
    const Vec3 tip{0.0084, -0.0038, 0.0195};
    patch.points = {
        {tip, tip, tip},
        {Vec3{0.042, -0.006, 0.006}, Vec3{0.0459, 0.0491, 0.0127}, Vec3{0.043, 0.103, -0.0048}},
        {Vec3{0.1061, -0.0036, 0.0063}, Vec3{0.1024, 0.0409, -0.0123},
         Vec3{0.1029, 0.1071, -0.0166}}};
    const SurfaceFeet feet = feet_of(patch);
    Random random(2910);
    for (int k = 0; k < 300; ++k) {
        const Vec3 r = random.decade(-12.0, -8.0) *
                       Vec3{random.in(-1.0, 1.0), random.in(-1.0, 1.0), random.in(-1.0, 1.0)};
        double nearest = glm::length(r);
        for (int i = 0; i <= 2000; ++i) {
            const double v = i / 2000.0;
            const auto& row = patch.points[1];
            const Vec3 along = (1.0 - v) * (1.0 - v) * row[0] + 2.0 * v * (1.0 - v) * row[1] +
                               v * v * row[2] - tip;
            const double way = std::max(glm::dot(r, along) / glm::dot(along, along), 0.0);
            nearest = std::min(nearest, glm::length(r - way * along));
        }
        CAPTURE(k, r.x, r.y, r.z);
        CHECK(feet.closest(tip + r).distance <= nearest * (1.0 + 1e-6) + 1e-16);
    }
}

TEST_CASE("a tracked hand gets the global answer on every tick, mostly without a search") {
    SEEDED(random, 16U);
    const SurfaceData data = bicubic_8x8(random, seed % 2U == 0U ? 0.0 : 0.7, 0.01 + 0.002 * seed);
    const SurfaceFeet feet = feet_of(data);
    const std::size_t ticks = 4000;
    const auto hand = surface_hand(feet.object().surface(0), seed, ticks, 0.003, 0.18);
    SurfaceTrack track;
    double worst = 0.0;
    double apart = 0.0;
    for (const Vec3& h : hand) {
        const SurfaceClosest tracked = feet.track(track, h);
        const SurfaceClosest global = feet.closest(h);
        REQUIRE(tracked.proven);
        REQUIRE(tracked.inside == global.inside);
        worst = std::max(worst, std::fabs(tracked.distance - global.distance));
        apart = std::max(apart, glm::length(tracked.point - global.point));
    }
    CHECK(worst < 1e-16);
    CHECK(apart < 1e-12);
    CHECK(track.searches + track.certified_calls == ticks);
    CHECK(track.searches < ticks / 3);
}

TEST_CASE("tracking over rings, folds, teleports and far away is global too") {
    SEEDED(random, 12U);
    const SurfaceFeet feet = feet_of(seed % 3U == 0U   ? torus(0.06, 0.02)
                                     : seed % 3U == 1U ? random_surface(random, 0.1, 0.5, 4, false)
                                                       : random_surface(random, 0.1, 0.0, 4, true));
    SurfaceTrack track;
    Vec3 h = random_point(random, 0.1);
    Vec3 velocity{};
    for (int k = 0; k < 1500; ++k) {
        velocity = 0.99 * velocity + random_point(random, 2e-5);
        h += velocity;
        if (random.below(300) == 0 || glm::length(h) > 0.2) {
            h = random_point(random, random.below(10) == 0 ? 5.0 : 0.1);
        }
        const SurfaceClosest tracked = feet.track(track, h);
        const SurfaceClosest global = feet.closest(h);
        CAPTURE(k, h.x, h.y, h.z);
        REQUIRE(tracked.proven);
        REQUIRE(std::fabs(tracked.distance - global.distance) <= 1e-15 * (1.0 + glm::length(h)));
    }
}

TEST_CASE("a proof that is renewed on the way still sees what comes near from elsewhere") {
    SEEDED(random, 4U);
    const auto sheet = [&](double height, double hills, double spread) {
        SurfaceData d{.degree_u = 3, .degree_v = 3};
        d.knots_u = d.knots_v = {0, 0, 0, 0, 1, 2, 3, 4, 5, 5, 5, 5};
        for (int i = 0; i < 8; ++i) {
            d.points.emplace_back();
            d.weights.emplace_back();
            for (int j = 0; j < 8; ++j) {
                d.points.back().push_back(
                    {0.014 * i, 0.014 * j, height + random.in(-hills, hills)});
                d.weights.back().push_back(std::exp(random.in(-spread, spread)));
            }
        }
        return made(d);
    };
    const SurfaceFeet feet(  // hills of 8 mm under a lid
        std::make_shared<const SurfaceObject>(
            std::vector{sheet(0.0, 0.008, 0.7), sheet(0.016, 0.0, 0.0)}));
    SurfaceTrack track;
    int renewed = 0;
    for (int k = 0; k < 3000; ++k) {
        const Vec3 h{0.05 + 0.03 * std::sin(0.001 * k), 0.05 + 0.03 * std::sin(0.0017 * k),
                     0.006 + 0.004 * std::sin(0.003 * k + seed)};
        CAPTURE(k, track.slack);
        const SurfaceClosest found = feet.track(track, h);
        REQUIRE(found.proven);
        REQUIRE(std::fabs(found.distance - feet.closest(h).distance) < 1e-16);
        renewed += track.reference != track.searched ? 1 : 0;
    }
    CHECK(renewed > 10);
}

TEST_CASE("above a hollow, through and beyond its centres of curvature, the answer is global") {
    SEEDED(random, 6U);
    // z = (x^2 / R + y^2 / r) / 2: beyond z = R the lowest point splits into two, left and right.
    const double big = 0.01;
    const double small = seed % 2U == 0U ? 0.03 : 0.011;
    const bool rational = seed % 3U == 1U;
    SurfaceData d{
        .degree_u = 2, .degree_v = 2, .knots_u = {0, 0, 0, 1, 1, 1}, .knots_v = {0, 0, 0, 1, 1, 1}};
    for (int i = -1; i <= 1; ++i) {
        d.points.emplace_back();
        d.weights.emplace_back();
        for (int j = -1; j <= 1; ++j) {
            const double z_u = (i == 0 ? -1.0 : 1.0) * 0.0001 / (2.0 * big);
            const double z_v = (j == 0 ? -1.0 : 1.0) * 0.0001 / (2.0 * small);
            d.points.back().push_back(Vec3{0.01 * i, 0.01 * j, z_u + z_v});
            d.weights.back().push_back(rational ? random.in(0.7, 1.4) : 1.0);
        }
    }
    const SurfaceFeet feet = feet_of(d);
    SurfaceOracle oracle(d);
    SurfaceTrack track;
    for (int k = 0; k < 3000; ++k) {
        const double t = 1e-3 * k;
        const Vec3 h{0.0007 * std::sin(9.0 * t + seed), 0.0005 * std::sin(7.0 * t),
                     0.003 + 0.005 * t};
        const SurfaceClosest tracked = feet.track(track, h);
        const SurfaceClosest global = feet.closest(h);
        CAPTURE(k, h.x, h.y, h.z);
        REQUIRE((tracked.proven && global.proven));
        REQUIRE(std::fabs(tracked.distance - global.distance) < 1e-16);
        if (k % 30 == 0) {
            const auto exact = static_cast<double>(oracle.distance(h));
            REQUIRE(std::fabs(tracked.distance - exact) < 1e-15);
        }
    }
    CHECK(track.certified_calls > 100);
}

TEST_CASE("closest points allocate nothing, and a null surface is refused") {
    Random random(1);
    const SurfaceFeet feet = feet_of(bicubic_8x8(random, 0.7));
    SurfaceTrack track;
    double sum = 0.0;
    const std::size_t before = allocations();
    for (int k = 0; k < 500; ++k) {
        const Vec3 h = random_point(random, 0.06);
        sum += feet.track(track, h).distance + feet.closest(h).distance;
    }
    CHECK(allocations() == before);
    CHECK(sum > 0.0);
    SurfaceTrack kept = track;
    const SurfaceClosest nowhere = feet.track(kept, Vec3{std::numeric_limits<double>::quiet_NaN()});
    CHECK_FALSE(nowhere.proven);
    const Vec3 next{0.01};
    CHECK(std::fabs(feet.track(kept, next).distance - feet.closest(next).distance) < 1e-16);
    CHECK_THROWS_WITH(SurfaceFeet(std::shared_ptr<const NurbsSurface>()), Has("give a surface"));
}
