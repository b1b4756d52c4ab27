#include "engine/contact/closest_point.hpp"
#include "stimuli/two_curve.hpp"
#include "tests/support/arc_oracle.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

TEST_CASE("the closest point of an arc is the one of its circle, to rounding", "[contact]") {
    double worst = 0.0;
    for (std::uint64_t seed = 0; seed < 3000; ++seed) {
        Random random(seed);
        const Vec2 from = random.point(-0.1, 0.1);
        const Vec2 to = random.point(-0.1, 0.1);
        const double chord = glm::length(to - from);
        const double curvature = random.below(5) == 0 ? 0.0 : random.in(-1.9, 1.9) / chord;
        const ArcOracle oracle{from, to, curvature};
        const PieceTree<2> feet({make_arc(from, to, curvature)});
        const Vec2 h = random.point(-0.15, 0.15);
        const double size =
            std::max({chord, glm::length(h - from), 1.0 / (std::fabs(curvature) + 1.0)});
        worst = std::max(
            worst,
            std::fabs(std::sqrt(feet.closest(h).distance2) - oracle.closest(h).distance) / size);
    }
    CHECK(worst <= 1e-14);
}

TEST_CASE("at the centre of curvature every foot is as good, and one is found", "[contact]") {
    SEEDED(random, std::uint64_t{300});
    const Vec2 from = random.point(-0.1, 0.1);
    const Vec2 to = random.point(-0.1, 0.1);
    const double curvature = random.in(0.2, 1.8) / glm::length(to - from);
    const ArcOracle oracle{from, to, curvature};
    const PieceTree<2> feet({make_arc(from, to, curvature)});
    const Vec2 off = random.coin() ? Vec2{} : random.point(-1e-12, 1e-12);
    CHECK(std::fabs(std::sqrt(feet.closest(oracle.centre() + off).distance2) - oracle.radius()) <=
          1e-11);
}

TEST_CASE("the closest feature of a two-curve object agrees with circles and lines", "[contact]") {
    EACH(kappa, -20.0, -10.0, -5.0, 0.0, 5.0, 10.0, 20.0);
    const stimuli::TwoCurve object{.curvature = kappa};
    const auto outline = stimuli::make_outline(object);
    const OutlineFeet feet(*outline);
    const std::array<ArcOracle, 3> oracle{ArcOracle{object.a, object.vertex, kappa},
                                          ArcOracle{object.vertex, object.b, kappa},
                                          ArcOracle{object.b, object.a, 0.0}};
    Random random(static_cast<std::uint64_t>(kappa + 100.0));
    for (int i = 0; i < 3000; ++i) {
        const Vec2 h = Vec2{random.in(-0.07, 0.07), random.in(-0.03, 0.07)};
        CAPTURE(h.x, h.y);
        double best = 1e9;
        for (const ArcOracle& arc : oracle) {
            best = std::min(best, arc.closest(h).distance);
        }
        const ClosestPoint found = feet.closest(h);
        REQUIRE(std::fabs(found.distance - best) <= 1e-15);
        // Inside: right of every chord, plus the caps of convex arcs, minus those of concave ones.
        const auto right_of = [&h](const ArcOracle& arc) {
            if (arc.curvature == 0.0) {
                return glm::dot(h - arc.from, arc.left()) < 0.0;
            }
            const bool beyond_chord = glm::dot(h - arc.from, arc.left()) < 0.0;
            const bool in_circle = glm::length(h - arc.centre()) < arc.radius();
            return arc.curvature > 0.0 ? in_circle || beyond_chord : beyond_chord && !in_circle;
        };
        if (best > 1e-9) {
            CHECK(found.inside ==
                  (right_of(oracle[0]) && right_of(oracle[1]) && right_of(oracle[2])));
        }
    }
}

TEST_CASE("outside a convex vertex the closest feature is the vertex, with the fan angle of HIP",
          "[contact]") {
    const auto outline = stimuli::make_outline({});
    const OutlineFeet feet(*outline);
    for (int i = 1; i < 90; ++i) {
        // Normals of the straight object run from 135 degrees (A-V) clockwise to 45 degrees (V-B).
        const double angle = (135.0 - i) * M_PI / 180.0;
        const ClosestPoint cp =
            feet.closest(Vec2{0.0, 0.040} + 0.01 * Vec2{std::cos(angle), std::sin(angle)});
        CHECK(cp.place.on_seam);
        CHECK(cp.place.index == 0);
        CHECK_FALSE(cp.inside);
        CHECK(std::fabs(cp.place.parameter - i * M_PI / 180.0) < 1e-12);
    }
}

TEST_CASE("a concave vertex is the closest feature of a fan inside the object", "[contact]") {
    const Outline chain({make_line({-1.0, 0.0}, {0.0, 0.0}), make_line({0.0, 0.0}, {0.0, 1.0})},
                        false);
    const OutlineFeet feet(chain);
    const ClosestPoint cp = feet.closest({0.3, -0.2});
    CHECK(cp.place.on_seam);
    CHECK(cp.inside);
    CHECK(std::fabs(cp.distance - std::hypot(0.3, 0.2)) < 1e-15);
}
