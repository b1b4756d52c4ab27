#include "engine/device/machine.hpp"
#include "engine/device/simulated_gantry.hpp"
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

TEST_CASE("three straight axes stand at home + r q, to 50 nm, within their ends and nowhere else") {
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
    "given") {
    SEEDED(random, 100U);
    const Calibration calibration = any_gantry(random);
    const Machine machine(calibration);
    const auto& axes = calibration.gantry->axes;
    const auto home = machine.locate({});
    REQUIRE(home);
    const double weakest = machine.weakest_force(home->hip).value();
    for (int i = 0; i < 20; ++i) {
        const Vec3 force(random.in(-20.0, 20.0), random.in(-20.0, 20.0), random.in(-20.0, 20.0));
        const MotorDrive drive = machine.drive(*home, force);
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

TEST_CASE("numbers of a gantry that cannot be are refused with what to give") {
    Random random(1);
    const Calibration good = any_gantry(random);
    REQUIRE_NOTHROW(check(good));
    const auto refused = [&](const char* words, const auto& change) {
        Calibration bad = good;
        change(bad);
        CHECK_THROWS_WITH(check(bad), Has(words));
    };
    refused("radius (m) of the drum of axis z is 0",
            [](auto& bad) { bad.gantry->axes[2].radius = 0.0; });
    refused("home (mm) of axis y is 200", [](auto& bad) { bad.gantry->axes[1].home = 0.2; });
    refused("way (mm) from the low to the high end of axis x",
            [](auto& bad) { bad.gantry->axes[0].high = bad.gantry->axes[0].low; });
    refused("channel of the open board is 2 for two axes", [](auto& bad) {
        bad.board->channel = {1, 2, 2};
    });
    refused("channel of the open board is 4: give 1 to 3", [](auto& bad) {
        bad.board->channel = {1, 2, 4};
    });
    refused("only an open board drives so many", [](auto& bad) { bad.haply.emplace(); });
}

TEST_CASE("a gantry that nobody holds follows the closed form of mass and damper, on each axis") {
    SEED(20U);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> share{-0.9, 0.9};
    GantryModel model{.mass = 0.1 + 0.1 * (1.0 + share(random)),
                      .damping = 2.0 + share(random),
                      .current_time = 0.0};
    model.hand = kNobody;
    SimulatedGantry machine(model, 1e-3);
    machine.begin({.start = {0.01, -0.02, 0.03}});
    const Vec3 force = std::round(1e3 * 0.3) * 1e-3 * Vec3(share(random), share(random), 1.0);
    Reading reading;
    constexpr int kTicks = 300;
    for (int k = 0; k < kTicks; ++k) {
        reading = machine.read();
        static_cast<void>(machine.write(force));
    }
    // The command of tick 0 acts from tick 1 on.
    const double time = 1e-3 * (kTicks - 2);
    const double tau = model.mass / model.damping;
    const double way = (time - tau * (1.0 - std::exp(-time / tau))) / model.damping;
    // Codes of 1 mN, counts of 1 um.
    CHECK(std::fabs(reading.hip.x - 0.01 - way * force.x) < 0.6e-3 * way + 2e-6);
    CHECK(std::fabs(reading.hip.y + 0.02 - way * force.y) < 0.6e-3 * way + 2e-6);
    CHECK(std::fabs(reading.hip.z - 0.03 - way * force.z) < 0.6e-3 * way + 2e-6);
    CHECK(reading.counts[2] == std::lround(reading.hip.z * 1e6));
}

TEST_CASE("codes of a gantry are its force in mN, cut at each motor's limit and said so") {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> newtons{-20.0, 20.0};
    SimulatedGantry machine({}, 1e-3);
    for (int i = 0; i < 1000; ++i) {
        const Vec3 force(newtons(random), newtons(random), newtons(random));
        const AppliedForce applied = machine.write(force);
        const double given[]{1e-3 * applied.codes[0], 1e-3 * applied.codes[1],
                             1e-3 * applied.codes[2]};
        bool cut = false;
        for (int axis = 0; axis < 3; ++axis) {
            const double max = std::copysign(std::fmin(std::fabs(force[axis]), 12.0), force[axis]);
            CHECK(std::fabs(given[axis] - max) < 0.51e-3);
            cut = cut || std::fabs(force[axis]) > 12.0;
        }
        CHECK(applied.saturated == cut);
    }
}

TEST_CASE(
    "the hand of a gantry comes down on the patch, crosses it and leaves, the same each time") {
    const auto seed = GENERATE(palpate::tests::seeds(10U));
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> turn{0.0, 6.28};
    const SurfaceExploration plan{.strokes = 6 + static_cast<int>(seed % 3), .turn = turn(random)};
    SimulatedGantry machine({}, 1e-3);
    SimulatedGantry again({}, 1e-3);
    machine.begin(plan);
    again.begin(plan);
    CHECK(machine.read().hip == plan.start);
    static_cast<void>(again.read());
    double lowest = 1.0;
    double widest = 0.0;
    double nearest = 1.0;  // to the middle, while it is down
    Reading reading;
    while (!machine.hand_is_done()) {
        static_cast<void>(machine.write({}));
        static_cast<void>(again.write({}));
        reading = machine.read();
        const Reading other = again.read();
        REQUIRE(std::memcmp(&reading.hip, &other.hip, sizeof(Vec3)) == 0);
        REQUIRE(reading.counts == other.counts);
        lowest = std::min(lowest, reading.hip.z);
        widest = std::max(widest, glm::length(Vec2(reading.hip)));
        if (reading.hip.z < -0.005) {
            nearest = std::min(nearest, glm::length(Vec2(reading.hip)));
        }
    }
    CHECK(lowest < -0.9 * plan.press_depth);
    CHECK(lowest > -1.2 * plan.press_depth);
    CHECK(widest < 1.2 * plan.radius);
    CHECK(widest > 0.8 * plan.radius);
    CHECK(nearest < 0.002);
    CHECK(reading.hip.z > 0.005);
    CHECK(machine.duration() > 3.0);
}

TEST_CASE("numbers of a gantry out of their range are refused by name") {
    CHECK_THROWS_WITH(SimulatedGantry({.mass = 0.0}, 1e-3),
                      "the simulated gantry's mass (kg) is 0: give 0.001 to 10");
    CHECK_THROWS_WITH(SimulatedGantry({}, 0.0),
                      "the simulated gantry's period (s) is 0: give 1e-06 to 0.1");
}
