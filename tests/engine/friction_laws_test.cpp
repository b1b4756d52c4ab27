#include "tests/support/law_cases.hpp"

using namespace palpate::engine;

namespace {

/// A spring between HIP and an anchor that lives in absolute places.
struct Anchored {
    double x = 0.0;
    double anchor = 0.0;
    bool sliding = false;
    double way = 0.0;
    double force = 0.0;
};

}  // namespace

TEST_CASE("the maps of velocity are their formulas") {
    SEEDED(random, 40U);
    for (const LawTraits* kind :
         {law_named("coulomb_sign"), law_named("viscous"), law_named("stribeck")}) {
        tests::LawCase c = tests::random_law_case(kind, random);
        tests::move_about(c, random);
        tests::check_law(
            c,
            [&](const Rub& rub) {
                const double v = rub.travel / tests::kLawTick;
                const double mu =
                    c.friction.mu_d + (c.friction.mu_s - c.friction.mu_d) *
                                          std::exp(-std::pow(v / c.spec.stribeck_speed, 2.0));
                if (kind->sticks) {
                    return std::tanh(v / c.spec.smoothing_speed) * mu * rub.load;
                }
                return c.friction.mu_d * rub.load * tests::sgn(v) +
                       (kind->needs_first ? c.spec.viscosity * v : 0.0);
            },
            1e-12);
    }
}

TEST_CASE("stiction and Karnopp's law are a spring from where HIP stuck, and Coulomb's law else") {
    SEEDED(random, 40U);
    for (const LawTraits* kind : {law_named("stiction"), law_named("karnopp")}) {
        tests::LawCase c = tests::random_law_case(kind, random);
        tests::move_about(c, random);
        Anchored s;
        tests::check_law(
            c,
            [&](const Rub& rub) {
                const double slow = kind == law_named("karnopp") ? c.spec.stick_speed : 0.0;
                const bool rests = std::fabs(rub.travel) < slow * tests::kLawTick ||
                                   tests::sgn(rub.travel) != s.way;
                if (s.sliding && rests) {  // the force is kept
                    s.sliding = false;
                    s.anchor = s.x - s.force / c.stiffness;
                }
                s.x += rub.travel;
                const double pull = c.stiffness * (s.x - s.anchor);
                if (s.sliding) {
                    s.way = tests::sgn(rub.travel);
                } else if (std::fabs(pull) > c.friction.mu_s * rub.load) {
                    s.sliding = true;
                    s.way = tests::sgn(pull);
                }
                s.force = s.sliding ? c.friction.mu_d * rub.load * s.way : pull;
                return s.force;
            },
            1e-9);
    }
}

TEST_CASE("coming to rest keeps the force, to within the travel of the tick") {
    for (const LawTraits* kind : {law_named("stiction"), law_named("karnopp")}) {
        const FrictionLaw law({.traits = kind}, {.mu_s = 0.7, .mu_d = 0.5}, 1000.0,
                              tests::kLawTick);
        LawState state;
        for (int i = 0; i < 100; ++i) {
            static_cast<void>(law.step(state, {.travel = 1e-4, .load = 4.0}));
        }
        const FrictionForce slides = law.step(state, {.travel = 1e-4, .load = 4.0});
        CHECK(slides.slid);
        CHECK(slides.force == Approx(-2.0));
        const FrictionForce rests = law.step(state, {.travel = 0.0, .load = 4.0});
        CHECK_FALSE(rests.slid);
        CHECK(rests.force == Approx(-2.0).epsilon(1e-12));
    }
}

TEST_CASE("the reset integrator and the friction cone are anchors that HIP drags along") {
    SEEDED(random, 40U);
    for (const LawTraits* kind : {law_named("reset_integrator"), law_named("friction_cone")}) {
        tests::LawCase c = tests::random_law_case(kind, random);
        c.spec.bristle_damping = 0.0;
        tests::move_about(c, random);
        Anchored s;
        tests::check_law(
            c,
            [&](const Rub& rub) {
                s.x += rub.travel;
                const double fixed = c.friction.mu_s * rub.load / c.stiffness;
                const double slides = c.friction.mu_d * rub.load / c.stiffness;
                const double gap = s.x - s.anchor;
                if (kind == law_named("reset_integrator")) {
                    s.anchor = std::min(s.x + fixed, std::max(s.x - fixed, s.anchor));
                    return std::fabs(gap) >= fixed ? c.friction.mu_d * rub.load * tests::sgn(gap)
                                                   : c.stiffness * gap;
                }
                s.sliding = std::fabs(gap) > (s.sliding ? slides * (1.0 - 1e-12) : fixed);
                s.anchor = s.sliding ? s.x - tests::sgn(gap) * slides : s.anchor;
                return c.stiffness * (s.x - s.anchor);
            },
            1e-9);
    }
}

TEST_CASE("one bristle is a saw of random teeth, and many pull by mu_d in the mean") {
    const double load = 4.0;
    const Friction friction{.mu_s = 0.7, .mu_d = 0.5};
    const double reach = 0.7 * load / 1000.0;
    const FrictionLaw one({.traits = law_named("bristle"), .bristles = 1, .seed = 5}, friction,
                          1000.0, tests::kLawTick);
    LawState state;
    double snap = reach;  // the place at which the bond snaps
    double formed = 0.0;  // the place at which it has no stretch
    std::uint64_t draws = 0;
    for (int i = 1; i < 3000; ++i) {
        const double x = 37e-6 * i;
        while (x > snap) {
            const double lowest = 3.0 * 0.5 / 0.7 - 2.0;
            const double begun = lowest + (1.0 - lowest) * uniform(5, draws++);
            formed = snap - begun * reach;
            snap = formed + reach;
        }
        REQUIRE(-one.step(state, {.travel = 37e-6, .load = load}).force ==
                Approx(1000.0 * (x - formed)).epsilon(1e-9));
    }
    const FrictionLaw many({.traits = law_named("bristle"), .bristles = 64, .seed = 9}, friction,
                           1000.0, tests::kLawTick);
    LawState crowd;
    double sum = 0.0;
    double first = 0.0;
    constexpr int kTicks = 40'000;
    for (int i = 0; i < kTicks; ++i) {
        const double f = -many.step(crowd, {.travel = 2e-5, .load = load}).force;
        REQUIRE(f <= 0.7 * load * (1.0 + 1e-12));
        first = std::max(first, f);
        sum += i < kTicks / 2 ? 0.0 : f;
    }
    CHECK(first == Approx(0.7 * load).epsilon(0.01));  // all break away together
    CHECK(sum / (kTicks / 2) == Approx(0.5 * load).epsilon(0.01));
}

TEST_CASE("snags lie where they lie, and one in every length of their spacing holds") {
    const LawSpec spec{.traits = law_named("snags"), .snag_spacing = 0.005, .seed = 3};
    const FrictionLaw law(spec, {.mu_s = 0.7, .mu_d = 0.5}, 1000.0, tests::kLawTick);
    const double reach = 0.7 * 2.0 / 1000.0;  // of mu_s F_N
    LawState state;
    int caught = 0;
    bool stuck = false;
    for (int i = 0; i <= 10'000; ++i) {
        const double x = 0.0001 + 5e-6 * i;
        const FrictionForce felt =
            law.step(state, {.travel = i == 0 ? 0.0 : 5e-6, .load = 2.0, .place = x});
        // Of the snags at or before x the last one that nothing before it still held.
        double centre = -1.0;
        for (int cell = 0; cell <= static_cast<int>(x / 0.005); ++cell) {
            const double at = 0.005 * (cell + uniform(3, static_cast<std::uint64_t>(cell)));
            if (at > 0.0001 && at <= x && (centre < 0.0 || at > centre + reach)) {
                centre = at;
            }
        }
        const bool held = centre > 0.0 && x - centre <= reach * (1.0 - 1e-9);
        if (std::fabs(x - centre - reach) > 1e-5) {  // at the very edge either side is right
            REQUIRE(felt.slid == !(held || i == 0));
            REQUIRE(-felt.force == Approx(held     ? 1000.0 * (x - centre)
                                          : i == 0 ? 0.0
                                                   : 1.0)
                                       .margin(1e-9));
        }
        caught += held && !stuck ? 1 : 0;
        stuck = held;
    }
    CHECK(caught >= 8);  // of ten; two that lie close hold as one
}

TEST_CASE("whatever hand and load, a law is in its cone, and finite numbers give finite ones") {
    for (const LawTraits* const traits : all_laws()) {
        CAPTURE(traits->word);
        CHECK(law_named(traits->word) == traits);
        for (unsigned seed = 0; seed < 40; ++seed) {
            CAPTURE(seed);
            Random random(seed);
            tests::LawCase c = tests::random_law_case(traits, random);
            if (traits->in_cone) {  // dampers leave it
                c.spec.viscosity = 0.0;
                c.spec.bristle_damping = 0.0;
            }
            tests::move_about(c, random, 200);
            for (int i = 0; i < 20; ++i) {
                c.rubs.push_back({.travel = random.in(-1.0, 1.0) * random.decade(-12.0, 3.0),
                                  .load = random.coin() ? 0.0 : random.decade(-300.0, 9.0),
                                  .place = random.in(-1.0, 1.0)});
            }
            const FrictionLaw law = c.law();
            LawState state;
            for (const Rub& rub : c.rubs) {
                const FrictionForce felt = law.step(state, rub);
                REQUIRE(std::isfinite(felt.force));
                REQUIRE(std::isfinite(felt.mu));
                if (traits->in_cone) {
                    REQUIRE(std::fabs(felt.force) <=
                            c.friction.mu_s * rub.load * (1.0 + 1e-12) + 1e-300);
                }
            }
        }
    }
}

TEST_CASE("the smallest numbers above 0 are felt as well: every tick ends, and is finite") {
    const auto tiny = GENERATE(1e-17, 1e-300, 4.9406564584124654e-324);
    for (const LawTraits* const traits : all_laws()) {
        CAPTURE(traits->word, tiny);
        const FrictionLaw law({.traits = traits,
                               .stiffness = tiny,
                               .stribeck_speed = tiny,
                               .smoothing_speed = tiny,
                               .stick_speed = tiny,
                               .snag_spacing = tiny},
                              {.mu_s = 0.7, .mu_d = 0.5}, 1000.0, tests::kLawTick);
        LawState state;
        for (int i = 0; i < 20; ++i) {
            const double travel = i % 7 == 6 ? -0.001 : 0.001;
            const FrictionForce felt =
                law.step(state, {.travel = travel, .load = 2.0, .place = 0.1 + 0.001 * i});
            REQUIRE(std::isfinite(felt.force));
            REQUIRE(std::fabs(felt.force) <= 0.7 * 2.0 * (1.0 + 1e-12));
        }
    }
}

TEST_CASE("a law with a number out of its range is refused with the value and a remedy") {
    const Friction friction{.mu_s = 0.7, .mu_d = 0.5};
    const auto made = [&](const LawSpec& spec) {
        return FrictionLaw(spec, friction, 1e3, tests::kLawTick);
    };
    CHECK_THROWS_WITH(made({.traits = law_named("dahl"), .exponent = 4.0}),
                      Has("exponent is 4", "give 0 to 3"));
    CHECK_THROWS_WITH(made({.traits = law_named("bristle"), .bristles = 65}),
                      Has("bristles is 65"));
    CHECK_THROWS_WITH(made({.traits = law_named("lugre"), .stribeck_speed = 0.0}),
                      Has("Stribeck speed is 0"));
    CHECK_THROWS_WITH(FrictionLaw({.traits = law_named("bristle")}, {.mu_s = 1.0, .mu_d = 0.2}, 1e3,
                                  tests::kLawTick),
                      Has("mu_d is 0.2"));
}
