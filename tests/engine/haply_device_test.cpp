#include "tests/support/catch.hpp"
#include "tests/support/haply_bench.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

TEST_CASE("after the set-up HIP is home", "[haply]") {
    HaplyBench bench;
    bench.plant.lead({0.013, 0.027});  // wherever it was: counts start at the set-up
    bench.open();
    CHECK(glm::length(Vec2(bench.tick({}).hip) - *bench.machine.home) < 1e-4);
    CHECK(bench.device->trouble().empty());
    CHECK(bench.board.journal().setups == 1);
    CHECK(bench.device->traits().delay_ticks == 1.0);
}

TEST_CASE("the motors get the torques of the force, each at its own pivot", "[haply]") {
    const char* preset = GENERATE("gen3", "gen2", "haplet");
    HaplyBench bench(emulated_calibration(preset));
    bench.open();
    Random random(17);
    for (int i = 0; i < 300; ++i) {
        const Vec2 hip{random.in(-0.03, 0.03), random.in(0.01, 0.055)};
        const Vec2 force = random.point(-2.0, 2.0);
        bench.plant.lead(hip);
        bench.tick({});
        const Reading reading = bench.device->read();
        const AppliedForce applied = bench.device->write(Vec3(force, 0.0));
        bench.cable.pass(kPeriodNs);
        const auto fix = bench.pantograph.locate(bench.pantograph.angles(reading.counts));
        REQUIRE(fix);
        // J^T F, both scaled alike into 0.123 N m, cut to 12 bits.
        Vec2 wanted = fix->jacobian.transposed(force);
        const double max = std::max(std::fabs(wanted.x), std::fabs(wanted.y)) / kHaplyTorque;
        wanted /= std::max(max, 1.0);
        const double step = kHaplyTorque / 4095.0;
        CHECK(std::fabs(bench.board.torque().x - wanted.x) <= 1.001 * step);
        CHECK(std::fabs(bench.board.torque().y - wanted.y) <= 1.001 * step);
        CHECK(applied.saturated == (max > 1.0));
        CHECK(std::fabs(applied.codes[0] * step - wanted.x) <= 0.51 * step);
        CHECK(std::fabs(applied.load.y - std::fabs(wanted.y) / (0.5 * kHaplyTorque)) < 1e-12);
    }
}

TEST_CASE("no torque is sent before the board answered, and none that is not finite", "[haply]") {
    HaplyBench bench;
    bench.board.set_faults({.silent = true});
    CHECK_THROWS_WITH(bench.open(), Has("does not answer"));
    for (const auto& packet : bench.cable.sent()) {
        CHECK((packet[0] != 2 || is_zero_torque(packet) || is_quiet(packet)));
    }
    bench.board.set_faults({});
    bench.open();
    bench.ticks({0.5, 0.5}, 5);
    CHECK_FALSE(bench.board.torque() == Vec3{});
    const double bad =
        GENERATE(std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity());
    bench.tick({bad, 0.1});
    CHECK(bench.board.torque() == Vec3{});
    CHECK(bench.board.journal().undefined_duty == 0);
}

TEST_CASE("the first reading after a rest is not one from before it", "[haply]") {
    OpenHaply bench({}, 10);
    bench.plant.lead({0.03, 0.02});
    SECTION("a long one") {
        bench.cable.pass(3'000'000'000);
    }
    SECTION("a short one, and the handle was moved") {
        bench.device->expect_move();
    }
    const Reading reading = bench.tick({});
    CHECK(reading.fresh);
    CHECK(glm::length(Vec2(reading.hip) - Vec2{0.03, 0.02}) < 3e-4);
}

TEST_CASE("a pose that the linkage cannot have gives a fault and no force, and passes", "[haply]") {
    Calibration machine = emulated_calibration();
    machine.pantograph.linkage.free_1 = machine.pantograph.linkage.free_2 = 0.060;
    machine.home = Vec2{0.0, 0.0};
    HaplyBench bench(machine);
    bench.open();
    bench.ticks({0.3, 0.3}, 5);
    // The encoder of pivot 1 is off by so much that the free links could not reach each other.
    const JointAngles held = bench.plant.angles();
    double off = 0.0;
    while (off < 360.0 && bench.pantograph.locate({held[0] + off * M_PI / 180.0, held[1]})) {
        off += 10.0;
    }
    REQUIRE(off < 360.0);
    const double count = 360.0 / machine.pantograph.axes[0].counts_per_turn;
    bench.board.set_faults({.turned_deg = std::round((off + 5.0) / count) * count});
    const Reading bad = bench.ticks({0.3, 0.3}, 3);
    CHECK(bad.fault == DeviceFault::unreachable);
    CHECK(bench.board.torque() == Vec3{});
    bench.board.set_faults({});
    bench.ticks({0.3, 0.3}, 2);
    CHECK(bench.tick({0.3, 0.3}).ok());
}

TEST_CASE("grip is what the analogue input says", "[haply]") {
    Calibration machine = emulated_calibration();
    machine.haply->grip_pin = 56;
    HaplyBench bench(machine);
    bench.board.set_sensor(700.0);
    bench.open();
    CHECK(bench.tick({}).grip == Grip::held);
    bench.board.set_sensor(100.0);
    bench.tick({});
    CHECK(bench.tick({}).grip == Grip::released);
    HaplyBench without;
    without.open();
    CHECK(without.tick({}).grip == Grip::unknown);
}

TEST_CASE("a calibration that is not a Haply's, or whose home is out of reach, is refused",
          "[haply]") {
    Calibration machine = emulated_calibration();
    HaplyBench bench;
    bench.machine.haply.reset();
    CHECK_THROWS_WITH(bench.open(), Has("add [haply]"));
    bench.machine = machine;
    bench.machine.home = Vec2{0.0, 0.2};
    CHECK_THROWS_WITH(bench.open(), Has("does not reach its home pose (0, 200) mm"));
}
