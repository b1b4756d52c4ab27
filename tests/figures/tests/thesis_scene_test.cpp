#include <cstring>

#include "tests/figures/thesis/thesis_scene.hpp"
#include "tests/support/allocations.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"
#include "tests/support/thesis_objects.hpp"

using namespace palpate::engine;
using namespace palpate::figures;

namespace {

constexpr double kSceneTick = 0.001;
constexpr ThesisLaw kLaws[] = {ThesisLaw::frictionless, ThesisLaw::literal, ThesisLaw::latched};

ThesisScene scene_of(ThesisLaw law, const TrackerSpec& tracker) {
    return ThesisScene(two_cubics(), false, {.tracker = tracker, .law = law});
}

/// Over the two cubics and back, out and in, with a seeded phase, 3 s.
std::vector<Vec2> hand(unsigned seed) {
    Random random(seed);
    const double a = random.in(0.0, 6.0);
    const double b = random.in(0.0, 6.0);
    const auto curves = two_cubics();
    std::vector<Vec2> path;
    for (int k = 0; k < 3000; ++k) {
        const double t = k * kSceneTick;
        const double w = 1.0 + 0.9 * std::sin(3.0 * t + a);
        const auto& curve = curves[w < 1.0 ? 0 : 1];
        const Jet<2> jet = curve.at(w < 1.0 ? w : w - 1.0);
        const double offset = -0.002 + 0.004 * std::sin(5.0 * t + b);
        path.push_back(jet.point + offset * perp(glm::normalize(jet.first)));
    }
    return path;
}

const TrackerSpec kNewton{.kind = TrackerKind::newton, .iterations = 3};

}  // namespace

TEST_CASE("with an exact tracker the frictionless thesis scene is K times the penetration") {
    SEED(5U);
    const auto curves = two_cubics();
    const ThesisScene scene = scene_of(ThesisLaw::frictionless, kNewton);
    ThesisState state;
    int touching = 0;
    for (const Vec2& hip : hand(seed)) {
        const ThesisTick tick = scene.tick(state, hip);
        if (tick.mode == Mode::free) {
            continue;
        }
        ++touching;
        REQUIRE(glm::length(tick.force) ==
                Approx(1000.0 * true_distance(two_polygons(), hip)).margin(1e-5));
        REQUIRE(std::fabs(tick.ft) < 1e-5);
        REQUIRE(glm::length(tick.go - tick.cp) == 0.0);
    }
    CHECK(touching > 1000);
}

TEST_CASE("a lagging tracker is felt as drag without friction") {
    const ThesisScene scene = scene_of(ThesisLaw::frictionless,
                                       {.gain = feedback_gain(two_cubics()[0], 0.04, kSceneTick)});
    ThesisState state;
    double max = 0.0;
    for (const Vec2& hip : hand(1)) {
        max = std::max(max, std::fabs(scene.tick(state, hip).ft));
    }
    CHECK(max > 0.5);  // N, at 1000 N/m: the point lags by more than half a millimetre
}

TEST_CASE("no contact, no force: and a stuck GO rests but for its seating") {
    SEED(5U);
    for (const ThesisLaw law : kLaws) {
        const ThesisScene scene = scene_of(law, kNewton);
        ThesisState state;
        for (const Vec2& hip : hand(seed)) {
            const Vec2 go_before = state.go.point;
            const bool held = state.touching && !state.friction.dynamic && !state.friction.seat;
            const ThesisTick tick = scene.tick(state, hip);
            if (tick.mode == Mode::free) {
                REQUIRE(tick.force == Vec2{0.0, 0.0});
                REQUIRE(tick.mu == 0.0);
                REQUIRE_FALSE(state.friction.locked);  // item 11: regions may switch in free space
            } else if (law != ThesisLaw::frictionless && held) {
                REQUIRE(tick.go == go_before);
            }
            if (tick.mode != Mode::free) {
                REQUIRE(tick.fn > 0.0);
            }
        }
    }
}

TEST_CASE("finite in, finite out, for every law, tracker and region rule") {
    SEEDED(random, 12U);
    for (const ThesisLaw law : kLaws) {
        for (const TrackerKind kind :
             {TrackerKind::feedback, TrackerKind::feed_forward, TrackerKind::feedback_linearised,
              TrackerKind::tangent_plane, TrackerKind::newton}) {
            const ThesisScene scene(
                two_cubics(), false,
                {.tracker = {.kind = kind, .gain = random.decade(0.0, 9.0)},
                 .law = law,
                 .dead_band = random.coin() ? 0.0 : 0.001,
                 .region = random.coin() ? RegionRule::end_normals : RegionRule::nearest_feature});
            ThesisState state;
            for (int k = 0; k < 300; ++k) {
                const double reach = k % 50 == 49 ? 1e8 : 0.06;
                const ThesisTick tick = scene.tick(state, random.point(-reach, reach));
                REQUIRE(std::isfinite(tick.force.x));
                REQUIRE(std::isfinite(tick.force.y));
                REQUIRE((tick.segment < 2 && tick.cp_segment < 2));
                REQUIRE((tick.u >= 0.0 && tick.u <= 1.0));
            }
        }
    }
}

TEST_CASE("a thesis scene repeats to the bit, can be copied mid-way and allocates nothing") {
    for (const ThesisLaw law : kLaws) {
        const ThesisScene scene =
            scene_of(law, {.gain = feedback_gain(two_cubics()[0], 0.5, kSceneTick)});
        const auto path = hand(4);
        ThesisState first;
        ThesisState second;
        const std::size_t before = allocations();
        bool same = true;
        for (std::size_t k = 0; k < path.size(); ++k) {
            if (k == path.size() / 2) {
                second = first;
            }
            const ThesisTick a = scene.tick(first, path[k]);
            const ThesisTick b = scene.tick(second, path[k]);
            same = same &&
                   (k < path.size() / 2 || std::memcmp(&a.force, &b.force, sizeof a.force) == 0);
        }
        CHECK(same);
        CHECK(allocations() == before);
    }
}

TEST_CASE("a HIP that is not finite ends the thesis contact, and the next tick is sane") {
    const double bad = GENERATE(std::numeric_limits<double>::quiet_NaN(),
                                std::numeric_limits<double>::infinity(), 1e10);
    for (const ThesisLaw law : kLaws) {
        const ThesisScene scene = scene_of(law, kNewton);
        ThesisState state;
        const Vec2 inside{-0.02, 0.02};
        const ThesisTick touching = scene.tick(state, inside);
        REQUIRE(touching.mode != Mode::free);
        const ThesisTick refused = scene.tick(state, {bad, 0.0});
        CHECK(refused.refused);
        CHECK(refused.mode == Mode::free);
        CHECK(refused.force == Vec2{0.0, 0.0});
        const ThesisTick again = scene.tick(state, inside);
        CHECK(again.fn == Approx(touching.fn));
        CHECK(again.ft == Approx(touching.ft).margin(1e-9));
    }
}

TEST_CASE("a thesis scene refuses bad numbers") {
    const auto make = [](const ThesisSpec& spec) {
        return ThesisScene(two_cubics(), false, spec);
    };
    CHECK_THROWS_WITH(make({.stiffness = -5.0}), Has("stiffness is -5"));
    CHECK_THROWS_WITH(make({.period = 0.0}), Has("tick period is 0"));
    CHECK_THROWS_WITH(make({.mu_s = 0.4}), Has("mu_s is 0.4"));
    CHECK_THROWS_WITH(make({.mu_d = -0.5}), Has("mu_d is -0.5"));
    CHECK_THROWS_WITH(make({.epsilon = 0.0}), Has("epsilon"));
    CHECK_THROWS_WITH(make({.dead_band = NAN}), Has("dead band is nan"));
    CHECK_THROWS_WITH(make({.tracker = {.gain = 0.0}}), Has("gain"));
}
