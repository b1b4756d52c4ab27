#include "engine/safety/safety_chain.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

TEST_CASE("motors trip when the first-order model says so", "[safety][law]") {
    // theta(t) = load^2 (1 - exp(-t / tau)) reaches 1 at t = -tau ln(1 - 1 / load^2).
    const double load = GENERATE(1.05, 1.2, 2.0, 5.0);
    const double step = GENERATE(1e-4, 1e-3, 1e-2);
    const int motor = GENERATE(0, 1);
    CAPTURE(load, step, motor);
    const SafetyLimits limits{.ramp_step = 1.0, .heat_step = step};
    const Vec3 loads = motor == 0 ? Vec3{load, 0.0, 0.0} : Vec3{0.0, load, 0.0};
    const double expected = -std::log(1.0 - 1.0 / (load * load)) / step;
    SafetyState state;
    int ticks = 1;
    while (make_safe(state, limits, {.load = loads}).trip == Trip::none && ticks < 1'000'000) {
        ++ticks;
    }
    CHECK((state.trip == Trip::overheated));
    CHECK(std::fabs(ticks - expected) <= 1.0 + 1e-3 * expected);
}

TEST_CASE("a load that the motors can bear for ever never trips", "[safety][law]") {
    SEEDED(random, std::uint64_t{50});
    const SafetyLimits limits{.ramp_step = 1.0, .heat_step = random.decade(-4.0, 3.0)};
    SafetyState state;
    for (int k = 0; k < 20000; ++k) {
        const Vec2 load = random.below(3) == 0 ? random.point(0.0, 1.0) : Vec2{1.0, 1.0};
        REQUIRE((make_safe(state, limits, {.load = Vec3(load, 0.0)}).trip == Trip::none));
        REQUIRE(state.heat.x <= 1.0);
    }
}

TEST_CASE("the heat model is the exponential to third order, and stable for any step", "[safety]") {
    for (double step = 1e-6; step < 1e6; step *= 2.0) {
        CAPTURE(step);
        const Vec3 heat = heated({0.8, 0.0, 0.0}, {0.0, 1.0, 0.0}, step);
        CHECK(heat.x >= 0.0);
        CHECK(heat.y <= 1.0);
        CHECK(std::fabs(heat.x - 0.8 * std::exp(-step)) <= step * step * step / 6.0 + 1e-15);
    }
}

TEST_CASE("motors stay warm from trial to trial and cool in between", "[safety][law]") {
    const SafetyLimits limits{.ramp_step = 1.0, .heat_step = 1e-3};  // tau = 1 s
    SafetyState state;
    while (make_safe(state, limits, {.load = {2.0, 0.0, 0.0}}).trip == Trip::none) {
    }
    const double hot = state.heat.x;
    CHECK((fresh_state(state, limits, 0.0).trip == Trip::none));
    CHECK(fresh_state(state, limits, 0.0).heat.x == hot);
    // It cools at least as slowly as exp(-1).
    CHECK(fresh_state(state, limits, 1.0).heat.x >= hot * std::exp(-1.0));
    CHECK(fresh_state(state, limits, 1.0).heat.x <= 0.41 * hot);
    CHECK(fresh_state(state, limits, INFINITY).heat.x == 0.0);
    CHECK(fresh_state(state, {}, INFINITY).heat.x == 0.0);
}
