#include "engine/rendering/energy_ledger.hpp"
#include "engine/rendering/scene.hpp"
#include "stimuli/two_curve.hpp"
#include "tests/support/allocations.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/outlines.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

namespace {

constexpr Friction kBoth{.mu_s = 0.7, .mu_d = 0.5};

Friction friction_of(const LawTraits& law) {
    return law.sticks ? kBoth : Friction{.mu_s = 0.5, .mu_d = 0.5};
}

/// A flat piece of ground, 2 m long and thick.
std::shared_ptr<const Outline> ground() {
    return polyline({{-1.0, 0.0}, {1.0, 0.0}, {1.0, -2.0}, {-1.0, -2.0}}, true);
}

std::vector<Vec2> rough_hand(std::uint64_t seed) {
    return random_hand(seed, 3000, {-0.045, 0.0}, {0.045, 0.046});
}

}  // namespace

TEST_CASE("on a line a scene's friction is the law's own, of HIP's travel and K times the depth") {
    const auto outline = ground();
    for (const LawTraits* const traits : all_laws()) {
        CAPTURE(traits->word);
        const LawSpec spec{.traits = traits, .viscosity = 0.3, .bristle_damping = 0.1, .seed = 4};
        const Scene scene(outline, {.friction = friction_of(*traits), .law = spec});
        const FrictionLaw law(spec, friction_of(*traits), 1000.0, 1e-3);
        const std::vector<Vec2> path = random_hand(11, 3000, {-0.03, -0.006}, {0.03, 0.001});
        ContactState state;
        LawState alone;
        Vec2 last{};
        bool touching = false;
        for (const Vec2& h : path) {
            const Contact c = scene.tick(state, h);
            REQUIRE((c.mode != Mode::free) == (h.y < 0.0));
            if (h.y >= 0.0) {
                touching = false;
                continue;
            }
            if (!touching) {
                alone = {.draws = alone.draws};
            }
            const FrictionForce felt = law.step(alone, {.travel = touching ? h.x - last.x : 0.0,
                                                        .load = -1000.0 * h.y,
                                                        .place = h.x + 1.0});
            touching = true;
            last = h;
            REQUIRE(c.normal_force == Approx(-1000.0 * h.y).margin(1e-11));
            REQUIRE(c.tangential_force == Approx(felt.force).margin(1e-7));
            REQUIRE(c.force.x == Approx(c.tangential_force).margin(1e-12));
            REQUIRE(c.force.y == Approx(c.normal_force).margin(1e-12));
            REQUIRE(c.mu == Approx(felt.mu).epsilon(1e-9));
            REQUIRE((c.mode == Mode::slip) == felt.slid);
        }
    }
}

TEST_CASE("a press straight down on a level ground has no friction, whatever the law") {
    // The travel is 0, for HIP's x is the same to the bit. Before the first travel no law but one
    // of random teeth pulls.
    Random random(7);
    const auto outline = ground();
    for (const LawTraits* const traits : all_laws()) {
        CAPTURE(traits->word);
        const Scene scene(outline,
                          {.friction = friction_of(*traits),
                           .law = {.traits = traits, .viscosity = 0.3, .bristle_damping = 0.1}});
        for (int press = 0; press < 20; ++press) {
            const double x = random.in(-0.9, 0.9);
            const double speed = random.in(1e-3, 0.3);
            CAPTURE(x, speed);
            ContactState state;
            for (double y = 0.001; y > -0.01; y -= speed * 1e-3) {
                const Contact c = scene.tick(state, {x, y});
                REQUIRE(std::fabs(c.tangential_force) <= 1e-9);
            }
        }
    }
}

TEST_CASE("on any object a law adds friction along the tangent to the frictionless force") {
    for (const LawTraits* const traits : all_laws()) {
        for (std::uint64_t seed = 0; seed < 6; ++seed) {
            CAPTURE(traits->word, seed);
            Random random(seed);
            const auto outline = stimuli::make_outline({.curvature = random.in(-12.0, 12.0)});
            const Slew slew = seed % 2 == 0 ? kStudySlew : Slew{};
            const Scene bare(outline, {.slew = slew});
            const Scene rough(outline, {.friction = friction_of(*traits),
                                        .slew = slew,
                                        .law = {.traits = traits, .seed = seed}});
            ContactState a;
            ContactState b;
            for (const Vec2& h : rough_hand(seed)) {
                const Contact smooth = bare.tick(a, h);
                const Contact c = rough.tick(b, h);
                REQUIRE((smooth.mode == Mode::free) == (c.mode == Mode::free));
                REQUIRE(c.go == smooth.go);
                REQUIRE(c.normal_force == smooth.normal_force);
                const Vec2 added = c.force - smooth.force;
                REQUIRE(
                    glm::length(added) ==
                    Approx(std::fabs(c.tangential_force - smooth.tangential_force)).margin(1e-12));
                REQUIRE(std::fabs(glm::dot(added, smooth.force)) <=
                        1e-9 * glm::length(added) * glm::length(smooth.force) + 1e-12);
                if (traits->in_cone) {
                    REQUIRE(std::fabs(c.tangential_force) <=
                            friction_of(*traits).mu_s * c.normal_force + 1e-11);
                }
            }
        }
    }
}

TEST_CASE("no episode with a passive law gives more energy than sampling leaks, whatever hand") {
    std::int64_t episodes = 0;
    for (const LawTraits* const traits : all_laws()) {
        if (!traits->passive) {
            continue;
        }
        CAPTURE(traits->word);
        for (unsigned seed = 0; seed < 70; ++seed) {
            CAPTURE(seed);
            Random random(seed);
            // Where the object is hollow its springs have to leave room: |kappa| d of theirs.
            const double curvature = random.in(-20.0, 20.0);
            const auto outline = stimuli::make_outline({.curvature = curvature});
            const double mu_d = random.in(0.0, 1.0);
            const Scene scene(
                outline,
                {.friction = {.mu_s = traits->sticks ? mu_d * random.in(1.0, 2.0) : mu_d,
                              .mu_d = mu_d},
                 .law = {.traits = traits, .stiffness = curvature < 0.0 ? 500.0 : 1000.0}});
            ContactState state;
            EnergyLedger<2> ledger(1000.0);
            Vec2 hip = random.point(-0.03, 0.03);
            Vec2 speed{};
            for (int i = 0; i < 6000; ++i) {
                speed = 0.97 * speed + random.point(-1.0, 1.0) * 3e-5 - 0.002 * hip;
                hip += speed;
                const Contact c = scene.tick(state, hip);
                ledger.add(hip, c.force, c.mode != Mode::free);
            }
            REQUIRE(ledger.worst() <= 1e-12);
            episodes += ledger.episodes();
        }
    }
    CHECK(episodes > 10'000);
}

TEST_CASE("a law that is not passive says so, and the ledger finds what it gave") {
    // To and fro by 20 um in every tick, 4 mm deep: the force held pushes along each time.
    const auto outline = ground();
    for (const LawTraits* kind :
         {law_named("coulomb_sign"), law_named("viscous"), law_named("stribeck")}) {
        CAPTURE(kind->word);
        CHECK_FALSE(kind->passive);
        const Scene scene(outline, {.friction = friction_of(*kind), .law = {.traits = kind}});
        ContactState state;
        EnergyLedger<2> ledger(1000.0);
        for (int i = 0; i < 1000; ++i) {
            const Vec2 hip{i % 2 == 0 ? 1e-5 : -1e-5, i == 0 ? 0.001 : -0.004};
            ledger.add(hip, scene.tick(state, hip).force, i > 0);
        }
        CHECK(ledger.worst() > 0.9 * 998 * 2e-5 * 2.0 - 0.025);  // mu F_N |dx| a tick
    }
}

TEST_CASE("a law's ticks allocate nothing, give the same bits again, and bear any HIP") {
    const auto outline = stimuli::make_outline({.curvature = -5.0});
    for (const LawTraits* const traits : all_laws()) {
        CAPTURE(traits->word);
        const Scene scene(outline, {.damping = 0.1,
                                    .friction = friction_of(*traits),
                                    .slew = kStudySlew,
                                    .law = {.traits = traits}});
        std::vector<Vec2> path = rough_hand(3);
        Random random(5);
        for (int i = 0; i < 50; ++i) {
            path.push_back(random.point(-1.0, 1.0) * random.decade(-9.0, 6.0));
        }
        ContactState a;
        ContactState b;
        std::size_t made = 0;
        for (const Vec2& h : path) {
            const std::size_t before = allocations();
            const Contact one = scene.tick(a, h);
            made += allocations() - before;
            const Contact other = scene.tick(b, h);
            REQUIRE(one.force == other.force);
            REQUIRE(one.mu == other.mu);
            REQUIRE((std::isfinite(one.force.x) && std::isfinite(one.force.y)));
        }
        CHECK(made == 0);
    }
}
