#include "engine/geometry/cusps.hpp"
#include "engine/math/elementary.hpp"
#include "engine/rendering/scene.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/outlines.hpp"
#include "tests/support/random.hpp"

// What palpate_stress found, one case a finding, and the law around it.
using namespace palpate::engine;

TEST_CASE("straight below the end of one edge the foot on the other is not missed") {
    SEEDED(random, std::uint64_t{300});
    const double heading = random.in(-kPi, kPi);
    const double turn = -random.in(0.05, 3.0);  // convex
    const Vec2 in{std::cos(heading), std::sin(heading)};
    const Vec2 out{std::cos(heading + turn), std::sin(heading + turn)};
    const Vec2 tip = random.point(-1.0, 1.0);
    const auto outline = polyline({tip - in, tip, tip + out});
    const CertifiedTracker tracker(*outline);
    TrackState state;
    const Vec2 normal = random.coin() ? perp(in) : perp(out);
    for (int i = 10; i >= -10; --i) {  // along the very line on which the vertex stops being a foot
        const Vec2 h = tip + (0.002 * i) * normal;
        const double distance = tracker.track(state, h).distance;
        REQUIRE(std::fabs(distance - tracker.feet().closest(h).distance) < 1e-14);
    }
}

TEST_CASE("a hand that goes in over a vertex along the normal of its edge finds the other edge") {
    // palpate_stress, seed 195: a triangle of 1 mm, the vertex at its bottom, two ticks.
    const auto outline =
        polyline({Vec2{0.0, 0.0}, Vec2{5.699779455544924e-05, -0.0008735843578463035},
                  Vec2{2.433605999841767e-05, -0.0008696442275279016}},
                 true);
    const CertifiedTracker tracker(*outline);
    TrackState state;
    for (const Vec2& h : {Vec2{5.729831566487734e-05, -0.0008735647500771157},
                          Vec2{5.651817834597551e-05, -0.0008736156508358443}}) {
        const double distance = tracker.track(state, h).distance;
        CHECK(std::fabs(distance - tracker.feet().closest(h).distance) < 1e-18);
    }
}

TEST_CASE("repeated control points at an end are no cusp, and a fold is one") {
    const Vec2 a{0.0, 0.0};
    const Vec2 b{0.03, 0.02};
    const Vec2 c{0.08, -0.01};
    const std::vector<double> even(6, 1.0);
    CHECK(
        cusps_of({std::vector<Vec2>{a, a, a, a, b, c}, even}).empty());  // C' ~ u^3: still for 2e-5
    CHECK(cusps_of({std::vector<Vec2>{c, b, a, a, a, a}, even}).empty());
    // t^8 along a line, t = 2u - 1: to and fro, so still about the turn that halving would take
    // 2^35 pieces to see through. e_8 of the blossom at j ones and 8 - j minus ones is (-1)^(8-j).
    std::vector<Vec2> fold;
    for (int j = 0; j <= 8; ++j) {
        fold.push_back(Vec2{j % 2 == 0 ? 0.05 : -0.05, 0.0});
    }
    const auto turns = cusps_of({fold, std::vector<double>(9, 1.0)});
    REQUIRE(turns.size() == 1);
    CHECK(turns[0] == Approx(0.5).epsilon(1e-9));
}

TEST_CASE("a hairpin within a span is passed, not taken for the end of the curve") {
    // C = (3 gap t + t^3, t^2) up to scale: |C'| = 3 gap at the tip, far below |C''|, and no cusp.
    const double gap = 1e-9;
    const std::vector<Vec2> points{Vec2{-1.0, 1.0}, Vec2{1.0 - gap, -0.5}, Vec2{-1.0 + gap, -0.5},
                                   Vec2{1.0, 1.0}};
    const RationalBezier<2> span(points, std::vector<double>(4, 1.0));
    const auto outline = open_outline({span});
    for (const Friction& friction : {Friction{}, Friction{.mu_s = 0.3, .mu_d = 0.3}}) {
        const Scene scene(outline, {.friction = friction});
        Random random(1);
        for (int i = 0; i < 500; ++i) {
            ContactState state;
            const Vec2 tip = span.at(0.5).point;
            const Vec2 h = tip + random.decade(-6.0, -1.0) * random.point(-1.0, 1.0);
            const Contact contact = scene.tick(state, h);
            if (contact.mode != Mode::free) {
                CAPTURE(i, h.x, h.y);
                TrackState track;
                const double nearest = scene.closest(track, h).distance;
                CHECK(glm::length(contact.go - h) <= nearest * (1.0 + 1e-9) + 1e-12);
            }
        }
    }
}

TEST_CASE("beside a shallow vertex rounding does not turn the outline inside out") {
    SEEDED(random, std::uint64_t{300});
    const double turn = (random.coin() ? 1.0 : -1.0) * random.decade(-8.5, -6.0);
    const Vec2 out{std::cos(turn), std::sin(turn)};
    const auto outline = polyline({Vec2{-1.0, 0.0}, Vec2{0.0, 0.0}, out});
    const OutlineFeet feet(*outline);
    const double depth = random.decade(-10.0, -3.0);
    const Vec2 beside{random.in(-2.0, 2.0) * std::fabs(turn) * depth, 0.0};
    CHECK(feet.closest(beside - Vec2{0.0, depth}).inside);
    CHECK_FALSE(feet.closest(beside + Vec2{0.0, depth}).inside);
}

TEST_CASE(
    "left of an open end whose control points repeat nothing is felt, however light the rest") {
    // Worst found by search: weights 0.0107 and 1000, felt at 11 of 40 distances along the normal
    // of the end.
    SEEDED(random, std::uint64_t{200}, 2912);
    std::vector<Vec2> points{random.point(-0.1, 0.1), random.point(-0.1, 0.1),
                             random.point(-0.1, 0.1), random.point(-0.1, 0.1)};
    points.push_back(points.back());
    const std::vector<double> weights{1.0, random.decade(-2.0, 0.0), random.decade(-2.0, 0.0), 1.0,
                                      random.decade(0.0, 3.0)};
    const auto outline = open_outline({RationalBezier<2>(points, weights)});
    const Scene scene(outline, {.friction = {.mu_s = 0.7, .mu_d = 0.7}});
    const Vec2 end = points.back();
    const Vec2 along = (end - points[2]) / glm::length(end - points[2]);
    for (int k = 0; k < 40; ++k) {
        const double distance = random.decade(-5.0, -3.0);
        CAPTURE(distance);
        const Vec2 left = end + distance * perp(along) + random.in(-1e-8, 1e-8) * along;
        const Vec2 right = end - distance * perp(along) - 1e-3 * distance * along;
        ContactState state;
        if (glm::length(scene.tick(state, left).go - end) < 1e-6) {  // else another part is nearer
            REQUIRE_FALSE(state.touching);
        }
        ContactState inside;
        const Contact felt = scene.tick(inside, right);
        if (glm::length(felt.go - end) < 1e-6) {
            REQUIRE(felt.mode != Mode::free);
        }
    }
}
