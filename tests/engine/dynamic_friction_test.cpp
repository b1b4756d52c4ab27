#include "tests/support/law_cases.hpp"
#include "tests/support/runge_kutta.hpp"

using namespace palpate::engine;

namespace {

/// One tick of dz/ds = rate(z) over the travel, in many steps.
double finely(double z, double travel, int steps, const std::function<double(double)>& rate) {
    for (int i = 0; i < steps; ++i) {
        z = tests::runge_kutta(z, std::fabs(travel) / steps,
                               [&](double now, double /*s*/) { return rate(now); });
    }
    return z;
}

}  // namespace

TEST_CASE("Dahl's law is its differential equation, solved finely, for every exponent") {
    SEEDED(random, 30U);
    tests::LawCase c = tests::random_law_case(law_named("dahl"), random);
    c.spec.exponent = seed % 3 == 0 ? 1.0 : random.in(1.0, 3.0);
    tests::move_about(c, random, 200);
    double f = 0.0;
    tests::check_law(
        c,
        [&](const Rub& rub) {
            const double max = c.friction.mu_d * rub.load;
            f = std::min(max, std::max(-max, f));
            const double way = tests::sgn(rub.travel);
            f = finely(f, rub.travel, 400, [&](double now) {
                return way * c.stiffness *
                       std::pow(std::max(1.0 - way * now / max, 0.0), c.spec.exponent);
            });
            return f;
        },
        1e-9);
}

TEST_CASE("below an exponent of 1 Dahl's law saturates after a finite way") {
    // From rest under constant load: f / f_c = 1 - (1 - (1 - alpha) sigma x / f_c)^(1 / (1 -
    // alpha)).
    EACH(alpha, 0.0, 0.3, 0.5, 0.9);
    const FrictionLaw law({.traits = law_named("dahl"), .exponent = alpha},
                          {.mu_s = 0.5, .mu_d = 0.5}, 1000.0, tests::kLawTick);
    LawState state;
    for (int i = 1; i <= 300; ++i) {
        const double f = -law.step(state, {.travel = 1e-4, .load = 4.0}).force;
        const double left = std::max(1.0 - (1.0 - alpha) * 1000.0 * 1e-4 * i / 2.0, 0.0);
        REQUIRE(f == Approx(2.0 * (1.0 - std::pow(left, 1.0 / (1.0 - alpha)))).epsilon(1e-9));
    }
}

TEST_CASE("LuGre's exact step is its differential equation, solved finely") {
    SEEDED(random, 40U);
    tests::LawCase c = tests::random_law_case(law_named("lugre"), random);
    tests::move_about(c, random, 200);
    double z = 0.0;
    tests::check_law(
        c,
        [&](const Rub& rub) {
            const double v = rub.travel / tests::kLawTick;
            const double level = rub.load * (c.friction.mu_d +
                                             (c.friction.mu_s - c.friction.mu_d) *
                                                 std::exp(-std::pow(v / c.spec.stribeck_speed, 2)));
            const double max = c.friction.mu_s * rub.load / c.stiffness;
            z = std::min(max, std::max(-max, z));
            const double before = z;
            const double way = tests::sgn(v);
            const int steps =
                200 + static_cast<int>(200.0 * c.stiffness * std::fabs(rub.travel) / level);
            z = finely(z, rub.travel, steps,
                       [&](double now) { return way - c.stiffness / level * now; });
            return c.stiffness * z + c.spec.bristle_damping * (z - before) / tests::kLawTick +
                   c.spec.viscosity * v;
        },
        1e-9);
}

TEST_CASE(
    "an explicit Euler step of LuGre settles below sigma_0 |v| T / g = 2, and diverges above") {
    EACH(share, 0.5, 0.9, 0.99, 1.01, 1.1, 2.0);
    const LawSpec spec{.traits = law_named("lugre_euler")};
    const FrictionLaw law(spec, {.mu_s = 0.5, .mu_d = 0.5}, 1e4, tests::kLawTick);
    const double limit = euler_limit(1e4, 4.0, 0.5, tests::kLawTick);
    CHECK(limit == Approx(0.4));
    const double travel = share * limit * tests::kLawTick;
    LawState state;
    double error = 0.0;
    const double ratio = 1.0 - 2.0 * share;
    for (int i = 0; i < 200 && std::fabs(error) < 1e9; ++i) {
        const double f = -law.step(state, {.travel = travel, .load = 4.0}).force;
        error = i == 0 ? f - 2.0 : error * ratio;
        REQUIRE(f - 2.0 == Approx(error).epsilon(1e-6).margin(1e-9));
    }
    CHECK((std::fabs(error) > 2.0) == (share > 1.0));
    // Finite in, finite out, for ever.
    for (int i = 0; i < 200'000; ++i) {
        REQUIRE(std::isfinite(law.step(state, {.travel = 0.02, .load = 1e-9}).force));
    }
}

TEST_CASE("Hayward and Armstrong's law is its differential equation, solved finely") {
    SEEDED(random, 20U);
    tests::LawCase c = tests::random_law_case(law_named("hayward_armstrong"), random);
    tests::move_about(c, random, 150);
    double z = 0.0;
    tests::check_law(
        c,
        [&](const Rub& rub) {
            const double max = c.friction.mu_d * rub.load / c.stiffness;
            const double stick = c.spec.stick_share * max;
            z = std::min(max, std::max(-max, z));
            const double way = tests::sgn(rub.travel);
            z = finely(z, rub.travel, 3000, [&](double now) {
                const double slip = std::max(std::fabs(now) - stick, 0.0) / (max - stick);
                return way - tests::sgn(now) * slip;
            });
            return c.stiffness * z;
        },
        1e-8);
}

TEST_CASE("Hayward and Armstrong's law holds for good below its share, and is Dahl's without one") {
    SEEDED(random, 20U);
    const Friction friction{.mu_s = 0.5, .mu_d = 0.5};
    const FrictionLaw holds({.traits = law_named("hayward_armstrong"), .stick_share = 0.7},
                            friction, 1000.0, tests::kLawTick);
    LawState state;
    double x = 0.0;
    for (int i = 0; i < 5000; ++i) {  // |k x| < 0.7 x 2 N
        const double to = random.in(-1.39e-3, 1.39e-3);
        REQUIRE(holds.step(state, {.travel = to - x, .load = 4.0}).force ==
                Approx(-1000.0 * to).margin(1e-9));
        x = to;
    }
    tests::LawCase same = tests::random_law_case(law_named("hayward_armstrong"), random);
    same.spec.stick_share = 0.0;
    tests::move_about(same, random);
    tests::LawCase dahl = same;
    dahl.spec.traits = law_named("dahl");
    const FrictionLaw law = dahl.law();
    LawState other;
    tests::check_law(
        same, [&](const Rub& rub) { return -law.step(other, rub).force; }, 1e-9);
}
