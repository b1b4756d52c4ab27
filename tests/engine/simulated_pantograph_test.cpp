#include "engine/device/simulated_pantograph.hpp"
#include "tests/support/catch.hpp"

using namespace palpate::engine;

namespace {

/// A hand that holds still at `place`.
Exploration still(const Vec2& place) {
    return {.start = place, .speed = 1e-6, .tremor = 0.0};
}

}  // namespace

TEST_CASE("without forces the handle follows the hand's intention from start to end") {
    SimulatedPantograph device({}, 1e-3);
    const Exploration plan{.tremor = 0.0};
    device.begin(plan);
    const HandPath path(plan);
    double worst = 0.0;
    int ticks = 0;
    while (!device.hand_is_done()) {
        const Reading reading = device.read();
        REQUIRE(reading.ok());
        device.write({});
        worst = std::max(worst, glm::length(Vec2(reading.hip) - path.at(ticks * 1e-3).position));
        ++ticks;
    }
    CHECK(std::fabs(ticks * 1e-3 - path.duration()) < 2e-3);
    CHECK(worst < 0.004);  // lag of joint damping and of the corners of the path
}

TEST_CASE("a constant force moves the handle by force over hand stiffness") {
    PantographModel model;
    model.plant.coulomb = Vec2{};
    model.delay_ticks = GENERATE(0, 1);
    const double period = GENERATE(1e-3, 0.25e-3, 0.1e-3);
    SimulatedPantograph device(model, period);
    device.begin(still({0.0, 0.030}));
    const Vec2 force = GENERATE(Vec2{1.5, 0.0}, Vec2{0.0, -2.0}, Vec2{-0.7, 0.9});
    Vec2 hip{};
    for (int i = 0; i < static_cast<int>(3.0 / period); ++i) {
        hip = Vec2(device.read().hip);
        device.write(Vec3(force, 0.0));
    }
    // Torques are rounded to DAC codes and HIP to counts: 1 um and 0.1 mN here.
    CHECK(glm::length(hip - (Vec2{0.0, 0.030} + force / model.plant.hand.stiffness)) < 2e-5);
}

TEST_CASE("the torque limit scales both joints alike and says so") {
    SimulatedPantograph device({}, 1e-3);
    static_cast<void>(device.read());
    const AppliedForce gentle = device.write({0.0, -2.0, 0.0});
    CHECK_FALSE(gentle.saturated);
    const AppliedForce hard = device.write({0.0, -200.0, 0.0});
    CHECK(hard.saturated);
    CHECK(std::max(std::abs(hard.codes[0]), std::abs(hard.codes[1])) == 32767);
    CHECK(std::fabs(static_cast<double>(hard.codes[0]) / hard.codes[1] -
                    static_cast<double>(gentle.codes[0]) / gentle.codes[1]) < 1e-3);
}

TEST_CASE("HIP is what the counts say") {
    PantographModel model;
    model.plant.machine.turn = 0.3;
    model.plant.machine.axes[1].zero = 0.5;
    const Pantograph machine(model.plant.machine);
    SimulatedPantograph device(model, 1e-3);
    for (int i = 0; i < 2000; ++i) {
        const Reading reading = device.read();
        device.write({});
        REQUIRE(reading.ok());
        const auto fix = machine.locate(machine.angles(reading.counts));
        REQUIRE(fix);
        REQUIRE(Vec3(fix->hip, 0.0) == reading.hip);
    }
}

TEST_CASE("a machine far from the usual start is simulated where its own exploration begins") {
    PantographModel model;
    model.plant.machine.origin += Vec2(0.4, 0.3);  // of the objects, in the linkage
    SimulatedPantograph device(model, 1e-3);
    const Vec2 start = Vec2(0.0, 0.06) - Vec2(0.4, 0.3);
    device.begin({.start = start, .tremor = 0.0});
    CHECK(glm::length(Vec2(device.read().hip) - start) < 1e-4);  // counts
    CHECK_THROWS_WITH(device.begin({}), Has("(0, 0.06)", "move the start"));
}

TEST_CASE("a start out of reach is refused with the place and the remedy") {
    SimulatedPantograph device({}, 1e-3);
    CHECK_THROWS_WITH(device.begin({.start = {0.0, 0.5}}), Has("0.5", "move the start"));
}

TEST_CASE("a tick of delay moves the answer to a force by one tick and changes nothing else") {
    PantographModel model;
    model.plant.hand = {.mass = 0.1, .stiffness = 0.0, .damping = 0.0};
    model.delay_ticks = 0;
    SimulatedPantograph prompt(model, 1e-3);
    model.delay_ticks = 1;
    SimulatedPantograph late(model, 1e-3);
    prompt.begin(still({0.005, 0.030}));
    late.begin(still({0.005, 0.030}));
    const Vec3 force{1.0, -2.0, 0.0};
    static_cast<void>(late.read());
    late.write(force);
    for (int i = 0; i < 40; ++i) {
        const Reading after = late.read();
        REQUIRE(prompt.read().counts == after.counts);
        prompt.write(i == 0 ? force : Vec3{});
        late.write({});
    }
    CHECK(late.traits().delay_ticks == prompt.traits().delay_ticks + 1.0);
}

TEST_CASE("the standard machine is passive at the study's stiffness, and says what it can do") {
    const SimulatedPantograph device({}, 1e-3);
    const DeviceTraits traits = device.traits();
    CHECK(traits.gives_force);
    CHECK(std::fabs(traits.delay_ticks - 1.15) < 1e-12);
    CHECK(traits.damping.value() > 1000.0 * 1e-3 * (0.5 + traits.delay_ticks));
    // At the symmetric pose joint damping at the handle is b / (2 lever^2) along y and x: never
    // less.
    const PlantModel plant;
    const Pantograph machine(plant.machine);
    for (const double y : {0.0, 0.02, 0.04, 0.06}) {
        const Jacobian j = machine.locate(machine.reach({0.0, y}).value())->jacobian;
        CHECK(plant.damping.x / (2.0 * j.row_y.y * j.row_y.y) >= *traits.damping * (1.0 - 1e-12));
        CHECK(plant.damping.x / (2.0 * j.row_x.x * j.row_x.x) >= *traits.damping * (1.0 - 1e-12));
    }
    CHECK(device.weakest_force({0.0, 0.03, 0.0}).value() > 8.0);
    CHECK_FALSE(device.weakest_force({0.0, 0.3, 0.0}));
}

TEST_CASE("a simulated machine that cannot be is refused with its number") {
    CHECK_THROWS_WITH(SimulatedPantograph({}, 0.0), Has("period is 0 s"));
    CHECK_THROWS_WITH(SimulatedPantograph({.plant = {}, .delay_ticks = 2}, 1e-3),
                      Has("delay is 2 ticks"));
}

TEST_CASE("from 1 to 10 kHz the hand explores and presses alike") {
    // On a soft wall a tick of delay matters little: at 80 mm/s the force of 200 N/m is 1.65 ms
    // (132 um, 26 mN) old at 1 kHz, which hand (300 N/m) and wall turn into 53 um at most.
    const int cuts = GENERATE(2, 4, 10);
    SimulatedPantograph slow({}, 1e-3);
    SimulatedPantograph fast({}, 1e-3 / cuts);
    const auto wall = [](const Vec3& hip) {
        return Vec3{0.0, std::fmax(0.0, 200.0 * (0.030 - hip.y)), 0.0};
    };
    double worst = 0.0;
    for (int tick = 0; tick < 4000; ++tick) {
        const Reading a = slow.read();
        slow.write(wall(a.hip));
        Reading b;
        for (int i = 0; i < cuts; ++i) {
            const Reading now = fast.read();
            fast.write(wall(now.hip));
            b = i == 0 ? now : b;
        }
        REQUIRE((a.ok() && b.ok()));
        worst = std::max(worst, glm::length(a.hip - b.hip));
    }
    CHECK(worst < 53e-6);
}

TEST_CASE("the hand holds against what is within its strength, and gives way to more") {
    const HandModel hand;
    const auto pushed = [](double newtons) {
        SimulatedPantograph device({}, 1e-3);
        device.begin(still({0.0, 0.020}));
        Vec3 hip{};
        for (int i = 0; i < 2000; ++i) {
            const Reading reading = device.read();
            device.write({0.0, reading.ok() ? newtons : 0.0, 0.0});
            hip = reading.ok() ? reading.hip : hip;
        }
        return hip.y - 0.020;
    };
    // It gives by force over stiffness, less what dry friction holds of it.
    CHECK(std::fabs(pushed(0.9 * hand.strength) - 0.9 * hand.strength / hand.stiffness) < 2e-4);
    CHECK(pushed(1.2 * hand.strength) > 3.0 * hand.strength / hand.stiffness);
}
