#include "tests/support/catch.hpp"
#include "tests/support/pressed_wall.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

namespace {

/// When a depth that swings by `swing` m at `hz` for 2 s is called a buzz, s; none: it is not.
double found_at(double hz, double swing, double phase, double period, double step) {
    BuzzWatch watch;
    for (int k = 0; k * period < 2.0; ++k) {
        const double now = k * period;
        const double depth =
            0.5 * swing * (1.0 + std::sin(2.0 * std::numbers::pi * hz * now + phase));
        if (buzzes(watch, std::floor(depth / step + 0.5) * step, now)) {
            return now;
        }
    }
    return -1.0;
}

PressedWall light_hand(double stiffness) {
    return {.stiffness = stiffness,
            .handle = 0.05,
            .hand_k = 100.0,
            .hand_b = 0.5,
            .press = 0.006,
            .limits = {.max_force = 10.0, .ramp_step = 0.005, .watch_buzz = true}};
}

}  // namespace

TEST_CASE("a swing that is quick and wide enough buzzes within seven periods, a slower one never",
          "[safety][law]") {
    SEEDED(random, std::uint64_t{200});
    const double phase = random.in(0.0, 6.28);
    const double period = 1e-3 / (1 + random.below(4));
    const double step = random.decade(-7.0, -4.6);
    const double hz = random.in(kBuzzFrequency + 1.0, 60.0);
    const double swing = 2.0 * step + 1.2 * std::fmax(kBuzzSwing, 0.5 * kBuzzSpeed / hz);
    const double at = found_at(hz, swing, phase, period, step);
    CHECK(at > (kBuzzCycles - 1) / hz);
    CHECK(at <= (kBuzzCycles + 2.0) / hz);
    CHECK(found_at(random.in(0.5, kBuzzFrequency - 1.0), random.in(0.0, 0.02), phase, period,
                   step) < 0.0);
    CHECK(found_at(hz, 0.9 * kBuzzSwing - 2.0 * step, phase, period, step) < 0.0);
}

TEST_CASE("tremor and taps of a hand are no buzz", "[safety]") {
    CHECK(found_at(12.0, 0.0003, 0.0, 1e-3, 1e-5) < 0.0);  // the widest tremor
    CHECK(found_at(8.0, 0.010, 0.0, 1e-3, 1e-4) < 0.0);    // the quickest taps
    CHECK(found_at(18.0, 0.0035, 0.0, 1e-3, 1e-4) > 0.0);  // 0.14 m/s rms: seen on a bench
}

TEST_CASE("a stiff wall under a light hand on a light handle is ended within half a second",
          "[safety][law]") {
    SEEDED(random, std::uint64_t{40});
    PressedWall wall = light_hand(1000.0);
    if (seed > 0) {  // the bench's own case, and what is near it
        wall.handle = random.in(0.035, 0.055);
        wall.hand_k = random.in(90.0, 150.0);
        wall.hand_b = random.in(0.2, 0.6);
        wall.press = random.in(0.005, 0.008);
    }
    const auto course = wall.run(3.0);
    CHECK((course.trip == Trip::buzz));
    CHECK(course.tripped_s - course.touched_s <= 0.5);
    CHECK(course.command == 0.0);
}

TEST_CASE("a press at 200 N/m never buzzes, however the handle is held", "[safety][law]") {
    SEEDED(random, std::uint64_t{60});
    PressedWall wall = light_hand(200.0);
    if (seed > 0) {
        wall.handle = random.in(0.05, 0.3);
        wall.hand_k = random.in(50.0, 500.0);
        wall.hand_b = random.in(0.5, 8.0);
        wall.press = random.in(0.001, 0.015);
        wall.approach = random.in(0.02, 0.4);
        wall.tap_hz = random.in(0.0, 12.0);
        wall.tap = wall.tap_hz < 8.0 ? random.in(0.0, 0.004) : random.in(0.0, 0.00015);
    }
    CHECK((wall.run(3.0).trip == Trip::none));
}

TEST_CASE("a wall that is damped enough rings when it is struck, and is let be", "[safety][law]") {
    SEEDED(random, std::uint64_t{60});
    PressedWall wall = light_hand(1000.0);
    wall.handle = random.in(0.05, 0.3);
    wall.hand_b = random.in(2.5, 8.0);  // K T (1/2 + d) is 1.5 N s/m
    wall.hand_k = random.in(50.0, 500.0);
    wall.approach = random.in(0.02, 0.4);
    CHECK((wall.run(3.0).trip == Trip::none));
}
