#include "engine/safety/safety_chain.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

namespace {

double rounded_to(double value, double step) {
    return std::floor(value / step + 0.5) * step;
}

/// First tick that trips a hand of `speed` m/s, read in steps of `count` m; -1: none in `ticks`.
int trips_at(const SafetyLimits& limits, double speed, double angle, double count, int ticks) {
    SafetyState state;
    for (int k = 0; k < ticks; ++k) {
        const double way = speed * k * limits.period;
        const Vec2 hip{rounded_to(way * std::cos(angle), count),
                       rounded_to(way * std::sin(angle), count)};
        const Command c = make_safe(state, limits, {.hip = Vec3(hip, 0.0)});
        if (c.trip != Trip::none) {
            return c.trip == Trip::over_speed ? k : -2;
        }
    }
    return -1;
}

}  // namespace

TEST_CASE("a hand above the speed limit trips within the window, and one below it never",
          "[safety][law]") {
    SEEDED(random, std::uint64_t{100});
    const SafetyLimits limits{
        .period = 1e-3 / (1 + random.below(10)), .ramp_step = 1.0, .speed = random.in(0.3, 2.0)};
    const double count = random.in(1e-6, 1e-4);
    const double angle = random.in(0.0, 2.0 * std::numbers::pi);
    const int window = static_cast<int>(window_ticks(limits.period));
    // One count of either end, in both axes, over 20 ms.
    const double slack = std::numbers::sqrt2 * count / kSpeedWindow;
    CHECK(trips_at(limits, limits.speed - slack - 1e-9, angle, count, 2000) == -1);
    const int at = trips_at(limits, (limits.speed + slack) * 1.001, angle, count, 2000);
    CHECK(at >= 0);
    CHECK(at <= window);
}

TEST_CASE("a count of 0.1 mm a tick trips no speed limit of 0.05 m/s", "[safety]") {
    const SafetyLimits limits{.ramp_step = 1.0, .speed = 0.05, .jump = 0.01};
    SafetyState state;
    for (int k = 0; k < 500; ++k) {  // dithers by a count: 0.1 m/s from tick to tick
        REQUIRE((make_safe(state, limits, {.hip = {1e-4 * (k % 2), 0.0, 0.0}}).trip == Trip::none));
    }
}

TEST_CASE("a jump between two fresh readings trips at once", "[safety][law]") {
    SEEDED(random, std::uint64_t{100});
    const SafetyLimits limits{.ramp_step = 1.0, .jump = random.in(0.001, 0.02)};
    SafetyState state;
    Vec2 hip = random.point(-0.05, 0.05);
    const auto moved_by = [&](double length) {
        const double angle = random.in(0.0, 2.0 * std::numbers::pi);
        hip += length * Vec2{std::cos(angle), std::sin(angle)};
    };
    for (int k = 0; k < 50; ++k) {
        moved_by(limits.jump * random.in(0.0, 0.999));
        REQUIRE((make_safe(state, limits, {.force = {1.0, 0.0, 0.0}, .hip = Vec3(hip, 0.0)}).trip ==
                 Trip::none));
    }
    moved_by(limits.jump * random.in(1.001, 3.0));
    const Command c = make_safe(state, limits, {.force = {1.0, 0.0, 0.0}, .hip = Vec3(hip, 0.0)});
    CHECK((c.trip == Trip::jump));
    CHECK(c.force == Vec3{});
}

TEST_CASE("old readings and late ticks give the hand the time it really had", "[safety][law]") {
    SEEDED(random, std::uint64_t{200});
    const SafetyLimits limits{.ramp_step = 1.0, .speed = 1.0, .jump = 0.0015};
    const double speed = 0.95;  // below both limits at any moment
    SafetyState state;
    Vec2 hip{};
    double stall = 0.0;  // s still to be caught up
    for (int k = 0; k < 3000; ++k) {
        const double more = random.below(100) == 0 ? random.in(0.0, 0.008) : 0.0;
        stall = std::fmax(more, stall - 1e-3);  // time never runs back
        const double now = k * 1e-3 + stall;
        const bool fresh = k == 0 || random.below(4) != 0;
        if (fresh) {
            hip = {speed * now, 0.0};
        }
        const auto time_ns = static_cast<std::int64_t>(now * 1e9);
        REQUIRE(
            (make_safe(state, limits, {.hip = Vec3(hip, 0.0), .fresh = fresh, .time_ns = time_ns})
                 .trip == Trip::none));
    }
}

TEST_CASE("a trial that begins with an old reading takes its way from the first fresh one",
          "[safety][law]") {
    SEEDED(random, std::uint64_t{100});
    const SafetyLimits limits{.ramp_step = 1.0, .speed = 1.0, .jump = 0.01};
    SafetyState state;
    const Vec2 before = random.point(-0.05, 0.05);  // where the hand was read before the rest
    Vec2 hip = random.point(-0.05, 0.05);
    const int old_ones = 1 + random.below(8);
    for (int k = 0; k < old_ones; ++k) {
        REQUIRE((make_safe(state, limits, {.hip = Vec3(before, 0.0), .fresh = false}).trip ==
                 Trip::none));
    }
    for (int k = 0; k < 50; ++k) {
        hip += Vec2{9e-4, 0.0};
        REQUIRE((make_safe(state, limits, {.hip = Vec3(hip, 0.0)}).trip == Trip::none));
    }
    hip += Vec2{0.011, 0.0};
    CHECK((make_safe(state, limits, {.hip = Vec3(hip, 0.0)}).trip == Trip::jump));
}
