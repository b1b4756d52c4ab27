#include <cmath>
#include <limits>

#include "engine/safety/safety_chain.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;
using palpate::tests::Random;

TEST_CASE("no command is stronger than the limit, and its direction is kept", "[safety][law]") {
    const auto seed = GENERATE(range(std::uint64_t{0}, std::uint64_t{100}));
    CAPTURE(seed);
    Random random(seed);
    const SafetyLimits limits{.most = random.in(0.5, 10.0), .ramp_step = 1.0};
    SafetyState gate;
    for (int i = 0; i < 200; ++i) {
        const double size = random.decade(-3.0, 4.0);
        const Vec2 force = random.point(-size, size);
        const Command c = make_safe(gate, limits, {.force = force, .enable = true});
        REQUIRE(glm::length(c.force) <= limits.most * (1.0 + 1e-15));
        REQUIRE(std::fabs(cross(c.force, force)) <= 1e-12 * glm::length(force) * limits.most);
        REQUIRE(glm::dot(c.force, force) >= 0.0);
        REQUIRE(c.saturated == (glm::length(force) > limits.most));
        if (!c.saturated) {
            REQUIRE(c.force == force);
        }
    }
}

TEST_CASE("the ramp takes as long as asked, on and off, and never jumps", "[safety][law]") {
    const SafetyLimits limits{.most = 10.0, .ramp_step = ramp_step(0.2, 1e-3)};
    SafetyState gate;
    const Vec2 force{3.0, -4.0};
    double last = 0.0;
    for (int k = 1; k <= 250; ++k) {
        const Command c = make_safe(gate, limits, {.force = force, .enable = true});
        CHECK(std::fabs(glm::length(c.force) - 5.0 * std::min(1.0, k / 200.0)) < 1e-9);
        CHECK(c.ramped == (k < 200));
        CHECK(glm::length(c.force) - last <= 5.0 / 200.0 + 1e-12);
        last = glm::length(c.force);
    }
    for (int k = 1; k <= 200; ++k) {
        static_cast<void>(make_safe(gate, limits, {.force = force, .enable = false}));
    }
    CHECK(glm::length(make_safe(gate, limits, {.force = force, .enable = false}).force) < 1e-12);
}

TEST_CASE("a force that is not finite latches: zero from then on", "[safety][law]") {
    const double bad =
        GENERATE(std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                 -std::numeric_limits<double>::infinity());
    SafetyState gate;
    const SafetyLimits limits{.ramp_step = 1.0};
    CHECK(make_safe(gate, limits, {.force = {1.0, 0.0}, .enable = true}).force.x == 1.0);
    const Command c = make_safe(gate, limits, {.force = {0.0, bad}, .enable = true});
    CHECK((c.trip == Trip::not_finite));
    CHECK(c.force == Vec2{});
    const Command later = make_safe(gate, limits, {.force = {1.0, 0.0}, .enable = true});
    CHECK((later.trip == Trip::not_finite));
    CHECK(later.force == Vec2{});
}
