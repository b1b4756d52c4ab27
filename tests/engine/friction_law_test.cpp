#include "engine/rendering/scene.hpp"
#include "stimuli/two_curve.hpp"
#include "tests/support/arc_oracle.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/hands.hpp"

using namespace palpate::engine;

namespace {

constexpr Slew kSlew{.speed = 0.2, .radius = 0.003};
constexpr Friction kFriction{.mu_s = 0.7, .mu_d = 0.5, .tau_slip = 0.02, .tau_heal = 0.1};

std::vector<Vec2> hand(std::uint64_t seed, double period = 1e-3) {
    return random_hand(seed, 4000, {-0.045, 0.0}, {0.045, 0.046}, period);
}

Friction random_friction(Random& random) {
    const double mu_s = random.in(0.05, 1.2);
    return {.mu_s = mu_s,
            .mu_d = mu_s * random.in(0.3, 1.0),
            .tau_slip = random.coin() ? 0.0 : random.in(0.001, 0.1),
            .tau_heal = random.in(0.0, 0.3)};
}

}  // namespace

TEST_CASE("whole strokes agree with the law solved by trigonometry, tick for tick",
          "[friction][law]") {
    SEEDED(random, std::uint64_t{60});
    const double kappa = seed % 5 == 0 ? 0.0 : random.in(-12.0, 12.0);
    const Friction friction = seed % 4 == 0 ? Friction{} : random_friction(random);
    const double k = random.in(100.0, 2000.0);
    const ArcOracle side{{-0.040, 0.0}, {0.0, 0.040}, kappa};
    const Scene scene(stimuli::make_outline({.curvature = kappa}),
                      {.stiffness = k, .friction = friction});
    GosOracle oracle(side, {.stiffness = k,
                            .mu_s = friction.mu_s,
                            .mu_d = friction.mu_d,
                            .tau_slip = friction.tau_slip,
                            .tau_heal = friction.tau_heal});
    ContactState state;
    double worst = 0.0;
    int touched = 0;
    for (int i = 0; i < 6000; ++i) {  // in and out of the side, away from its ends
        const double t = i * 1e-3;
        const double s = 0.5 + 0.3 * std::sin(2.1 * t + 1.0) + 0.02 * std::sin(31.0 * t);
        const ArcOracle::Foot on = side.closest(side.from + s * (side.to - side.from));
        const Vec2 h = on.point - (0.0012 + 0.002 * std::sin(3.7 * t)) * on.normal;
        const Contact contact = scene.tick(state, h);
        worst = std::max(worst, glm::length(contact.force - oracle.tick(h)));
        touched += contact.mode != Mode::free ? 1 : 0;
    }
    CHECK(touched > 2000);
    CHECK(worst <= 1e-9);
}

namespace {

/// Ticks whose force step exceeds the bound of the slewed law:
///
///     K (3 |dh| + v_r T) + pull (v_r T + 2 |dh|) / rho_v + (mu_s - mu_d) F_N T / tau_slip + 0.02 N
///
/// The first term moves HIP and GO, the second turns the normal of a vertex fan, the third relaxes
/// mu. While the fan holds the GO outside its cone, turning it swings the whole stretch r into the
/// load, so that the second term's pull is |F| + K |r| sqrt(1 + mu_s^2) and not |F| alone.
int steps_above_bound(const Scene& scene, const std::vector<Vec2>& path) {
    const double k = scene.spec().stiffness;
    const double period = scene.spec().period;
    ContactState state;
    Contact last;
    Vec2 last_h{};
    bool started = false;
    int violations = 0;
    for (const Vec2& h : path) {
        const Contact now = scene.tick(state, h);
        if (started && last.mode != Mode::free && now.mode != Mode::free) {
            const double dh = glm::length(h - last_h);
            const double r = std::max(glm::length(last.go - last_h), glm::length(now.go - h));
            const double pull = std::max(glm::length(last.force), glm::length(now.force)) +
                                k * r * std::sqrt(1.0 + kFriction.mu_s * kFriction.mu_s);
            const double bound =
                k * (3.0 * dh + kSlew.speed * period) +
                pull * (kSlew.speed * period + 2.0 * dh) / kSlew.radius +
                (kFriction.mu_s - kFriction.mu_d) * now.normal_force * period / kFriction.tau_slip +
                0.02;
            violations += glm::length(now.force - last.force) > bound ? 1 : 0;
        }
        started = true;
        last = now;
        last_h = h;
    }
    return violations;
}

}  // namespace

TEST_CASE("with vertex slew the force never steps by more than the bound", "[friction][law]") {
    SEED(std::uint64_t{40});
    EACH(rate, 1000.0, 4000.0);
    const Scene scene(stimuli::make_outline({.curvature = Random(seed).in(-10.0, 10.0)}),
                      {.period = 1.0 / rate, .friction = kFriction, .slew = kSlew});
    CHECK(steps_above_bound(scene, hand(seed, 1.0 / rate)) == 0);
}

TEST_CASE("round a shallow corner the force never steps by more than the bound",
          "[friction][law]") {
    SEED(std::uint64_t{20});
    const Scene scene(
        std::make_shared<const Outline>(Outline(
            {make_line({-0.1, 0.0}, {0.0, 0.0}), make_line({0.0, 0.0}, {0.1, -0.0404})}, false)),
        {.friction = kFriction, .slew = kSlew});
    CHECK(steps_above_bound(scene, random_hand(seed, 4000, {-0.03, -0.012}, {0.03, 0.002})) == 0);
}

TEST_CASE("a hand at rest is stuck, and its friction is held", "[friction][law]") {
    const Scene scene(stimuli::make_outline({.curvature = 5.0}),
                      {.friction = kFriction, .slew = kSlew});
    ContactState state;
    Vec2 h{-0.025, 0.020};
    static_cast<void>(scene.tick(state, {-0.03, 0.03}));
    for (int k = 0; k < 20; ++k) {  // press, then pull a little along the side: below breakaway
        h += Vec2{0.00005, -0.0001};
        static_cast<void>(scene.tick(state, h));
    }
    for (int k = 0; k < 1000; ++k) {  // let a slip that the pull began run out
        static_cast<void>(scene.tick(state, h));
    }
    const Contact held = scene.tick(state, h);
    CHECK(held.mode == Mode::stuck);
    CHECK(std::fabs(held.tangential_force) > 0.05);
    for (int k = 0; k < 5000; ++k) {
        const Contact c = scene.tick(state, h);
        REQUIRE(c.mode == Mode::stuck);
        REQUIRE(c.force == held.force);
    }
}

TEST_CASE("break-away comes at mu_s and the slip settles at mu_d with the time constant given",
          "[friction][law]") {
    const Scene scene(
        std::make_shared<const Outline>(Outline({make_line({-1.0, 0.0}, {1.0, 0.0})}, false)),
        {.friction = kFriction});
    ContactState state;
    const double depth = 0.003;
    static_cast<void>(scene.tick(state, {0.0, 0.001}));
    static_cast<void>(scene.tick(state, {0.0, -depth}));
    double broke_at = 0.0;
    int slipping = 0;
    double worst = 0.0;
    for (int k = 1; k < 400; ++k) {
        const double x = k * 2e-5;  // 20 mm/s
        const Contact c = scene.tick(state, {x, -depth});
        const double ratio = std::fabs(c.tangential_force) / c.normal_force;
        if (c.mode == Mode::stuck) {
            broke_at = ratio;
            continue;
        }
        // mu relaxes as mu_d + (mu_s - mu_d) exp(-n T / tau_slip), n ticks after break-away.
        const double expected = 0.5 + 0.2 * std::exp(-slipping * 1e-3 / 0.02);
        worst = std::max(worst, std::fabs(ratio - expected));
        CHECK(c.mode == (std::exp(-slipping * 1e-3 / 0.02) > 1e-3 ? Mode::transition : Mode::slip));
        ++slipping;
    }
    CHECK(broke_at <= 0.7 + 1e-12);
    CHECK(broke_at > 0.7 - 2e-5 / depth);
    CHECK(slipping > 150);
    CHECK(worst < 1e-12);
}

TEST_CASE("friction off and friction with mu = 0 are the same renderer", "[friction][law]") {
    const auto outline = stimuli::make_outline({.curvature = 5.0});
    const Scene none(outline, {.slew = kSlew});
    const Scene tiny(outline, {.friction = {.mu_s = 1e-300, .mu_d = 0.0}, .slew = kSlew});
    ContactState a;
    ContactState b;
    for (const Vec2& h : hand(5)) {
        REQUIRE(glm::length(none.tick(a, h).force - tiny.tick(b, h).force) < 1e-10);
    }
}

TEST_CASE("the frame of a stretch splits it the same way in 2-D and 3-D", "[friction][law]") {
    Random random(4);
    for (int i = 0; i < 200; ++i) {
        const double angle = random.in(0.0, 6.28);
        const Vec2 n{std::cos(angle), std::sin(angle)};
        const Vec2 r = random.point(-1.0, 1.0);
        const Stretch<2> flat = stretch<2>(r, n);
        const Stretch<3> solid = stretch<3>(Vec3{r.x, r.y, 0.0}, Vec3{n.x, n.y, 0.0});
        CHECK(flat.load == solid.load);
        CHECK(std::fabs(flat.length - solid.length) < 1e-16);
        CHECK(std::fabs(flat.length - std::fabs(cross(n, r))) < 1e-15);
    }
}
