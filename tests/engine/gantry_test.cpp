#include "engine/device/machine.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

namespace {

Calibration any_gantry(Random& random) {
    Calibration machine;
    machine.board.emplace();
    for (StraightAxis& axis : machine.gantry.emplace().axes) {
        axis.motor = {.counts_per_turn = std::floor(random.decade(2.5, 4.5)),
                      .torque_limit = random.in(0.05, 0.3),
                      .torque_forever = random.in(0.01, 0.05)};
        axis.radius = random.in(0.004, 0.03);
        axis.low = random.in(-0.1, -0.03);
        axis.high = random.in(0.03, 0.1);
        axis.home = random.in(-0.02, 0.02);
    }
    return machine;
}

}  // namespace

TEST_CASE("three straight axes stand at home + r q, to 50 nm, within their ends and nowhere else",
          "[gantry][law]") {
    SEEDED(random, 100U);
    const Calibration calibration = any_gantry(random);
    const Machine machine(calibration);
    const auto& axes = calibration.gantry->axes;
    for (int i = 0; i < 20; ++i) {
        Machine::Counts counts{};
        Vec3 place{};
        bool inside = true;
        for (std::size_t k = 0; k < 3; ++k) {
            counts[k] = random.below(8000) - 4000;
            const double turns = counts[k] / axes[k].motor.counts_per_turn;
            const double at = axes[k].home + axes[k].radius * 2.0 * 3.141592653589793 * turns;
            place[static_cast<int>(k)] = at;
            inside = inside && at > axes[k].low && at < axes[k].high;
        }
        const auto found = machine.locate(counts);
        REQUIRE(found.has_value() == inside);
        CHECK(machine.weakest_force(place).has_value() == inside);
        if (!found) {
            continue;
        }
        for (int k = 0; k < 3; ++k) {
            CHECK(std::fabs(found->hip[k] - place[k]) <= 0.5001e-7);
            // What a recording keeps of it in whole steps of 100 nm is it to the bit.
            CHECK(found->hip[k] == std::floor(found->hip[k] * 1e7 + 0.5) / 1e7);
        }
    }
}

TEST_CASE(
    "torques are r F, a force that is too strong keeps its direction, and one up to the weakest is "
    "given",
    "[gantry][law]") {
    SEEDED(random, 100U);
    const Calibration calibration = any_gantry(random);
    const Machine machine(calibration);
    const auto& axes = calibration.gantry->axes;
    const auto home = machine.locate({});
    REQUIRE(home);
    const double weakest = machine.weakest_force(home->hip).value();
    for (int i = 0; i < 20; ++i) {
        const Vec3 force(random.in(-20.0, 20.0), random.in(-20.0, 20.0), random.in(-20.0, 20.0));
        const Machine::Drive drive = machine.drive(*home, force);
        Vec3 given{};
        for (int k = 0; k < 3; ++k) {
            const StraightAxis& axis = axes[static_cast<std::size_t>(k)];
            given[k] = drive.torque[k] / axis.radius;
            CHECK(std::fabs(drive.torque[k]) <= axis.motor.torque_limit * (1.0 + 1e-12));
            CHECK(std::fabs(drive.load[k] * axis.motor.torque_forever -
                            std::fabs(drive.torque[k])) < 1e-12);
        }
        CHECK(glm::length(glm::cross(given, force)) < 1e-9);
        CHECK(glm::dot(given, force) > 0.0);
        CHECK(drive.saturated == (glm::length(given) < glm::length(force) * (1.0 - 1e-9)));
        const Vec3 weak = force * (weakest / glm::length(force));
        CHECK_FALSE(machine.drive(*home, weak).saturated);
    }
}

TEST_CASE("numbers of a gantry that cannot be are refused with what to give",
          "[gantry][calibration]") {
    Random random(1);
    const Calibration good = any_gantry(random);
    REQUIRE_NOTHROW(check(good));
    Calibration bad = good;
    bad.gantry->axes[2].radius = 0.0;
    CHECK_THROWS_WITH(check(bad), Has("radius (m) of the drum of axis z is 0"));
    bad = good;
    bad.gantry->axes[1].home = 0.2;
    CHECK_THROWS_WITH(check(bad), Has("home (m) of axis y is 0.2"));
    bad = good;
    bad.gantry->axes[0].high = bad.gantry->axes[0].low;
    CHECK_THROWS_WITH(check(bad), Has("way (m) from the low to the high end of axis x"));
    bad = good;
    bad.board->channel = {1, 2, 2};
    CHECK_THROWS_WITH(check(bad), Has("channel of the open board is 2 for two axes"));
    bad = good;
    bad.board->channel = {1, 2, 4};
    CHECK_THROWS_WITH(check(bad), Has("channel of the open board is 4: give 1 to 3"));
    bad = good;
    bad.haply.emplace();
    CHECK_THROWS_WITH(check(bad), Has("only an open board drives so many"));
}
