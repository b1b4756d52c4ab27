#include "engine/rendering/scene.hpp"
#include "stimuli/two_curve.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/outlines.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

namespace {

std::shared_ptr<const Outline> corner(const Vec2& from, const Vec2& to) {
    return polyline({from, {0.0, 0.0}, to});
}

/// Ground whose surface is `height` lower from x = 0 on; the foot of the step is at x = `foot`.
std::shared_ptr<const Outline> barb(double height, double foot) {
    return polyline(
        {{-0.04, 0.0}, {0.0, 0.0}, {foot, -height}, {0.04, -height}, {0.04, -0.04}, {-0.04, -0.04}},
        true);
}

}  // namespace

TEST_CASE("a stuck contact knows nothing of Voronoi regions: the corner rule") {
    // HIP passes under a shallow convex corner while the GO is stuck before it: the force stays
    // that of the spring, in a straight line with HIP, although the closest feature changes.
    const Scene scene(corner({-0.1, 0.0}, {0.1, -0.04}),
                      {.friction = kStudyFriction, .slew = kStudySlew});
    ContactState state;
    static_cast<void>(scene.tick(state, {-0.001, 0.001}));
    const Contact first = scene.tick(state, {-0.001, -0.010});
    REQUIRE(first.mode != Mode::free);
    TrackState track;
    std::size_t changes = 0;
    for (int k = 1; k <= 30; ++k) {
        const Vec2 h{-0.001 + k * 1e-4, -0.010};
        const Contact c = scene.tick(state, h);
        REQUIRE(c.mode == Mode::stuck);
        CHECK(glm::length(c.force - 1000.0 * (first.go - h)) < 1e-12);
        changes += scene.closest(track, h).place.index != 0 ? 1U : 0U;
    }
    CHECK(changes > 0);
}

TEST_CASE(
    "a convex vertex is crossed whole, and the GO arrives on the other curve's closest point") {
    for (const Slew& slew : {Slew{}, kStudySlew}) {
        const Scene scene(corner({-0.1, 0.0}, {0.1, -0.04}), {.slew = slew});
        ContactState state;
        Contact c;
        for (int k = 0; k <= 400; ++k) {  // along the corner, 3 mm below
            const double x = -0.02 + k * 1e-4;
            c = scene.tick(state, {x, -0.003 - std::max(0.0, 0.4 * x)});
        }
        for (int k = 0; k < 50; ++k) {
            c = scene.tick(state, state.last_hip);
        }
        CHECK_FALSE(c.place.on_seam);
        CHECK(c.place.index == 1);
        TrackState track;
        CHECK(glm::length(c.go - scene.closest(track, state.last_hip).point) < 1e-14);
    }
}

TEST_CASE("slew spreads the corner: smaller steps of force than without") {
    const auto largest_step = [](const Slew& slew) {
        const Scene scene(corner({-0.1, 0.0}, {0.1, -0.04}), {.slew = slew});
        ContactState state;
        Vec2 last{};
        double max = 0.0;
        for (int k = 0; k <= 4000; ++k) {
            const double x = -0.02 + k * 1e-5;
            const Contact c = scene.tick(state, {x, -0.003 - std::max(0.0, 0.4 * x)});
            max = k > 1 ? std::max(max, glm::length(c.force - last)) : 0.0;
            last = c.force;
        }
        return max;
    };
    // Without: the closest-point normal flips by atan(0.4) at once, a jump near 2 K d sin(turn /
    // 2).
    CHECK(largest_step({}) > 0.9);
    CHECK(largest_step(kStudySlew) < 0.3);
}

TEST_CASE("a step is felt as it is, whatever its height and the way that its wall leans") {
    // A hand goes over a step down, deeper than it is high. The ground is parallel on both sides,
    // so that a frictionless hand feels K times its depth below the one that it is over.
    Random random(31);
    for (int scene_at = 0; scene_at < 200; ++scene_at) {
        const double height = std::pow(10.0, random.in(-6.0, -2.7));
        const double lean = std::tan(random.in(-1.3, 1.3));
        const double depth = height * random.in(1.5, 3.0) + random.in(0.0, 0.004);
        const double speed = random.in(0.005, 0.4);
        const double period = std::array{1e-3, 2.5e-4, 1e-4}.at(random.index(3));
        CAPTURE(scene_at, height, lean, depth, speed, period);
        const Scene scene(barb(height, -height * lean), {.period = period, .slew = kStudySlew});
        ContactState state;
        for (double y = 0.0005; y > -depth; y -= 0.05 * period) {
            static_cast<void>(scene.tick(state, {-0.01, y}));
        }
        for (double x = -0.01; x < 0.01; x += speed * period) {
            const Contact c = scene.tick(state, {x, -depth});
            const double least = 1000.0 * (depth - height) * (1.0 - 1e-9);
            REQUIRE(c.force.y >= least);
            REQUIRE(c.force.y <= 1000.0 * depth * (1.0 + 1e-9));
        }
    }
}

TEST_CASE("past the tip of a thin spike a hand in the object feels it in the same tick") {
    // Friction holds the god-object on the spike until it goes over its tip; HIP is deep in what
    // the spike grows from.
    for (const Slew& slew : {Slew{}, kStudySlew}) {
        for (const double lean : {60.0, 70.0, 80.0}) {
            for (const double mu : {0.5, 0.7, 1.0}) {
                CAPTURE(slew.speed, lean, mu);
                const Scene scene(barb(0.0002, -0.0002 * std::tan(lean * std::numbers::pi / 180.0)),
                                  {.friction = {.mu_s = mu, .mu_d = mu}, .slew = slew});
                ContactState state;
                for (int k = 0; k <= 60; ++k) {
                    static_cast<void>(scene.tick(state, {-0.02, 0.002 - k * 1e-4}));
                }
                std::size_t over = 0;
                for (int k = 1; k < 420; ++k) {
                    const Contact c = scene.tick(state, {-0.02 + k * 1e-4, -0.004});
                    REQUIRE(glm::length(c.force) >= 3.8 * (1.0 - 1e-9));
                    over += c.place.index >= 2 ? 1U : 0U;
                }
                CHECK(over > 100);
            }
        }
    }
}

TEST_CASE("in a concave vertex both normals carry, and no friction lets go of the force") {
    SEEDED(random, std::uint64_t{50});
    const double angle = random.in(0.2, 1.5);  // turn to the left
    const Scene scene(corner({-0.1, 0.0}, {0.1 * std::cos(angle), 0.1 * std::sin(angle)}),
                      {.friction = seed % 2 == 0 ? kStudyFriction : Friction{}});
    ContactState state;
    // Straight into the internal fan of the vertex, between the two inward normals.
    const double between = random.in(0.1, 0.9) * angle;
    const Vec2 into{std::sin(between), -std::cos(between)};
    Contact c;
    for (int k = -20; k <= 40; ++k) {
        c = scene.tick(state, 1e-4 * k * into);
    }
    REQUIRE(c.mode != Mode::free);
    CHECK(c.go == Vec2{});
    CHECK(glm::length(c.force + 1000.0 * 4e-3 * into) < 1e-9);
    CHECK(std::fabs(c.normal_force - 4.0) < 1e-9);
    CHECK(std::fabs(c.tangential_force) < 1e-9);
}

TEST_CASE("an open end holds the god-object until HIP leaves, inside the cone") {
    const Scene scene(polyline({{-0.1, 0.0}, {0.0, 0.0}}), {});
    ContactState state;
    Contact c;
    for (int k = 0; k <= 100; ++k) {
        c = scene.tick(state, {-0.005 + k * 1e-4, -0.002});
    }
    CHECK(c.go == Vec2{});
    CHECK(c.tangential_force == 0.0);
    CHECK(std::fabs(c.normal_force - 2.0) < 1e-12);
    c = scene.tick(state, {0.005, 0.0005});
    CHECK(c.mode == Mode::free);
}

TEST_CASE("starting inside the object begins a contact at the closest point") {
    const Scene scene(stimuli::make_outline({}), {.friction = kStudyFriction, .slew = kStudySlew});
    ContactState state;
    const Contact c = scene.tick(state, {-0.021, 0.017});
    CHECK(c.mode == Mode::stuck);
    TrackState track;
    CHECK(glm::length(c.go - scene.closest(track, state.last_hip).point) < 1e-15);
    CHECK(std::fabs(c.normal_force - 1000.0 * 0.002 / std::sqrt(2.0)) < 1e-9);
}

TEST_CASE("mu does not heal while a sliding contact turns round a vertex") {
    SEEDED(random, 20U, 2909U);
    const double slope = random.in(0.2, 1.8);  // steeper, it sticks before
    const Scene scene(
        corner({-0.1, 0.0}, {0.1, -0.1 * slope}),
        {.friction = kStudyFriction, .slew = {.speed = random.in(0.05, 0.4), .radius = 0.003}});
    ContactState state;
    const double depth = random.in(0.001, 0.004);
    const double pace = random.in(2e-5, 2e-4);  // m a tick
    double mu = 1.0;
    int turning = 0;
    bool slides = false;
    for (double x = -0.03; x < 0.02; x += pace) {
        const Contact c = scene.tick(state, {x, -depth - std::max(0.0, slope * x)});
        slides = slides || (c.mode != Mode::free && c.mode != Mode::stuck);
        if (!slides) {
            continue;
        }
        REQUIRE(c.mode != Mode::free);
        turning += c.place.on_seam ? 1 : 0;
        CHECK(c.mu <= mu);
        mu = c.mu;
    }
    CHECK(turning > 0);
}

TEST_CASE("the turn at the vertex is 90 degrees less twice what the arcs take up") {
    // Each arc turns by 2 asin(kappa c / 2) over its chord, half of it at either end.
    EACH(kappa, -20.0, -10.0, -5.0, 0.0, 5.0, 10.0, 20.0);
    const auto outline = stimuli::make_outline({.curvature = kappa});
    const double half_chord = 0.5 * std::hypot(0.040, 0.040);
    const Seam& vertex = outline->seams()[0];
    CHECK(vertex.kind == SeamKind::convex);
    CHECK(std::fabs(vertex.turn - (M_PI / 2.0 - 2.0 * std::asin(kappa * half_chord))) < 1e-14);
    CHECK(outline->seams().size() == 3);
    CHECK(outline->seams()[1].kind == SeamKind::convex);
    CHECK(outline->seams()[2].kind == SeamKind::convex);
}

TEST_CASE("seams are classified by the side to which the outline turns") {
    const auto bend = [](Vec2 end) {
        return Outline({make_line({-1.0, 0.0}, {0.0, 0.0}), make_line({0.0, 0.0}, end)}, false)
            .seams()[0];
    };
    CHECK(bend({1.0, -0.5}).kind == SeamKind::convex);
    CHECK(bend({1.0, 0.5}).kind == SeamKind::concave);
    CHECK(bend({1.0, 0.0}).kind == SeamKind::smooth);
}

TEST_CASE("an outline that is not one is refused with the reason") {
    CHECK_THROWS_WITH(Outline(std::vector<RationalBezier<2>>{}, false), Has("at least one"));
    CHECK_THROWS_WITH(
        Outline({make_line({0.0, 0.0}, {1.0, 0.0}), make_line({1.0, 0.1}, {2.0, 0.0})}, false),
        Has("segment 2 starts 0.1"));
    CHECK_THROWS_WITH(
        Outline({make_line({0.0, 0.0}, {1.0, 0.0}), make_line({1.0, 0.0}, {0.0, 0.0})}, false),
        Has("runs back along itself"));
    CHECK_THROWS_WITH(
        stimuli::make_outline({.a = {0.04, 0.0}, .vertex = {0.0, 0.04}, .b = {-0.04, 0.0}}),
        Has("clockwise"));
}

TEST_CASE("walking over every end of a closed outline comes back to the start") {
    const auto outline = stimuli::make_outline({});
    std::size_t segment = 0;
    for (int i = 0; i < 3; ++i) {
        segment = outline->seams()[outline->seam_beyond(segment, true).value()].after;
    }
    CHECK(segment == 0);
    for (int i = 0; i < 3; ++i) {
        segment = outline->seams()[outline->seam_beyond(segment, false).value()].before;
    }
    CHECK(segment == 0);
    const Outline open({make_line({0.0, 0.0}, {1.0, 0.0})}, false);
    CHECK_FALSE(open.seam_beyond(0, true).has_value());
    CHECK_FALSE(open.seam_beyond(0, false).has_value());
}
