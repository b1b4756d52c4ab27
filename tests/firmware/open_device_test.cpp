#include "engine/device/open/open_line.hpp"
#include "tests/firmware/boards.hpp"
#include "tests/support/board_link.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/miswired_machine.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

// The driver of `--device board:PORT` in lockstep with the firmware: one clock, the board's.
#if defined(PALPATE_FIRMWARE_328P)
#define DESKS OnHost, On328p
#else
#define DESKS OnHost
#endif
#define DESK_CASE(name) TEMPLATE_TEST_CASE(name, "[open][law]", DESKS)

namespace {

template <class On>
struct DeskParts {
    Calibration claimed;
    Calibration truth;
    GuidedHand plant{truth};
    typename On::Board board = On::make(plant, truth);
};

template <class On>
struct Desk : DeskParts<On>, BoardDesk {
    /// @param machine  the truth   @param says  what the calibration says of it
    explicit Desk(const Calibration& machine = open_machine(),
                  const std::optional<Calibration>& says = std::nullopt)
        : DeskParts<On>{.claimed = says.value_or(machine), .truth = machine},
          BoardDesk(this->board, open_line) {}

    void open() { BoardDesk::open(this->claimed, {.still = 0.05}); }
};

constexpr Vec2 kGuardedPress{0.3, -0.4};

/// Open, and pressed for so many ticks without a fault.
template <class On>
struct PressedDesk : Desk<On> {
    explicit PressedDesk(int ticks) {
        this->open();
        REQUIRE(this->ticks(kGuardedPress, ticks).ok());
    }
    void comes_back() {
        CHECK(this->device->reconnect());
        CHECK(this->ticks(kGuardedPress, 5).ok());
    }
};

}  // namespace

DESK_CASE("over an open board HIP follows the hand and the motors the force") {
    Calibration machine = open_machine();
    machine.board->channel = {2, 1};
    machine.board->motor_clockwise = {false, true};
    machine.board->encoder_clockwise = {true, false};
    Desk<TestType> desk(machine);
    desk.open();
    const DeviceTraits traits = desk.device->traits();
    CHECK(traits.delay_ticks == 1.0);
    CHECK(traits.holds_force == 0.020);
    CHECK(traits.round_trip < 0.7e-3);
    CHECK_FALSE(desk.board.enabled());
    const Pantograph pantograph(machine.pantograph);
    Random random(19);
    Vec2 led = *machine.home;
    int fresh = 0;
    for (int i = 0; i < 300; ++i) {
        const Vec2 force{random.in(-0.5, 0.5), random.in(-0.5, 0.5)};
        const Vec2 before = led;
        led += Vec2{random.in(-2e-4, 2e-4), random.in(-2e-4, 2e-4)};
        desk.plant.lead(led);
        const Reading reading = desk.tick(force);
        REQUIRE(reading.ok());
        if (i < 3) {
            continue;
        }
        fresh += reading.fresh ? 1 : 0;
        CHECK(glm::length(Vec2(reading.hip) - before) < 3e-4);
        const auto fix = pantograph.locate(pantograph.angles(reading.counts));
        const Vec3 wanted = pantograph.drive(*fix, force).torque;
        CHECK(std::fabs(desk.board.torque().x - wanted.x) < 160e-6);
        CHECK(std::fabs(desk.board.torque().y - wanted.y) < 160e-6);
    }
    CHECK(fresh == 297);
    desk.device.reset();
    CHECK_FALSE(desk.board.enabled());
    CHECK(desk.guard.releases > 0);
}

DESK_CASE("a board that is not the calibration's is refused with the remedy") {
    const Calibration truth = open_machine();
    const auto refused = [&](const Calibration& claimed, const std::string& why) {
        Desk<TestType> desk(truth, claimed);
        CHECK_THROWS_WITH(desk.open(), Has(why));
        CHECK_FALSE(desk.board.enabled());
    };
    Calibration claimed = truth;
    claimed.pantograph.axes[1].counts_per_turn = 4881.0;
    refused(claimed,
            "was flashed for 4880 and 4880 counts a turn, and the calibration says 4880 and "
            "4881: correct");
    claimed = truth;
    claimed.pantograph.axes[0].torque_limit = 0.124;
    refused(claimed, "less than the calibration's torque_limit_mn_m");
    claimed = truth;
    claimed.board->id = 7;
    refused(claimed, "has the id 0, and the calibration is of the board 7");
    claimed = truth;
    claimed.board.reset();
    refused(claimed, "does not say how an open board is wired: add [board]");
    {
        Desk<TestType> desk;
        desk.board.press_stop(true);
        CHECK_THROWS_WITH(desk.open(), Has("emergency stop", "release it"));
        desk.board.press_stop(false);
        desk.open();
        CHECK(desk.ticks(kGuardedPress, 5).ok());
    }
    Desk<TestType> unguarded;
    unguarded.guard.there = false;
    CHECK_THROWS_WITH(unguarded.open(), Has("no guard process"));
}

DESK_CASE("an emergency stop in a trial is a fault until it is released and forgiven") {
    PressedDesk<TestType> desk(20);
    CHECK(desk.board.enabled());
    desk.board.press_stop(true);
    desk.ticks(kGuardedPress, 2);
    CHECK_FALSE(desk.board.enabled());
    CHECK(desk.ticks(kGuardedPress, 2).fault == DeviceFault::stopped);
    CHECK_THAT(desk.device->trouble(), Has("emergency stop"));
    CHECK_FALSE(desk.device->reconnect());
    CHECK_THAT(desk.device->trouble(), Has("release it when it is safe"));
    desk.board.press_stop(false);
    desk.ticks(kGuardedPress, 20);
    CHECK_FALSE(desk.board.enabled());  // nothing by itself
    CHECK(desk.device->reconnect());
    CHECK(desk.device->trouble().empty());
    CHECK(desk.ticks(kGuardedPress, 5).ok());
    CHECK(desk.board.enabled());
    CHECK(desk.board.torque() != Vec3{});
}

DESK_CASE("an emergency stop while nothing ticks is not forgotten") {
    PressedDesk<TestType> desk(5);
    desk.ticks({}, 5);
    desk.board.press_stop(true);
    desk.cable.pass(300'000'000);
    desk.board.press_stop(false);
    desk.cable.pass(300'000'000);
    CHECK(desk.tick(kGuardedPress).fault == DeviceFault::stopped);
    CHECK_FALSE(desk.board.enabled());
    desk.comes_back();
}

DESK_CASE("a host that stalls with the force on finds its motors off, and a rest is no stall") {
    PressedDesk<TestType> desk(20);
    desk.ticks({}, 2);
    desk.cable.pass(1'000'000'000);  // a rest: the board has stopped by itself
    CHECK_FALSE(desk.board.enabled());
    REQUIRE(desk.ticks(kGuardedPress, 20).ok());
    CHECK(desk.board.torque() != Vec3{});
    desk.cable.pass(21'000'000);
    CHECK_FALSE(desk.board.enabled());
    CHECK(desk.ticks(kGuardedPress, 4).fault == DeviceFault::stopped);
    CHECK_THAT(desk.device->trouble(), Has("no torque came for 20 ms"));
    desk.comes_back();
}

DESK_CASE("a board that is reset in a trial has forgotten where it was") {
    PressedDesk<TestType> desk(30);
    desk.board.power_cycle();
    const bool at_once = GENERATE(true, false);
    desk.cable.pass(at_once ? 3'000'000 : 45'000'000);
    const DeviceFault fault = desk.ticks(kGuardedPress, 3).fault;
    CHECK(fault == (at_once ? DeviceFault::lost : DeviceFault::silent));
    CHECK_FALSE(desk.board.enabled());
    CHECK_THAT(desk.device->trouble(),
               Has(at_once ? "was reset, or its power failed" : "stopped answering"));
    CHECK_FALSE(desk.device->reconnect());
    CHECK_THAT(desk.device->trouble(), Has("put the handle at its home pose"));
    desk.plant.lead(*desk.truth.home);
    desk.cable.pass(20'000'000);
    CHECK(desk.device->reconnect());
    const Reading reading = desk.ticks(kGuardedPress, 5);
    CHECK(reading.ok());
    CHECK(glm::length(Vec2(reading.hip) - *desk.truth.home) < 3e-4);
}

DESK_CASE("a board that somebody else set up meanwhile is set up anew, its place found at home") {
    PressedDesk<TestType> desk(20);
    desk.ticks({}, 2);
    desk.cable.pass(300'000'000);  // a rest: the board has stopped by itself
    const OpenConfig other{.token = 1, .zero_counts = true, .limit = {1000, 1000}};
    CHECK(desk.cable.send(open_frame(open_config(7, other)).view()));
    desk.cable.pass(5'000'000);
    CHECK(desk.ticks(kGuardedPress, 4).fault == DeviceFault::lost);
    CHECK_FALSE(desk.board.enabled());
    CHECK_FALSE(desk.device->reconnect());
    CHECK_THAT(desk.device->trouble(), Has("put the handle at its home pose"));
    desk.plant.lead(*desk.truth.home);
    desk.cable.pass(20'000'000);
    CHECK(desk.device->reconnect());
    CHECK(desk.ticks(kGuardedPress, 5).ok());
}

DESK_CASE("a cable pulled with the force on has its motors off, and comes back") {
    PressedDesk<TestType> desk(20);
    desk.cable.plug(false);
    CHECK(desk.ticks(kGuardedPress, 3).fault == DeviceFault::lost);
    CHECK_FALSE(desk.board.enabled());
    CHECK_FALSE(desk.device->reconnect());
    CHECK_THAT(desk.device->trouble(), Has("plug it in"));
    desk.cable.plug(true);
    CHECK_FALSE(desk.device->reconnect());
    desk.comes_back();
    CHECK(desk.board.enabled());
}

TEST_CASE("answers that are lost now and then make a reading old, and no fault", "[open]") {
    Desk<OnHost> desk;
    desk.open();
    Random random(23);
    int stale = 0;
    for (int i = 0; i < 2000; ++i) {
        desk.board.hush(random.below(20) == 0);
        const Reading reading = desk.tick(kGuardedPress);
        REQUIRE(reading.ok());
        stale += reading.fresh ? 0 : 1;
        CHECK((i < 5 || desk.board.enabled()));
    }
    CHECK(stale > 40);
    CHECK(stale < 250);
    desk.board.hush(true);
    CHECK(desk.ticks(kGuardedPress, 50).fault == DeviceFault::silent);
    desk.ticks({}, 30);
    CHECK_FALSE(desk.board.enabled());
}

TEST_CASE("an encoder that skipped an edge ends the force until the handle was at home", "[open]") {
    PressedDesk<OnHost> desk(10);
    desk.board.skip_edge();
    CHECK(desk.ticks(kGuardedPress, 3).fault == DeviceFault::lost);
    CHECK_THAT(desk.device->trouble(), Has("skipped an edge"));
    CHECK_FALSE(desk.device->reconnect());
    CHECK_THAT(desk.device->trouble(), Has("home pose"));
    desk.comes_back();
}

TEST_CASE("a joint that jumps between two answers ends the force", "[open]") {
    PressedDesk<OnHost> desk(10);
    desk.plant.lead({0.04, 0.05});
    CHECK(desk.ticks(kGuardedPress, 3).fault == DeviceFault::garbage);
}

TEST_CASE("a handle that moves while the board is opened is refused", "[open]") {
    class Moving : public GuidedHand {
    public:
        using GuidedHand::GuidedHand;
        void advance(double seconds) noexcept override {
            time_ += seconds;
            lead({0.02 * time_, 0.06});
        }

    private:
        double time_ = 0.0;
    };
    const Calibration machine = open_machine();
    Moving plant(machine);
    OpenBoard board(plant, machine, *machine.board);
    BoardDesk desk(board, open_line);
    CHECK_THROWS_WITH(desk.open(machine), Has("moves: let it rest at home"));
}

TEST_CASE("a port where something else speaks is distinguished from one where nobody does",
          "[open]") {
    const Calibration machine = open_machine();
    Calibration haply = emulated_calibration("gen3");
    GuidedHand plant(haply);
    HaplyBoard other(plant, haply.pantograph, *haply.haply);
    BoardDesk desk(other, open_line);
    CHECK_THROWS_WITH(desk.open(machine), Has("open board"));
    CHECK(other.journal().exchanges == 0);  // what it took our greeting for turned no motor
    CHECK(other.torque() == Vec3{});
    Desk<OnHost> silent;
    silent.board.hush(true);
    CHECK_THROWS_WITH(silent.open(), Has("does not answer at 1,000,000 baud"));
}

TEMPLATE_TEST_CASE("an open board is commissioned, and a reversed motor of it is found",
                   "[open][commission][law]",
                   DESKS) {
    EACH(reversed, false, true);
    const Calibration machine = open_machine();
    PlantModel plant;
    plant.machine = machine.pantograph;
    FreeHandle handle(plant, *machine.home);
    Calibration truth = machine;
    truth.board->motor_clockwise[0] = reversed;
    auto board = TestType::make(handle, truth);
    BoardDesk desk(board, open_line);
    desk.open(machine);
    const CommissioningResult done =
        commission(*desk.device, machine, places_to_commission(machine, *machine.home), Vec3(0.060),
                   attended(
                       [&](const Vec3& place) {
                           handle.put(Vec2(place));
                           desk.cable.pass(200'000'000);
                       },
                       [&] { desk.pass_tick(); }));
    CAPTURE(done.refused);
    CHECK(done.refused.empty() == !reversed);
    CHECK_THAT(done.refused, Has(reversed ? "motor 1 is reversed" : ""));
    if (!reversed) {
        CHECK(done.record.dynamics.handle_mass == Approx(plant.handle_mass).epsilon(0.1));
        CHECK(done.record.round_trip > 0.0);
    }
    CHECK_FALSE(desk.guard.force);
}
