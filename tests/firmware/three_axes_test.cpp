#include "engine/device/open/open_line.hpp"
#include "tests/firmware/boards.hpp"
#include "tests/support/board_link.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

// What the open board promises of a third axis: on this machine's processor and, where simavr is
// installed, on the chip.
#if defined(PALPATE_FIRMWARE_328P)
#define BOARDS_OF_3 OnHost, On2560Of3
#else
#define BOARDS_OF_3 OnHost
#endif

namespace {

constexpr double kStepOf3 = 120000.0 / 800.0 + 5.0;  // uN m: the scale is rounded too

template <class On>
struct Talk3 : Talk<On, LedGantry> {
    Talk3() : Talk<On, LedGantry>(gantry_machine()) {}

    /// uN m
    [[nodiscard]] Vec3 torques() const { return 1e6 * this->board.torque(); }
};

/// No pin of a motor is driven; of a firmware on this processor its torques are all there is.
template <class Board>
bool nothing_driven(const Board& board) {
    if constexpr (requires { board.driven(0); }) {
        return !board.driven(0) && !board.driven(1) && !board.driven(2);
    } else {
        return board.torque() == Vec3{};
    }
}

}  // namespace

TEMPLATE_TEST_CASE(
    "torques of three motors come out as asked, each within its own limit, with its own flag",
    "[firmware][gantry][law]",
    BOARDS_OF_3) {
    Talk3<TestType> talk;
    const auto ident = talk.hello();
    REQUIRE(ident);
    CHECK(ident->ident.axes == 3);
    CHECK(ident->ident.counts_per_turn == OpenAxes{2400, 2400, 2400});
    CHECK(ident->ident.torque_full == OpenAxes{120000, 120000, 120000});
    const OpenConfig config{
        .token = talk.kToken, .watchdog_ms = 50, .limit = {80000, 60000, 30000}, .axes = 3};
    const auto taken = talk.config(config);
    REQUIRE(taken);
    CHECK(taken->config == config);
    talk.arm();
    obeys_torques(talk, config.limit, kStepOf3);
    // What is of two axes is none of its words.
    const auto nak = talk.ask(open_torque(++talk.seq, {0, 0}, 2));
    REQUIRE(nak);
    CHECK(nak->type == OpenType::nak);
    CHECK(nak->why == 6);
}

TEMPLATE_TEST_CASE("whatever stops a board of three axes, no motor's pin stays driven",
                   "[firmware][gantry][safety][law]",
                   BOARDS_OF_3) {
    EACH(way, 0, 1, 2, 3);
    Talk3<TestType> talk;
    talk.make_ready(20, 120000);
    talk.torque(0, 0, 50000);  // the third alone
    REQUIRE(talk.torques().z > 49000.0);
    if (way == 0) {  // its watchdog
        const double off = talk.until_off(60.0);
        CHECK(off >= 17.9);
        CHECK(off <= 20.1);
    } else if (way == 1) {
        talk.board.press_stop(true);
        CHECK(talk.until_off(60.0) <= 1.06);
    } else if (way == 2) {
        talk.disarm();
    } else {
        talk.torque(0, 0, 0);
    }
    CHECK(nothing_driven(talk.board));
    CHECK(talk.torques() == Vec3{});
    CHECK(talk.board.enabled() == (way == 3));
    talk.pass_ms(100);
    CHECK_FALSE(talk.board.enabled());
    CHECK(nothing_driven(talk.board));
}

TEMPLATE_TEST_CASE(
    "over a board of three axes HIP follows the hand and all motors the force, however they are "
    "wired",
    "[open][gantry][law]",
    BOARDS_OF_3) {
    Calibration machine = gantry_machine();
    machine.board->channel = {3, 1, 2};
    machine.board->motor_clockwise = {false, true, true};
    machine.board->encoder_clockwise = {true, false, true};
    LedGantry plant(machine);
    auto board = TestType::make(plant, machine);
    BoardDesk desk(board, open_line);
    desk.open(machine, {.still = 0.05});
    const auto& device = desk.device;
    CHECK(device->traits().axes == 3);
    CHECK(device->traits().delay_ticks == 1.0);
    CHECK(device->traits().round_trip < 0.8e-3);
    CHECK(device->traits().damping == 3.0);
    Random random(23);
    Vec3 led = machine.gantry->home();
    for (int i = 0; i < 200; ++i) {
        const Vec3 force(random.in(-5.0, 5.0), random.in(-5.0, 5.0), random.in(-5.0, 5.0));
        const Vec3 before = led;
        led += Vec3(random.in(-1e-4, 1e-4), random.in(-1e-4, 1e-4), random.in(-1e-4, 1e-4));
        plant.lead(led);
        const Reading reading = device->read();
        const AppliedForce applied = device->write(force);
        desk.pass_tick();
        REQUIRE(reading.ok());
        if (i < 3) {
            continue;
        }
        CHECK(glm::length(reading.hip - before) < 2e-4);
        CHECK(glm::length(plant.torque() - 0.010 * force) < 2.0 * 160e-6);
        CHECK(std::fabs(applied.codes[2] - force.z * 0.010 / 0.12 * 800.0) <= 0.5 + 1e-9);
        CHECK(std::fabs(applied.load.z - std::fabs(force.z) * 0.010 / 0.06) < 1e-12);
        CHECK_FALSE(applied.saturated);
    }
    device->write(Vec3(0.0, 0.0, 20.0));
    desk.cable.pass(900'000);
    CHECK(std::fabs(plant.torque().z - 0.12) < 160e-6);
    // Outside its ends nothing is pushed.
    plant.lead(Vec3(0.0, 0.0, 0.0605));
    Reading reading;
    for (int i = 0; i < 60; ++i) {
        reading = device->read();
        device->write(Vec3(0.0, 0.0, 1.0));
        desk.cable.pass(1'000'000);
    }
    CHECK(reading.fault != DeviceFault::none);
    CHECK(plant.torque() == Vec3{});
    desk.device.reset();
    CHECK_FALSE(board.enabled());
}

TEST_CASE("a board of another number of axes is refused with the remedy", "[open]") {
    const auto refusal = [](const Calibration& truth, BoardPlant& plant,
                            const Calibration& claimed) {
        OpenBoard board(plant, truth, *truth.board);
        BoardDesk desk(board, open_line);
        return refusal_of<std::runtime_error>([&] { desk.open(claimed); });
    };
    const Calibration two = open_machine();
    const Calibration three = gantry_machine();
    GuidedHand hand(two);
    LedGantry gantry(three);
    CHECK_THAT(refusal(two, hand, three),
               Has("has 2 axes, and the calibration is of a machine with 3"));
    CHECK_THAT(refusal(three, gantry, two),
               Has("has 3 axes, and the calibration is of a machine with 2"));
}

#if defined(PALPATE_FIRMWARE_328P)
TEMPLATE_TEST_CASE("three encoders are counted, to and fro, and one that is too fast is reported",
                   "[firmware][gantry][law]",
                   On2560Of3) {
    Talk3<TestType> talk;
    talk.make_ready(50, 120000);
    for (const double way : {1.0, -1.0}) {
        counts_edges(talk, std::array{way * 25000.0, way * -20000.0, way * 25000.0}, 100);
    }
    talk.disarm();
    talk.config({.token = talk.kToken, .zero_counts = true, .limit = {1, 1, 1}, .axes = 3});
    CHECK(talk.peek().counts == OpenAxes{});
    talk.board.jump(2);
    talk.pass_ms(1);
    CHECK((talk.peek().flags & kOpenSkippedEdge) != 0);
}

// Not a law: the numbers that the manual tells. palpate_test_firmware "[numbers]"
TEST_CASE("numbers of the chip of three axes", "[.][numbers]") {
    for (const double speed : {0.0, 15000.0, 25000.0, 30000.0, 40000.0}) {
        Talk3<On2560Of3> talk;
        talk.make_ready(50, 120000);
        WARN(numbers_at(speed, talk));
    }
}
#endif
