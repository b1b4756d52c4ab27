#include <cmath>
#include <limits>

#include "engine/safety/force_chain.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;
using palpate::tests::Random;

TEST_CASE("no command is stronger than the limit, and its direction is kept", "[safety][law]") {
    const auto seed = GENERATE(range(std::uint64_t{0}, std::uint64_t{100}));
    CAPTURE(seed);
    Random random(seed);
    const ForceLimits limits{.most = random.in(0.5, 10.0), .ramp_step = 1.0};
    ForceGate gate;
    for (int i = 0; i < 200; ++i) {
        const double size = random.decade(-3.0, 4.0);
        const Vec2 force = random.point(-size, size);
        const Command c = guard(gate, limits, force, true);
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
    const ForceLimits limits{.most = 10.0, .ramp_step = ramp_step(0.2, 1e-3)};
    ForceGate gate;
    const Vec2 force{3.0, -4.0};
    double last = 0.0;
    for (int k = 1; k <= 250; ++k) {
        const Command c = guard(gate, limits, force, true);
        CHECK(std::fabs(glm::length(c.force) - 5.0 * std::min(1.0, k / 200.0)) < 1e-9);
        CHECK(c.ramped == (k < 200));
        CHECK(glm::length(c.force) - last <= 5.0 / 200.0 + 1e-12);
        last = glm::length(c.force);
    }
    for (int k = 1; k <= 200; ++k) {
        static_cast<void>(guard(gate, limits, force, false));
    }
    CHECK(glm::length(guard(gate, limits, force, false).force) < 1e-12);
}

TEST_CASE("a force that is not finite latches: zero from then on", "[safety][law]") {
    const double bad =
        GENERATE(std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                 -std::numeric_limits<double>::infinity());
    ForceGate gate;
    const ForceLimits limits{.ramp_step = 1.0};
    CHECK(guard(gate, limits, {1.0, 0.0}, true).force.x == 1.0);
    const Command c = guard(gate, limits, {0.0, bad}, true);
    CHECK(c.refused);
    CHECK(c.force == Vec2{});
    const Command later = guard(gate, limits, {1.0, 0.0}, true);
    CHECK(later.refused);
    CHECK(later.force == Vec2{});
}
