#include "engine/surface/surface_trim.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/surface_cuts.hpp"
#include "tests/support/surface_scenes.hpp"

using namespace palpate::engine;
using Catch::Matchers::Contains;

namespace {

TrimLoop rectangle(double lo_u, double hi_u, double lo_v, double hi_v, bool clockwise = false) {
    TrimLoop loop{Vec2{lo_u, lo_v}, Vec2{hi_u, lo_v}, Vec2{hi_u, hi_v}, Vec2{lo_u, hi_v}};
    if (clockwise) {
        std::reverse(loop.begin(), loop.end());
    }
    return loop;
}

/// What the loops of the tests leave, cut by Boehm's rule: columns of u, then pieces of v.
SurfaceData cell(const SurfaceData& d, double lo_u, double hi_u, double lo_v, double hi_v) {
    const auto within = [](const SurfaceData& whole, double lo, double hi) {
        SurfaceData part = whole;
        part = hi < part.knots_u.back() ? cut_u(part, hi).first : part;
        return lo > part.knots_u.front() ? cut_u(part, lo).second : part;
    };
    const SurfaceData column = turned_by(within(d, lo_u, hi_u), 1);  // u runs as v did
    return turned_by(within(column, lo_v, hi_v), 3);
}

}  // namespace

TEST_CASE("what trims leave is felt as the same pieces cut by hand") {
    SEEDED(random, std::uint64_t{12}, 300U);
    const SurfaceData whole = bicubic_8x8(random, seed % 2U == 0U ? 0.7 : 0.0);
    const std::array<double, 4> u{0.0, random.in(0.5, 2.2), random.in(2.6, 4.5), 5.0};
    const std::array<double, 4> v{0.0, 1.0, random.in(2.6, 4.5), 5.0};
    // A hole in the middle, and what lies outside of an outer loop round the rest of it.
    const std::vector<TrimLoop> loops{rectangle(u[0], u[3], v[0], v[3]),
                                      rectangle(u[1], u[2], v[1], v[2], true)};
    const Friction friction = some_friction(seed);
    const SurfaceSceneSpec spec{.contact = {.friction = friction}};
    const NurbsSurface surface = make_surface(whole);
    std::vector<SurfaceData> by_hand;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            if (i != 1 || j != 1) {
                by_hand.push_back(cell(whole, u[i], u[i + 1], v[j], v[j + 1]));
            }
        }
    }
    const SurfaceScene trims(trimmed(surface, loops), spec);
    const SurfaceScene parts(made(by_hand), spec);
    REQUIRE(trims.object().count() == 8);
    SurfaceState state_a;
    SurfaceState state_b;
    double worst = 0.0;
    int touched = 0;
    for (const Vec3& h : surface_hand(surface, seed, 6000, 0.002, 0.25)) {
        const SurfaceContact a = trims.tick(state_a, h);
        const SurfaceContact b = parts.tick(state_b, h);
        REQUIRE(a.cp.proven);
        REQUIRE(std::fabs(a.cp.distance - b.cp.distance) < 1e-15);
        const bool in_hole = a.go_u > u[1] && a.go_u < u[2] && a.go_v > v[1] && a.go_v < v[2];
        REQUIRE(!in_hole);
        if (a.mode != Mode::free) {
            REQUIRE(glm::length(surface.at(a.go_u, a.go_v).point - a.go) < 1e-15);
        }
        worst = std::max(worst, glm::length(a.force - b.force));
        touched += a.mode != Mode::free ? 1 : 0;
    }
    CHECK(touched > 300);
    CHECK(worst < 1e-8);
}

TEST_CASE("over a hole the closest point is on its border, or on the rest of the surface") {
    SEEDED(random, std::uint64_t{6});
    const SurfaceData whole = bicubic_8x8(random, 0.5, 0.02);
    const double lo_u = random.in(0.5, 2.0);
    const double hi_v = random.in(3.0, 4.5);
    const NurbsSurface surface = make_surface(whole);
    const std::vector<TrimLoop> loops{rectangle(lo_u, 3.0, 1.5, hi_v, true)};
    const SurfaceFeet feet(std::make_shared<const SurfaceObject>(trimmed(surface, loops)));
    std::vector<SurfaceOracle> oracles;
    for (const auto& [a, b] :
         {std::array{0.0, lo_u}, std::array{lo_u, 3.0}, std::array{3.0, 5.0}}) {
        for (const auto& [c, d] :
             {std::array{0.0, 1.5}, std::array{1.5, hi_v}, std::array{hi_v, 5.0}}) {
            if (a != lo_u || c != 1.5) {
                oracles.emplace_back(cell(whole, a, b, c, d));
            }
        }
    }
    for (int k = 0; k < 15; ++k) {
        const double u = random.in(lo_u, 3.0);
        const double v = random.in(1.5, hi_v);
        const Vec3 h = surface.at(u, v).point + random.in(-0.005, 0.005) * surface.normal(u, v);
        long double exact = 1e300L;
        for (SurfaceOracle& oracle : oracles) {
            exact = std::min(exact, oracle.distance(h, 12));
        }
        const SurfaceClosest found = feet.closest(h);
        CHECK(found.proven);
        CHECK(!found.inside);
        CHECK(std::fabs(found.distance - static_cast<double>(exact)) < 1e-15);
    }
}

TEST_CASE("trims that cannot be are refused with what to give") {
    const NurbsSurface sheet = make_surface(plane(0.05));
    const auto with = [&](const std::vector<TrimLoop>& loops) {
        return trimmed(sheet, loops);
    };
    CHECK(with({}).size() == 1);
    CHECK(with({rectangle(0.2, 0.6, 0.0, 1.0)}).size() == 1);
    CHECK(with({rectangle(0.2, 0.6, 0.1, 0.5, true)}).size() == 8);
    CHECK_THROWS_WITH(with({{Vec2{0, 0}, Vec2{1, 0}, Vec2{1, 1}}}), Contains("4 or more"));
    CHECK_THROWS_WITH(with({{Vec2{0, 0}, Vec2{1, 0.1}, Vec2{1, 1}, Vec2{0, 1}}}),
                      Contains("not supported") && Contains("(1, 0.1)"));
    CHECK_THROWS_WITH(with({rectangle(0.2, 1.6, 0.1, 0.5)}), Contains("give u from 0 to 1"));
    CHECK_THROWS_WITH(with({rectangle(0.2, 0.2 + 1e-12, 0.1, 0.5)}), Contains("nearly touch"));
    CHECK_THROWS_WITH(with({rectangle(0.2, 0.6, 0.1, 0.5), rectangle(0.3, 0.7, 0.2, 0.9)}),
                      Contains("counter-clockwise"));
    CHECK_THROWS_WITH(with({rectangle(0.2, 0.6, 0.1, 0.5), rectangle(0.2, 0.6, 0.1, 0.5, true)}),
                      Contains("leave nothing"));
}
