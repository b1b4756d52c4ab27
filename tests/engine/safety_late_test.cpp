#include "engine/safety/safety_chain.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

namespace {

constexpr std::int64_t kTick = 1'000'000;  // ns

Trip late_by(SafetyState& state, const SafetyLimits& limits, double ticks) {
    const auto ns = static_cast<std::int64_t>(ticks * kTick);
    return make_safe(state, limits, {.lateness_ns = ns}).trip;
}

/// Ticks that follow a stall of `periods`, as a servo on absolute deadlines makes them.
Trip stall(SafetyState& state, const SafetyLimits& limits, int periods) {
    Trip trip = Trip::none;
    for (int left = periods; left > 0; --left) {
        trip = late_by(state, limits, left);
    }
    return trip;
}

}  // namespace

TEST_CASE("late ticks in a row trip at the number allowed, not before", "[safety][law]") {
    const std::int32_t run = GENERATE(1, 2, 20);
    const double lateness = GENERATE(0.51, 1.0, 1.4);
    CAPTURE(run, lateness);
    const SafetyLimits limits{.ramp_step = 1.0, .late_run = run};
    SafetyState state;
    for (int round = 0; round < 10; ++round) {
        for (int k = 1; k < run; ++k) {
            REQUIRE((late_by(state, limits, lateness) == Trip::none));
        }
        REQUIRE((late_by(state, limits, 0.5) == Trip::none));  // half a period is on time
        REQUIRE((late_by(state, limits, 0.0) == Trip::none));
    }
    for (int k = 1; k < run; ++k) {
        REQUIRE((late_by(state, limits, lateness) == Trip::none));
    }
    CHECK((late_by(state, limits, lateness) == Trip::late));
}

TEST_CASE("a tick that is late by k periods counts as k, and catching up counts as nothing more",
          "[safety][law]") {
    const SafetyLimits limits{.ramp_step = 1.0, .late_run = 20};
    for (int periods = 1; periods < 40; ++periods) {
        CAPTURE(periods);
        SafetyState state;
        CHECK((late_by(state, limits, 0.0) == Trip::none));
        CHECK((late_by(state, limits, periods) == (periods < 20 ? Trip::none : Trip::late)));
    }
    for (int periods = 1; periods < 40; ++periods) {
        CAPTURE(periods);
        SafetyState state;
        CHECK((late_by(state, limits, 0.0) == Trip::none));
        CHECK((stall(state, limits, periods) == (periods < 20 ? Trip::none : Trip::late)));
    }
}

TEST_CASE("late ticks among the last hundred trip at the share allowed, not before",
          "[safety][law]") {
    SEEDED(random, std::uint64_t{60});
    const SafetyLimits limits{.ramp_step = 1.0, .late_share = 1 + random.below(60)};
    const double rate = random.in(0.0, 1.0);
    SafetyState state;
    std::vector<int> history;  // by hand: 1 for each late tick
    for (int k = 0; k < 1000; ++k) {
        const bool late = random.in(0.0, 1.0) < rate * 0.6;
        history.push_back(late ? 1 : 0);
        int share = 0;
        for (std::size_t i = history.size() < 100 ? 0 : history.size() - 100; i < history.size();
             ++i) {
            share += history[i];
        }
        const Trip trip = late_by(state, limits, late ? 0.9 : 0.1);
        REQUIRE((trip == (share >= limits.late_share ? Trip::late : Trip::none)));
        if (trip != Trip::none) {
            break;
        }
    }
}

TEST_CASE("a wake-up of any lateness is some periods between none and the window", "[safety]") {
    CHECK(periods_late(0, 1e-3) == 0);
    CHECK(periods_late(500'000, 1e-3) == 0);
    CHECK(periods_late(510'000, 1e-3) == 1);
    CHECK(periods_late(1'499'000, 1e-3) == 1);
    CHECK(periods_late(1'501'000, 1e-3) == 2);
    CHECK(periods_late(1'501'000, 1e-4) == 15);
    CHECK(periods_late(INT64_MAX, 1e-4) == LateTicks::kWindow);
    CHECK(periods_late(INT64_MIN, 1e-4) == 0);
}

TEST_CASE("readings that became older than the stiffness allows trip when the mean says so",
          "[safety][law]") {
    SEEDED(random, std::uint64_t{60});
    const double period = random.coin() ? 1e-3 : 2.5e-4;
    const double behind = 1.0 + random.below(5);
    const double spare = behind * random.in(0.05, 1.2);
    const SafetyLimits limits{.period = period, .ramp_step = 1.0, .spare_delay = spare};
    SafetyState state;
    for (int k = 0; k < 300; ++k) {
        REQUIRE((make_safe(state, limits, {.force = {1.0, 0.0, 0.0}}).trip == Trip::none));
    }
    // behind (1 - (1 - T / window)^n) > spare, for n ticks in a row
    const double n = std::log(1.0 - std::fmin(spare / behind, 1.0)) / std::log1p(-period / 0.25);
    const int all = spare < behind ? static_cast<int>(std::floor(n)) : 20000;
    for (int k = 0; k < all; ++k) {
        const Command c = make_safe(state, limits, {.force = {1.0, 0.0, 0.0}, .behind = behind});
        REQUIRE((c.trip == Trip::none));
    }
    if (spare < behind) {
        static_cast<void>(make_safe(state, limits, {.force = {1.0, 0.0, 0.0}, .behind = behind}));
        const Command c = make_safe(state, limits, {.force = {1.0, 0.0, 0.0}, .behind = behind});
        CHECK((c.trip == Trip::delayed));
        CHECK(c.force == Vec3{});
    }
}

TEST_CASE("answers that a busy machine keeps back now and then are no delay", "[safety][law]") {
    SEEDED(random, std::uint64_t{20});
    const SafetyLimits limits{.ramp_step = 1.0, .spare_delay = 0.5};
    SafetyState state;
    for (int round = 0; round < 40; ++round) {
        const int kept = 1 + random.below(9);  // ticks, 10 of them are silence
        for (int k = 1; k <= kept; ++k) {
            REQUIRE((make_safe(state, limits, {.behind = 1.0 * k}).trip == Trip::none));
        }
        for (int k = 0; k < 130; ++k) {
            REQUIRE((make_safe(state, limits, {}).trip == Trip::none));
        }
    }
}
