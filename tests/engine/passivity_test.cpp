#include "engine/safety/passivity.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/counted_wall.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

// The table of the virtual wall's stability: m = 0.15 kg, T = 1 ms; roots of the exact
// zero-order-hold polynomial, and the growth of a stepped wall beside them.
TEST_CASE("the sampled wall starts to swing at the stiffness of its exact polynomial") {
    struct Row {
        double damping, virtual_damping;
        int delay;
        double limit;
    };
    const Row rows[] = {{0.1, 0.0, 0, 200.02}, {0.5, 0.0, 0, 1000.556}, {0.5, 0.25, 0, 1498.3},
                        {0.5, 1.0, 0, 2981.8}, {2.0, 0.0, 0, 4008.9},   {0.5, 0.0, 1, 333.64}};
    for (const Row& row : rows) {
        CAPTURE(row.damping, row.virtual_damping, row.delay);
        const SampledWall wall{
            .damping = row.damping, .virtual_damping = row.virtual_damping, .delay = row.delay};
        const double exact = exact_stiffness(wall);
        CHECK(std::fabs(exact - row.limit) < 0.1);
        const double stepped = stability_limit(0.5 * exact, 10.0 * exact, 20, [&](double k) {
            return stepped_growth(wall, k, 6000) < 0.0;
        });
        CHECK(std::fabs(stepped / exact - 1.0) < 1e-4);
    }
    const SampledWall wall;
    const double exact = exact_stiffness(wall);
    const double growth[][2] = {{0.5, -0.833}, {0.9, -0.166}, {1.1, 0.166}, {2.0, 1.661}};
    for (const auto& [share, per_second] : growth) {
        CHECK(std::fabs(stepped_growth(wall, share * exact, 4000) / wall.period - per_second) <
              1e-3);
    }
}

TEST_CASE("with the delay that is spare the damping is just what is needed") {
    SEEDED(random, std::uint64_t{50});
    const double stiffness = random.in(50.0, 4000.0);
    const double period = 1.0 / random.in(1000.0, 10000.0);
    const double delay = random.in(0.0, 3.0);
    const double contact = random.in(-0.5, 0.5);
    const double device = random.in(0.0, 5.0);
    const double spare = spare_delay(stiffness, period, delay, contact, device);
    CHECK(min_damping(stiffness, period, delay + spare, contact) == Approx(device));
}

TEST_CASE("the simulated pantograph on a wall is stable up to the passivity bound and no further") {
    EACH(period, 1e-3, 0.25e-3, 0.1e-3);
    EACH(delay, 0, 1);
    const DeviceWall wall = fine_wall(0.5, period, delay);
    const SampledWall scalar = scalar_of(wall);
    const double measured = device_stiffness(wall, static_cast<int>(1.5 / period), 13);
    CHECK(std::fabs(measured / exact_stiffness(scalar) - 1.0) < 5e-4);
    CHECK(std::fabs(measured / passive_stiffness(scalar) - 1.0) < 1e-3);
}

TEST_CASE("an ordinary machine comes to rest on any wall within the bound, at any rate") {
    SEEDED(random, std::uint64_t{60});
    const double period = 1.0 / random.in(1000.0, 10000.0);
    PantographModel model;
    model.delay_ticks = random.below(2);
    if (random.coin()) {
        model.plant.hand = {.mass = 0.0, .stiffness = 0.0, .damping = 0.0};
    }
    SimulatedPantograph device(model, period);
    const DeviceTraits traits = device.traits();
    const double bound = *traits.damping / (period * (0.5 + traits.delay_ticks));
    const double stiffness = random.in(0.1, 0.95) * bound;
    const double surface = random.in(0.015, 0.040);
    const Vec2 start{random.in(-0.03, 0.03), surface + 0.001};
    CAPTURE(period, model.delay_ticks, stiffness, start.x, start.y);
    device.begin({.start = start, .speed = 1e-6, .tremor = 0.0});
    double early = 0.0;
    double late = 0.0;
    Vec2 before = start;
    const int ticks = static_cast<int>(1.5 / period);
    for (int i = 0; i < ticks; ++i) {
        const Reading reading = device.read();
        REQUIRE(reading.ok());
        const double speed = glm::length(Vec2(reading.hip) - before) / period;
        (i < ticks / 3 ? early : late) += i < ticks / 3 || i >= 2 * (ticks / 3) ? speed : 0.0;
        before = Vec2(reading.hip);
        device.write({0.0, std::fmax(0.0, stiffness * (surface - reading.hip.y)) - 1.5, 0.0});
    }
    CHECK(glm::length(before - start) < 0.02);
    CHECK(late < 0.1 * early);
}

TEST_CASE(
    "a machine whose counts show rests if its dry friction is above K times a reading's error") {
    EACH(period, 1e-3, 0.25e-3);
    EACH(delay, 0, 1);
    EACH(share, 1.5, 3.0);
    EACH(counts, 8192.0, 65536.0);
    CountedWall wall{.period = period, .delay = delay, .counts_per_turn = counts};
    const double need = min_damping(wall.stiffness, period, delay);
    wall.damping = share * need;
    const CountedRest loose = let_go(wall, 4.0);
    const double resting = resting_friction(wall.stiffness, period, loose.reading_error);
    // Without dry friction it creeps on, but no faster than the bound.
    CHECK(loose.speed > 1e-5);
    CHECK(loose.speed <= creep_limit(resting, 0.0, wall.damping - need));
    wall.friction = 0.3 * resting;
    CHECK(let_go(wall, 4.0).speed <= creep_limit(resting, wall.friction, wall.damping - need));
    wall.friction = resting;
    CHECK(let_go(wall, 4.0).speed < 1e-9);
}

TEST_CASE("the friction that lets a machine rest, bisected, is within the formula and near it") {
    CountedWall wall{.counts_per_turn = 65536.0};
    wall.damping = 1.5 * min_damping(wall.stiffness, wall.period, 0);
    const double formula =
        resting_friction(wall.stiffness, wall.period, let_go(wall, 0.01).reading_error);
    const double measured = least_friction(wall, 2.0 * formula, 7);
    CHECK(measured <= formula);
    CHECK(measured > 0.8 * formula);
    CHECK(creep_limit(1.0, 1.0, -1.0) == 0.0);
    CHECK(std::isinf(creep_limit(1.0, 0.5, 0.0)));
    CHECK(creep_limit(0.5, 0.1, 2.0) == Approx(0.2));
}
