#include "engine/device/replay_device.hpp"
#include "engine/geometry/arc.hpp"
#include "engine/realtime/tick_loop.hpp"
#include "engine/rendering/energy_ledger.hpp"
#include "engine/rendering/scene.hpp"
#include "engine/safety/energy_observer.hpp"
#include "stimuli/two_curve.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate;
using namespace palpate::engine;
using palpate::tests::Random;

TEST_CASE("no episode of contact gives more energy than sampling leaks, whatever hand and friction",
          "[rendering][law]") {
    SEEDED(random, 60U);
    const auto outline = stimuli::make_outline({.curvature = random.in(-20.0, 20.0)});
    const double mu_d = random.in(0.0, 1.0);
    const Scene scene(outline, {.friction = {.mu_s = mu_d + random.in(0.0, 0.5),
                                             .mu_d = mu_d,
                                             .tau_slip = random.coin() ? 0.0 : 0.02,
                                             .tau_heal = 0.1}});
    ContactState state;
    EnergyLedger<2> ledger(1000.0);
    Vec2 hip = random.point(-0.03, 0.03);
    Vec2 speed{};
    for (int i = 0; i < 6000; ++i) {
        speed = 0.97 * speed + random.point(-1.0, 1.0) * 3e-5 - 0.002 * hip;
        hip += speed;
        const Contact c = scene.tick(state, hip);
        ledger.add(hip, c.force, c.mode != Mode::free);
    }
    CHECK(ledger.episodes() > 0);
    CHECK(ledger.worst() <= 1e-12);
}

TEST_CASE("friction that pushes with the motion shows in the ledger", "[rendering]") {
    EnergyLedger<2> ledger(1000.0);
    for (int i = 0; i <= 100; ++i) {  // 2 N along a stroke of 10 mm
        ledger.add({1e-4 * i, -0.001}, {2.0, 1.0}, i > 0 && i < 100);
    }
    CHECK(ledger.episodes() == 1);
    // 99 held steps of 2 N x 0.1 mm, minus 100 leaks of K/2 (0.1 mm)^2 = 5 uJ.
    CHECK(ledger.worst() == Approx(99 * 2e-4 - 100 * 5e-6).epsilon(1e-9));
}

TEST_CASE("a contact that begins with HIP inside starts with the energy of its first stretch",
          "[rendering]") {
    EnergyLedger<2> ledger(1000.0);
    ledger.add({0.0, -0.002}, {0.0, 2.0}, true);  // K/2 (2 mm)^2 = 2 mJ
    ledger.add({0.0, 0.0}, {0.0, 0.0}, false);    // gives 4 mJ, leaks 2 mJ
    CHECK(ledger.worst() == Approx(0.0).margin(1e-15));
}

TEST_CASE("what a soft object gives back trips no energy observer, which knows what it stores",
          "[rendering][soft][safety]") {
    const auto outline = stimuli::make_outline({.curvature = 5.0});
    const Scene scene(outline, {.compliance = 4e-3});
    const Frame at = frame_at(outline->spans()[0], 0.5);
    SafetyLimits limits;
    limits.energy = 2e-3;
    limits.ramp_step = 1.0;
    std::vector<Reading> readings;
    for (int i = 0; i < 3000; ++i) {  // 13 mm in and out again, in a second each
        const double share = std::min({1.0, 1e-3 * i, 1e-3 * (3000 - i)});
        const Vec2 hip = at.point + (0.001 - 0.013 * share) * at.normal;
        readings.push_back({.hip = Vec3(hip, 0.0)});
    }
    ContactState state;
    EnergyObserver knows;
    EnergyObserver ignores;
    double max = 0.0;
    double max_unknown = 0.0;
    for (const Reading& reading : readings) {
        const Vec2 hip(reading.hip);
        const Contact c = scene.tick(state, hip);
        const Vec3 stretch = c.mode == Mode::free ? Vec3{} : Vec3(c.go - hip, 0.0);
        const Vec3 spring(scene.spring(state, c, hip), 0.0);
        max = std::max(max, observe_energy(knows, limits, reading.hip, spring, 1.0, 1e-3));
        max_unknown =
            std::max(max_unknown, observe_energy(ignores, limits, reading.hip, stretch, 1.0, 1e-3));
        note_command(knows, Vec3(c.force, 0.0));
        note_command(ignores, Vec3(c.force, 0.0));
    }
    CHECK(max < 1e-4);
    CHECK(max_unknown > 5e-3);

    ReplayDevice device;
    device.begin(readings);
    TickLoop loop(device, limits);
    loop.begin(scene);
    for (std::int64_t i = 0; !device.at_end(); ++i) {
        static_cast<void>(loop.tick({.time_ns = i * 1'000'000}));
    }
    CHECK(loop.trip() == Trip::none);
}
