#include "engine/math/elementary.hpp"
#include "engine/rendering/scene.hpp"
#include "stimuli/two_curve.hpp"
#include "tests/support/catch.hpp"
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

TEST_CASE("while the hand stays near a smooth outline hardly any tick searches", "[contact]") {
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

TEST_CASE("a cusp inside a curve is a vertex that turns by pi, and nothing near it is missed",
          "[geometry][contact]") {
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

TEST_CASE("spans of one smooth curve join smoothly, and names lead back to its parameter",
          "[geometry]") {
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

TEST_CASE("out of reach a tick computes nothing, and no touch comes late", "[rendering][law]") {
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

TEST_CASE("a press into a flat face at 0.1 m/s feels K d + B v", "[rendering]") {
    const Outline floor({make_line({-1.0, 0.0}, {1.0, 0.0})}, false);
    const Scene flat(std::make_shared<const Outline>(floor), {.damping = 0.4});
    ContactState pressed;
    static_cast<void>(flat.tick(pressed, {0.0, 0.0}));
    for (int i = 1; i < 20; ++i) {
        const Contact c = flat.tick(pressed, {0.0, -1e-4 * i});
        CHECK(c.normal_force == Approx(0.1 * i + 0.4 * 0.1).epsilon(1e-9));
    }
}
