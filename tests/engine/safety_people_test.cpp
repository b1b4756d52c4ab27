#include "engine/safety/safety_chain.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

TEST_CASE("a screen without a sign of life for longer than allowed switches off, not before",
          "[safety][law]") {
    SEEDED(random, std::uint64_t{40});
    const SafetyLimits limits{.ramp_step = 1.0, .screen_silence = random.in(0.05, 1.0)};
    SafetyState state;
    for (int k = 0; k < 50; ++k) {
        const double age = limits.screen_silence * random.in(0.0, 1.0);
        const Command c = make_safe(state, limits, {.force = {1.0, 0.0, 0.0}, .screen_age = age});
        REQUIRE((c.trip == Trip::none));
        REQUIRE(c.force.x == 1.0);
    }
    // The ramp out asks nobody.
    CHECK((make_safe(state, limits, {.screen_age = 2.0, .enable = false}).trip == Trip::none));
    const Command c = make_safe(
        state, limits, {.force = {1.0, 0.0, 0.0}, .screen_age = 1.001 * limits.screen_silence});
    CHECK((c.trip == Trip::screen_silent));
    CHECK(c.force == Vec3{});
}

TEST_CASE("the force ends with its time by the servo's own count, and a ramp out may end after it",
          "[safety][law]") {
    SEEDED(random, std::uint64_t{20});
    const double period = random.coin() ? 1e-3 : 2.5e-4;
    const int ticks = 20 + random.below(400);
    const SafetyLimits limits{
        .period = period, .ramp_step = 1.0, .time_limit = (ticks - 0.5) * period};
    SafetyState state;
    for (int k = 0; k < ticks; ++k) {  // tick k comes at k periods
        REQUIRE((make_safe(state, limits, {.force = {1.0, 0.0, 0.0}}).trip == Trip::none));
    }
    CHECK((make_safe(state, limits, {.enable = false}).trip == Trip::none));
    const Command c = make_safe(state, limits, {.force = {1.0, 0.0, 0.0}});
    CHECK((c.trip == Trip::time_limit));
    CHECK(c.force == Vec3{});
}

TEST_CASE("every trip says what happened and what to do", "[safety]") {
    for (int i = 1; i <= static_cast<int>(Trip::stopped); ++i) {
        const auto trip = static_cast<Trip>(i);
        CAPTURE(to_string(trip));
        CHECK((to_string(trip) != "none"));
        const std::string_view text = explanation(trip);
        const std::size_t colon = text.find(": ");
        CHECK(colon != std::string_view::npos);
        CHECK(text.size() > colon + 12);
        CHECK(text.back() != '.');
    }
}
