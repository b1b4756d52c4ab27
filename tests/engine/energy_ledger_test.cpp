#include "engine/realtime/tick_loop.hpp"
#include "engine/rendering/energy_ledger.hpp"
#include "engine/rendering/scene.hpp"
#include "stimuli/two_curve.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

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
