#include "engine/math/elementary.hpp"
#include "engine/rendering/scene.hpp"
#include "stimuli/two_curve.hpp"
#include "tests/support/arc_oracle.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/frame.hpp"
#include "tests/support/outlines.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

namespace {

/// A hand that wanders around `size` in steps of up to `step`, and sometimes jumps.
class Wanderer {
public:
    Wanderer(Random& random, double size, double step)
        : random_(&random), size_(size), step_(step) {}

    Vec2 next() {
        if (random_->below(200) == 0) {
            at_ = size_ * random_->point(-0.7, 0.7);
            speed_ = Vec2{};
        }
        speed_ = 0.95 * speed_ + (0.3 * step_) * random_->point(-1.0, 1.0);
        at_ += speed_;
        if (std::max(std::fabs(at_.x), std::fabs(at_.y)) > size_) {
            speed_ = -speed_;
            at_ += 2.0 * speed_;
        }
        return at_;
    }

private:
    Random* random_;
    double size_;
    double step_;
    Vec2 at_{};
    Vec2 speed_{};
};

}  // namespace

TEST_CASE("while the hand stays near a smooth outline hardly any tick searches") {
    EACH(kappa, -20.0, 0.0, 20.0);
    const auto outline = stimuli::make_outline({.curvature = kappa});
    const CertifiedTracker tracker(*outline);
    TrackState state;
    for (int i = 0; i < 4000; ++i) {  // a stroke of 40 mm along the first curve, 2 mm above it
        const Frame frame = frame_at(outline->spans()[0], 0.1 + 0.7 * i / 4000.0);
        const Vec2 h = frame.point + 0.002 * frame.normal;
        const ClosestPoint cp = tracker.track(state, h);
        REQUIRE(cp.distance == Approx(0.002).epsilon(1e-12));
        REQUIRE_FALSE(cp.inside);
    }
    CHECK(state.searched < 80);
}

TEST_CASE("a cusp inside a curve is a vertex that turns by pi, and nothing near it is missed") {
    // C'(1/2) = 3/4 (P3 + P2 - P1 - P0) = 0: the control legs cross.
    const std::vector<Vec2> points{Vec2{0.0, 0.0}, Vec2{0.08, 0.08}, Vec2{0.0, 0.08},
                                   Vec2{0.08, 0.0}};
    const NurbsCurve<2> curve(3, {0, 0, 0, 0, 1, 1, 1, 1}, points);
    const Outline chain(std::vector<NurbsCurve<2>>{curve}, false);
    REQUIRE(chain.spans().size() == 2);
    REQUIRE(chain.seams().size() == 1);
    CHECK(chain.seams()[0].turn == Approx(kPi).epsilon(1e-6));
    CHECK(chain.seams()[0].kind == SeamKind::convex);
    CHECK(chain.name(1).lo == Approx(0.5).epsilon(1e-9));
    const Vec2 tip = chain.seams()[0].point;
    CHECK(tip.y == Approx(0.06).epsilon(1e-9));
    const ClosestPoint above = OutlineFeet(chain).closest(tip + Vec2{0.001, 0.002});
    CHECK(above.place.on_seam);
    CHECK_FALSE(above.inside);
}

TEST_CASE("spans of one smooth curve join smoothly, and names lead back to its parameter") {
    const std::vector<Vec2> points{Vec2{-0.05, 0.0}, Vec2{-0.03, 0.03}, Vec2{0.0, 0.035},
                                   Vec2{0.03, 0.03}, Vec2{0.05, 0.0}};
    const NurbsCurve<2> curve(3, {0, 0, 0, 0, 2.5, 4, 4, 4, 4}, points);
    const Outline chain(std::vector<NurbsCurve<2>>{curve}, false);
    REQUIRE(chain.spans().size() == 2);
    CHECK(chain.seams()[0].kind == SeamKind::smooth);
    CHECK(chain.name(0).parameter(1.0) == 2.5);
    CHECK(chain.name(1).parameter(0.5) == 3.25);
    CHECK(glm::length(chain.spans()[1].at(0.5).point - curve.at(3.25).point) < 1e-16);
}

TEST_CASE("out of reach a tick computes nothing, and no touch comes late") {
    SEEDED(random, 20U);
    const auto outline = stimuli::make_outline({.curvature = random.in(-20.0, 20.0)});
    const Friction friction{.mu_s = 0.7, .mu_d = 0.5, .tau_slip = 0.02, .tau_heal = 0.1};
    const Scene scene(outline, {.friction = friction});
    ContactState a;
    ContactState b;
    Wanderer hand(random, 0.08, 0.001);
    std::uint64_t apart = 0;
    for (int i = 0; i < 5000; ++i) {
        const Vec2 h = hand.next();
        const Contact left = scene.tick(a, h);
        b.clear2 = 0.0;  // looks on every tick
        const Contact right = scene.tick(b, h);
        const bool touch = left.mode != Mode::free;
        const bool same =
            touch == (right.mode != Mode::free) && glm::length(left.force - right.force) < 1e-10;
        apart += same ? 0U : 1U;
    }
    CHECK(apart == 0);
    CHECK(a.skipped > 500);
    CHECK(b.skipped == 0);
}

TEST_CASE("a press into a flat face at 0.1 m/s feels K d + B v") {
    const Scene flat(polyline({{-1.0, 0.0}, {1.0, 0.0}}), {.damping = 0.4});
    ContactState pressed;
    static_cast<void>(flat.tick(pressed, {0.0, 0.0}));
    for (int i = 1; i < 20; ++i) {
        const Contact c = flat.tick(pressed, {0.0, -1e-4 * i});
        CHECK(c.normal_force == Approx(0.1 * i + 0.4 * 0.1).epsilon(1e-9));
    }
}

TEST_CASE("the closest point of an arc is the one of its circle, to rounding") {
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

TEST_CASE("at the centre of curvature every foot is as good, and one is found") {
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

TEST_CASE("the closest feature of a two-curve object agrees with circles and lines") {
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

TEST_CASE("outside a convex vertex the closest feature is the vertex, with the fan angle of HIP") {
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

TEST_CASE("a concave vertex is the closest feature of a fan inside the object") {
    const Outline chain({make_line({-1.0, 0.0}, {0.0, 0.0}), make_line({0.0, 0.0}, {0.0, 1.0})},
                        false);
    const OutlineFeet feet(chain);
    const ClosestPoint cp = feet.closest({0.3, -0.2});
    CHECK(cp.place.on_seam);
    CHECK(cp.inside);
    CHECK(std::fabs(cp.distance - std::hypot(0.3, 0.2)) < 1e-15);
}
