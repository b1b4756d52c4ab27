#include "tests/figures/thesis/region_switch.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"
#include "tests/support/thesis_objects.hpp"

using namespace palpate::engine;
using namespace palpate::figures;

namespace {

constexpr double kRoof = 22.0 * M_PI / 180.0;

/// Two straight edges that meet in the origin and turn by `turn`, > 0 towards the object (convex).
std::vector<NurbsCurve<2>> roof(double turn) {
    const Vec2 away{std::cos(turn), -std::sin(turn)};
    return {line({-0.1, 0.0}, {0.0, 0.0}), line({0.0, 0.0}, 0.1 * away)};
}

std::vector<NurbsCurve<2>> triangle() {
    const Vec2 a{-0.05, 0.0};
    const Vec2 b{0.0, 0.05};
    const Vec2 c{0.05, 0.0};
    return {line(a, b), line(b, c), line(c, a)};
}

/// Exact feet: one Newton step on a straight edge.
std::vector<TrackedFoot> feet_of(const std::vector<NurbsCurve<2>>& chain, const Vec2& hip) {
    std::vector<TrackedFoot> feet;
    for (const auto& curve : chain) {
        const CurveTracker tracker(curve, {.kind = TrackerKind::newton});
        TrackerState state = tracker.start(hip);
        feet.push_back(tracker.step(state, hip, 0.001));
    }
    return feet;
}

}  // namespace

TEST_CASE("outside a convex vertex nearest features give the thesis' borders, the end normals") {
    const auto chain = roof(kRoof);
    const RegionSwitch near(chain, false, RegionRule::nearest_feature);
    const RegionSwitch lines(chain, false, RegionRule::end_normals);
    SEEDED(random, 300U);
    const double angle =
        random.in(-1.2, 1.2);  // from the first normal, clockwise, all of it outside
    const Vec2 hip = random.in(0.001, 0.03) * Vec2{std::sin(angle), std::cos(angle)};
    if (std::fabs(angle) < 1e-6 || std::fabs(angle - kRoof) < 1e-6) {
        return;
    }
    const auto feet = feet_of(chain, hip);
    for (const std::size_t active : {std::size_t{0}, std::size_t{1}}) {
        // Left of the first normal: curve 0; right of the second: curve 1; between them what was.
        const std::size_t expected = angle < 0.0 ? 0 : angle > kRoof ? 1 : active;
        CHECK(near.next(active, feet, hip, false) == expected);
        CHECK(lines.next(active, feet, hip, false) == expected);
        CHECK_FALSE(near.inside(near.nearest(active, feet, hip, true), feet, hip));
    }
}

TEST_CASE("inside a convex vertex nearest features meet on the bisector, end normals overlap") {
    const auto chain = roof(kRoof);
    const RegionSwitch near(chain, false, RegionRule::nearest_feature);
    const RegionSwitch lines(chain, false, RegionRule::end_normals);
    SEEDED(random, 300U);
    const double angle = random.in(-0.5, 0.5);  // from the bisector, > 0 towards the second edge
    const double mid = kRoof / 2.0;
    const Vec2 hip = -random.in(0.001, 0.02) * Vec2{std::sin(mid - angle), std::cos(mid - angle)};
    const auto feet = feet_of(chain, hip);
    for (const std::size_t active : {std::size_t{0}, std::size_t{1}}) {
        CHECK(near.next(active, feet, hip, false) == (angle < 0.0 ? 0U : 1U));
        const std::size_t literal = angle > mid ? 1U : angle < -mid ? 0U : active;
        CHECK(lines.next(active, feet, hip, false) == literal);
        CHECK(near.next(active, feet, hip, true) == active);  // the lock of STUCK
        CHECK(near.inside(near.nearest(active, feet, hip, true), feet, hip));
    }
}

TEST_CASE("inside and outside at vertices are those of the half-planes, convex and concave") {
    SEEDED(random, 300U);
    const double turn = random.in(-1.5, 1.5);
    const auto chain = roof(turn);
    const RegionSwitch regions(chain, false, RegionRule::nearest_feature);
    const Vec2 hip = random.point(-0.02, 0.02);
    const auto feet = feet_of(chain, hip);
    const bool below = hip.y < 0.0;
    const bool behind = glm::dot(hip, Vec2{std::sin(turn), std::cos(turn)}) < 0.0;
    CHECK(regions.inside(regions.nearest(0, feet, hip, true), feet, hip) ==
          (turn > 0.0 ? below && behind : below || behind));
}

TEST_CASE("a closed chain has an inside everywhere, an open end has none beyond") {
    const auto chain = triangle();
    const RegionSwitch regions(chain, true, RegionRule::nearest_feature);
    CHECK(regions.after(2) == std::size_t{0});
    CHECK(regions.before(0) == std::size_t{2});
    const auto in = [&](const Vec2& hip) {
        const auto feet = feet_of(chain, hip);
        return regions.inside(regions.nearest(0, feet, hip, true), feet, hip);
    };
    CHECK(in({0.0, 0.02}));
    CHECK(in({0.0, 0.001}));
    CHECK_FALSE(in({0.0, -0.001}));
    CHECK_FALSE(in({0.06, -0.001}));

    const auto open = roof(kRoof);
    const RegionSwitch ends(open, false, RegionRule::nearest_feature);
    const Vec2 beyond{-0.101, -0.001};
    CHECK_FALSE(ends.inside(0, feet_of(open, beyond), beyond));
    CHECK_FALSE(ends.before(0).has_value());
}

TEST_CASE("a chain is refused when ends do not meet or when it runs the wrong way") {
    const auto make = [](std::vector<NurbsCurve<2>> chain, bool closed) {
        return RegionSwitch(chain, closed, RegionRule::nearest_feature);
    };
    CHECK_THROWS_WITH(make({}, false), Has("0 curves"));
    CHECK_THROWS_WITH(make({line({0.0, 0.0}, {1.0, 0.0}), line({1.0, 0.25}, {2.0, 0.0})}, false),
                      Has("0.25 m", "share the point"));
    CHECK_THROWS_WITH(make(roof(kRoof), true), Has("curve 0 starts"));
    CHECK_THROWS_WITH(make({line({-0.05, 0.0}, {0.05, 0.0}), line({0.05, 0.0}, {0.0, 0.05}),
                            line({0.0, 0.05}, {-0.05, 0.0})},
                           true),
                      Has("clockwise"));
    CHECK_THROWS_WITH(make({bezier({{0.0, 0.0}, {0.0, 0.0}, {1.0, 0.0}})}, false),
                      Has("no tangent"));
}
