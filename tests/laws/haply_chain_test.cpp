#include "engine/device/emulator/hands.hpp"
#include "engine/device/simulated_pantograph.hpp"
#include "protocols/file/calibration_file.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/haply_bench.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;
using palpate::protocols::load_calibration;

// Calibration file -> emulated machine -> board -> bytes -> driver -> HIP. Expected is where the
// handle truly is: closed form from the hand's joint angles.

namespace {

/// How far HIP may be off with each encoder wrong by one count, m.
double one_count(const Pantograph& pantograph, const JointAngles& angles) {
    return std::sqrt(2.0) * pantograph.quantum(pantograph.locate(angles).value()).largest;
}

}  // namespace

TEST_CASE(
    "with every shipped calibration the whole chain finds the handle within one encoder count",
    "[haply]") {
    const std::string name = GENERATE("haplet", "2diy_gen2", "2diy_gen3");
    const bool homed = GENERATE(false, true);
    CAPTURE(name, homed);
    Calibration machine = load_calibration(name);
    REQUIRE_FALSE(machine.home);  // the shipped ones count from zero_deg
    machine.home = Exploration{}.start;
    HaplyBench bench(machine);
    if (!homed) {
        bench.machine.home.reset();
        const JointAngles zero{machine.pantograph.axes[0].zero, machine.pantograph.axes[1].zero};
        bench.plant.lead(bench.pantograph.locate(zero).value().hip);
    }
    bench.open();
    bench.tick({});
    Random random(3);
    int places = 0;
    for (int i = 0; i < 400; ++i) {
        const Vec2 place{random.in(-0.04, 0.04), random.in(0.0, 0.06)};
        if (!bench.pantograph.reach(place)) {
            continue;
        }
        ++places;
        bench.plant.lead(place);
        bench.ticks({}, 3);
        const Reading reading = bench.tick({});
        REQUIRE(reading.ok());
        const auto expected = bench.pantograph.counts(bench.plant.angles());
        for (std::size_t pivot = 0; pivot < 2; ++pivot) {
            CHECK(std::abs(reading.counts[pivot] - expected[pivot]) <= 1);
        }
        CHECK(glm::length(Vec2(reading.hip) - place) <=
              1.01 * one_count(bench.pantograph, bench.plant.angles()));
    }
    CHECK(places > 300);
}

TEST_CASE("the hand of palpate haply-emulator is found where it truly is, all through its round",
          "[haply]") {
    EACH(name, as<std::string>{}, "haplet", "2diy_gen2", "2diy_gen3");
    const Calibration machine = load_calibration(name);
    const Pantograph pantograph(machine.pantograph);
    DeskHand hand(machine);
    HaplyBoard board(hand, machine.pantograph, *machine.haply);
    BoardCable cable(board);
    ScriptedGuard::Script guard;
    double worst = 0.0;    // in counts' worth
    double fastest = 0.0;  // m/s
    const auto session = [&](double seconds) {
        BoardDevice device(machine, std::make_unique<BoardLink>(cable), haply_line,
                           std::make_unique<ScriptedGuard>(guard));
        for (int i = 0; i < seconds * 1000.0; ++i) {
            const Vec2 before = hand.hip();
            device.write({});
            cable.pass(kPeriodNs);
            const Reading reading = device.read();
            REQUIRE(reading.ok());
            fastest = std::max(fastest, glm::length(hand.hip() - before) / 1.0e-3);
            worst = std::max(worst, (glm::length(Vec2(reading.hip) - before) -
                                     glm::length(hand.hip() - before)) /
                                        one_count(pantograph, hand.angles()));
        }
    };
    session(4.0);   // ends on the way to the object
    session(25.0);  // another one on the same board: the handle was brought home
    CHECK(worst <= 1.01);
    CHECK(fastest < 1.0);
    CHECK(hand.torque() == Vec3{});
}

TEST_CASE(
    "over a real port the simulated hand of the demo is found at the start of each exploration",
    "[haply]") {
    EACH(name, as<std::string>{}, "haplet", "2diy_gen2", "2diy_gen3");
    Calibration machine = load_calibration(name);
    machine.home = Exploration{}.start;
    const Pantograph pantograph(machine.pantograph);
    PlantModel plant;
    plant.machine = machine.pantograph;
    std::unique_ptr<EmulatedHaply> opened;
    for (int attempt = 0; !opened;
         ++attempt) {  // a busy machine may leave the board without its turn
        try {
            opened = std::make_unique<EmulatedHaply>(
                machine, [plant] { return std::make_unique<HandOf<PantographPlant>>(plant); },
                BoardTiming{.patience = 1000.0, .silence = 10.0},
                GuardTiming{.wait_ms = 5, .patience = 100'000});
        } catch (const std::exception&) {
            if (attempt == 10) {
                throw;
            }
        }
    }
    EmulatedHaply& haply = *opened;
    for (const Vec2& start : {Vec2{0.0, 0.060}, Vec2{0.02, 0.05}, Vec2{-0.03, 0.03}}) {
        haply.begin({.start = start, .speed = 1e-9, .tremor = 0.0});
        Reading reading = haply.device().read();
        for (int turn = 0; turn < 500 && reading.ok() && !reading.fresh; ++turn) {
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
            haply.device().write({});
            reading = haply.device().read();
        }
        REQUIRE(reading.ok());
        REQUIRE(reading.fresh);
        CHECK(glm::length(Vec2(reading.hip) - start) <=
              1.01 * one_count(pantograph, pantograph.reach(start).value()));
        haply.device().write({});
    }
}
