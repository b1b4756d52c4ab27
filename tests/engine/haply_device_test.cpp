#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/device/drivers/haply_device.hpp"
#include "engine/device/emulator/board_link.hpp"
#include "engine/device/emulator/emulated_haply.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/guided_plant.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;
using namespace palpate::tests;
using Catch::Matchers::ContainsSubstring;

namespace {

constexpr std::int64_t kPeriod = 1'000'000;  // ns
using Packets = std::vector<BoardCable::Packet>;

/// A board in memory, its driver, and the clock that both live on.
struct Bench {
    explicit Bench(const Calibration& calibration = emulated_calibration())
        : machine(calibration) {}

    Calibration machine;
    Pantograph pantograph{machine.pantograph};
    GuidedPlant plant{machine};
    HaplyBoard board{plant, machine.pantograph, *machine.haply};
    BoardCable cable{board};
    ScriptedGuard::Script guard;
    std::unique_ptr<HaplyDevice> device;

    void open(const HaplyTiming& timing = {}) {
        device = std::make_unique<HaplyDevice>(machine, std::make_unique<BoardLink>(cable),
                                               std::make_unique<ScriptedGuard>(guard), timing);
    }
    Reading tick(const Vec2& force) {
        const Reading reading = device->read();
        device->write(force);
        next_ = std::max(next_ + kPeriod, cable.now_ns());
        cable.pass(std::max(next_ - cable.now_ns(), kPeriod / 10));
        return reading;
    }
    Reading ticks(const Vec2& force, int number) {
        Reading reading;
        for (int i = 0; i < number; ++i) {
            reading = tick(force);
        }
        return reading;
    }

private:
    std::int64_t next_ = 0;  ///< deadline, ns
};

bool is_zero_torque(const BoardCable::Packet& packet) {
    return packet.size() == 10 && packet[0] == 2 &&
           std::all_of(packet.begin() + 2, packet.end(), [](auto byte) { return byte == 0; });
}

/// What must hold of all bytes that a driver ever sends, whole packets from a list of sends.
/// @return what is wrong with them, empty if nothing is
std::string wrong_with(const Packets& sent, std::uint8_t id) {
    bool set_up = false;
    bool force = false;  // a torque may be on
    for (const auto& packet : sent) {
        if (packet.empty()) {  // the board lost its power
            set_up = force = false;
            continue;
        }
        if (packet.size() < 2 || packet[1] != id) {
            return "a packet for another id, or cut";
        }
        const std::size_t whole = packet[0] == 0 ? 2 : packet[0] == 1 ? 26 : 10;
        if (packet[0] > 2 || packet.size() != whole) {
            return "not a whole packet";
        }
        if (packet[0] == 0) {
            if (force) {
                return "a reset while a torque may be on";
            }
            set_up = false;
        } else if (packet[0] == 1) {
            set_up = true;
        } else if (!set_up) {
            return "an exchange before the set-up";
        } else {
            force = !is_zero_torque(packet);
            for (std::size_t at : {2U, 6U}) {
                const float torque = wire_float(std::span(packet).subspan(at).first<4>());
                if (!(std::fabs(torque) <= 0.12300001F)) {
                    return "a torque that is not finite, or too much";
                }
            }
        }
    }
    return {};
}

/// The last five packets are zero torque.
bool ends_in_silence(const Packets& sent) {
    return sent.size() >= 5 && std::all_of(sent.end() - 5, sent.end(), is_zero_torque);
}

}  // namespace

TEST_CASE("HIP is where the handle is, to half a count, for every machine and place",
          "[haply][law]") {
    const char* preset = GENERATE("gen3", "gen2", "haplet");
    Bench bench(emulated_calibration(preset));
    bench.open();
    Random random(5);
    int reached = 0;
    for (int i = 0; i < 500; ++i) {
        const Vec2 hip{random.in(-0.035, 0.035), random.in(0.0, 0.060)};
        if (!bench.pantograph.reach(hip)) {
            continue;
        }
        ++reached;
        bench.plant.lead(hip);
        bench.tick({});
        const Reading reading = bench.tick({});
        REQUIRE(reading.ok());
        CHECK(reading.fresh);
        // Both ends of the way count from home, which is rounded as well: one count and a little.
        const JointAngles truth = bench.plant.angles();
        const JointAngles read = bench.pantograph.angles(reading.counts);
        const double count = 2.0 * M_PI / bench.machine.pantograph.axes[0].counts_per_turn;
        const double turn = 2.0 * M_PI;
        CHECK(std::fabs(std::remainder(read[0] - truth[0], turn)) <= 1.51 * count);
        CHECK(std::fabs(std::remainder(read[1] - truth[1], turn)) <= 1.51 * count);
        const auto fix = bench.pantograph.locate(read);
        REQUIRE(fix);
        CHECK(glm::length(fix->hip - reading.hip) < 1e-12);
        CHECK(glm::length(reading.hip - hip) < 3e-4);
    }
    CHECK(reached > 400);
}

TEST_CASE("after the set-up HIP is home", "[haply]") {
    Bench bench;
    bench.plant.lead({0.013, 0.027});  // wherever it was: counts start at the set-up
    bench.open();
    CHECK(glm::length(bench.tick({}).hip - *bench.machine.home) < 1e-4);
    CHECK(bench.device->trouble().empty());
    CHECK(bench.board.journal().setups == 1);
    CHECK(bench.device->traits().delay_ticks == 1.0);
}

TEST_CASE("the motors get the torques of the force, each at its own pivot", "[haply][law]") {
    const char* preset = GENERATE("gen3", "gen2", "haplet");
    Bench bench(emulated_calibration(preset));
    bench.open();
    Random random(17);
    for (int i = 0; i < 300; ++i) {
        const Vec2 hip{random.in(-0.03, 0.03), random.in(0.01, 0.055)};
        const Vec2 force = random.point(-2.0, 2.0);
        bench.plant.lead(hip);
        bench.tick({});
        const Reading reading = bench.device->read();
        const Applied applied = bench.device->write(force);
        bench.cable.pass(kPeriod);
        const auto fix = bench.pantograph.locate(bench.pantograph.angles(reading.counts));
        REQUIRE(fix);
        // J^T F, both scaled alike into 0.123 N m, cut to 12 bits.
        Vec2 wanted = fix->jacobian.transposed(force);
        const double most = std::max(std::fabs(wanted.x), std::fabs(wanted.y)) / kHaplyTorque;
        wanted /= std::max(most, 1.0);
        const double step = kHaplyTorque / 4095.0;
        CHECK(std::fabs(bench.board.torque().x - wanted.x) <= 1.001 * step);
        CHECK(std::fabs(bench.board.torque().y - wanted.y) <= 1.001 * step);
        CHECK(applied.saturated == (most > 1.0));
        CHECK(std::fabs(applied.codes[0] * step - wanted.x) <= 0.51 * step);
        CHECK(std::fabs(applied.load.y - std::fabs(wanted.y) / (0.5 * kHaplyTorque)) < 1e-12);
    }
}

TEST_CASE("no torque is sent before the board answered, and none that is not finite",
          "[haply][law]") {
    Bench bench;
    bench.board.set_faults({.silent = true});
    CHECK_THROWS_WITH(bench.open(), ContainsSubstring("does not answer"));
    for (const auto& packet : bench.cable.sent()) {
        CHECK((packet[0] != 2 || is_zero_torque(packet)));
    }
    bench.board.set_faults({});
    bench.open();
    bench.ticks({0.5, 0.5}, 5);
    CHECK_FALSE(bench.board.torque() == Vec2{});
    const double bad =
        GENERATE(std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity());
    bench.tick({bad, 0.1});
    CHECK(bench.board.torque() == Vec2{});
    CHECK(bench.board.journal().undefined_duty == 0);
}

TEST_CASE("every way out ends with zero torque five times", "[haply][law]") {
    Bench bench;
    bench.open();
    bench.ticks({0.5, -0.4}, 20);
    REQUIRE_FALSE(bench.board.torque() == Vec2{});
    SECTION("the destructor") {}
    SECTION("an exception") {
        try {
            auto device = std::move(bench.device);
            throw std::runtime_error("the disk is full");
        } catch (const std::runtime_error&) {
        }
    }
    SECTION("silence, then the destructor") {
        bench.board.set_faults({.silent = true});
        bench.ticks({0.5, -0.4}, 50);
    }
    SECTION("garbage, then the destructor") {
        bench.board.set_faults({.noise = {9, 9, 9}});
        bench.ticks({0.5, -0.4}, 50);
    }
    SECTION("half a packet, then the destructor") {
        bench.cable.cut_next(static_cast<std::size_t>(GENERATE(0, 1, 2, 5, 7, 9)));
        bench.ticks({0.5, -0.4}, 1);
    }
    SECTION("a reconnection") {
        bench.board.set_faults({.wrong_id = true});
        bench.ticks({0.5, -0.4}, 5);
        bench.board.set_faults({});
        CHECK(bench.device->reconnect());
    }
    const bool away = bench.device == nullptr;
    bench.device.reset();
    CHECK(ends_in_silence(bench.cable.sent()));
    CHECK(bench.board.torque() == Vec2{});
    CHECK((away || bench.guard.releases > 0));
}

TEST_CASE("a late answer is no fault but not fresh, and one that stays away is", "[haply][law]") {
    Bench bench;
    bench.open();
    bench.ticks({0.1, 0.0}, 10);
    bench.board.set_faults({.delay = 3.2e-3});
    const int exchanges = bench.board.journal().exchanges;
    int fresh = 0;
    for (int i = 0; i < 400; ++i) {
        const Reading reading = bench.tick({0.1, 0.0});
        REQUIRE(reading.ok());
        fresh += reading.fresh ? 1 : 0;
    }
    CHECK(fresh > 80);
    CHECK(fresh < 140);
    CHECK(bench.board.journal().exchanges - exchanges <= fresh + 2);  // one question at a time
    CHECK_FALSE(bench.board.torque() == Vec2{});

    bench.board.set_faults({.silent = true});
    Reading reading;
    int ticks = 0;
    while (reading.ok() && ticks < 100) {
        reading = bench.tick({0.1, 0.0});
        ++ticks;
    }
    CHECK(reading.fault == DeviceFault::silent);
    CHECK(ticks >= 18);
    CHECK(ticks <= 26);
    bench.ticks({0.1, 0.0}, 10);
    CHECK(bench.board.torque() == Vec2{});
}

TEST_CASE("an answer in pieces is put together", "[haply][law]") {
    Bench bench;
    bench.open();
    const int at_once = GENERATE(0, 1, 2, 5, 8);
    bench.board.set_faults({.at_once = at_once, .rest_delay = 1.1e-3});
    Random random(23);
    int fresh = 0;
    for (int i = 0; i < 300; ++i) {
        bench.plant.lead({random.in(-0.02, 0.02), 0.05});
        const Reading reading = bench.tick({0.1, 0.1});
        REQUIRE(reading.ok());
        fresh += reading.fresh ? 1 : 0;
    }
    CHECK(fresh > 90);
    bench.board.set_faults({});
    bench.ticks({}, 5);
    CHECK(glm::length(bench.tick({}).hip - bench.pantograph.locate(bench.plant.angles())->hip) <
          3e-4);
}

TEST_CASE("an impossible answer latches a fault, zeroes the motors, and a reconnection mends it",
          "[haply][law]") {
    Bench bench;
    bench.open();
    bench.ticks({0.3, 0.3}, 10);
    bench.plant.lead({0.02, 0.04});
    bench.ticks({0.3, 0.3}, 3);
    BoardFaults faults;
    SECTION("wrong id") {
        faults.wrong_id = true;
    }
    SECTION("not a number") {
        faults.not_finite = true;
    }
    SECTION("noise before the answer") {
        faults.noise = {7};
    }
    SECTION("an answer too many") {
        faults.noise = {5, 0, 0, 0, 0, 0, 0, 0, 0};
    }
    bench.board.set_faults(faults);
    const Reading bad = bench.ticks({0.3, 0.3}, 3);
    CHECK(bad.fault == DeviceFault::garbage);
    CHECK(bench.board.torque() == Vec2{});
    bench.board.set_faults({});
    CHECK(bench.ticks({0.3, 0.3}, 50).fault == DeviceFault::garbage);
    CHECK(bench.board.torque() == Vec2{});

    CHECK(bench.device->reconnect());
    CHECK(bench.device->trouble().empty());
    CHECK(bench.board.journal().setups == 1);  // the counts are still good
    const Reading good = bench.tick({0.3, 0.3});
    CHECK(good.ok());
    CHECK(glm::length(good.hip - Vec2{0.02, 0.04}) < 3e-4);
    CHECK_FALSE(bench.board.torque() == Vec2{});
}

TEST_CASE("unplugged and plugged in again it asks for the handle at home, then goes on",
          "[haply][law]") {
    Bench bench;
    bench.open({.still = 0.5});
    bench.ticks({0.3, 0.3}, 10);
    bench.cable.plug(false);
    CHECK(bench.ticks({0.3, 0.3}, 3).fault == DeviceFault::lost);
    CHECK_FALSE(bench.device->reconnect());
    CHECK_FALSE(bench.device->trouble().empty());
    bench.cable.plug(true);
    bench.plant.lead({0.02, 0.03});
    CHECK_FALSE(bench.device->reconnect());
    CHECK_THAT(bench.device->trouble(),
               ContainsSubstring("put the handle at its home pose (0, 60) mm"));
    CHECK(bench.tick({0.3, 0.3}).fault == DeviceFault::lost);  // still latched
    CHECK(bench.board.torque() == Vec2{});

    bench.plant.lead(*bench.machine.home);
    CHECK(bench.device->reconnect());
    CHECK(bench.device->trouble().empty());
    bench.plant.lead({-0.01, 0.05});
    const Reading reading = bench.tick({0.3, 0.3});
    CHECK(reading.ok());
    CHECK(glm::length(reading.hip - Vec2{-0.01, 0.05}) < 3e-4);
    CHECK_FALSE(bench.board.torque() == Vec2{});
    bench.device.reset();
    CHECK(wrong_with(bench.cable.sent(), 5) == "");
}

TEST_CASE("a handle that moves is not taken for one at home", "[haply]") {
    Bench bench;
    bench.open();
    bench.cable.plug(false);
    bench.ticks({}, 2);
    bench.cable.plug(true);
    CHECK_FALSE(bench.device->reconnect());
    bench.plant.begin({.start = {0.0, 0.06}});  // the hand explores
    for (int i = 0; i < 3; ++i) {
        CHECK_FALSE(bench.device->reconnect());
    }
}

TEST_CASE("the first reading after a rest is not one from before it", "[haply][law]") {
    Bench bench;
    bench.open();
    bench.ticks({}, 10);
    bench.plant.lead({0.03, 0.02});
    SECTION("a long one") {
        bench.cable.pass(3'000'000'000);
    }
    SECTION("a short one, and the handle was moved") {
        bench.device->expect_move();
    }
    const Reading reading = bench.tick({});
    CHECK(reading.fresh);
    CHECK(glm::length(reading.hip - Vec2{0.03, 0.02}) < 3e-4);
}

TEST_CASE("without a guard there is no force, and one that was started again gives it back",
          "[haply][law]") {
    Bench bench;
    bench.open();
    bench.ticks({0.3, 0.3}, 5);
    CHECK(bench.guard.force);
    DeviceFault expected = DeviceFault::unguarded;
    SECTION("it died") {
        bench.guard.alive = false;
    }
    SECTION("it took the driver for hung") {
        bench.guard.tripped = true;
        expected = DeviceFault::silent;
    }
    SECTION("it died between read and write") {
        static_cast<void>(bench.device->read());
        bench.guard.alive = false;
        bench.device->write({0.3, 0.3});
        bench.cable.pass(kPeriod);
        CHECK(bench.board.torque() == Vec2{});
    }
    CHECK(bench.ticks({0.3, 0.3}, 3).fault == expected);
    CHECK(bench.board.torque() == Vec2{});
    CHECK_FALSE(bench.guard.force);
    CHECK(bench.device->reconnect());
    CHECK(bench.tick({0.3, 0.3}).ok());
    CHECK_FALSE(bench.board.torque() == Vec2{});
    bench.guard.there = false;
    bench.device.reset();
    CHECK_THROWS_WITH(bench.open(), ContainsSubstring("no guard process"));
}

TEST_CASE("a pose that the linkage cannot have gives a fault and no force, and passes", "[haply]") {
    Calibration machine = emulated_calibration();
    machine.pantograph.linkage.free_1 = machine.pantograph.linkage.free_2 = 0.060;
    machine.home = Vec2{0.0, 0.0};
    Bench bench(machine);
    bench.open();
    bench.ticks({0.3, 0.3}, 5);
    // The encoder of pivot 1 is off by so much that the free links could not reach each other.
    const JointAngles held = bench.plant.angles();
    double off = 0.0;
    while (off < 360.0 && bench.pantograph.locate({held[0] + off * M_PI / 180.0, held[1]})) {
        off += 10.0;
    }
    REQUIRE(off < 360.0);
    bench.board.set_faults({.turned_deg = off + 5.0});
    const Reading bad = bench.ticks({0.3, 0.3}, 3);
    CHECK(bad.fault == DeviceFault::unreachable);
    CHECK(bench.board.torque() == Vec2{});
    bench.board.set_faults({});
    bench.ticks({0.3, 0.3}, 2);
    CHECK(bench.tick({0.3, 0.3}).ok());
}

TEST_CASE("grip is what the analogue input says", "[haply]") {
    Calibration machine = emulated_calibration();
    machine.haply->grip_pin = 56;
    Bench bench(machine);
    bench.board.set_sensor(700.0);
    bench.open();
    CHECK(bench.tick({}).grip == Grip::held);
    bench.board.set_sensor(100.0);
    bench.tick({});
    CHECK(bench.tick({}).grip == Grip::released);
    Bench without;
    without.open();
    CHECK(without.tick({}).grip == Grip::unknown);
}

TEST_CASE("a calibration that is not a Haply's, or whose home is out of reach, is refused",
          "[haply]") {
    Calibration machine = emulated_calibration();
    Bench bench;
    bench.machine.haply.reset();
    CHECK_THROWS_WITH(bench.open(), ContainsSubstring("add [haply]"));
    bench.machine = machine;
    bench.machine.home = Vec2{0.0, 0.2};
    CHECK_THROWS_WITH(bench.open(), ContainsSubstring("does not reach its home pose (0, 200) mm"));
}

TEST_CASE("in a thousand seconds of random faults the driver never sends what it must not",
          "[haply][law]") {
    const auto seed = static_cast<std::uint64_t>(GENERATE(range(0, 100)));
    CAPTURE(seed);
    Random random(seed);
    Bench bench;
    bench.open({.still = 0.05});
    int faults = 0;
    for (int i = 0; i < 10'000;) {
        const int span = 1 + random.below(200);
        BoardFaults wild;
        switch (random.below(9)) {
            case 0:
                wild.silent = true;
                break;
            case 1:
                wild.delay = random.decade(-4.0, -1.5);
                break;
            case 2:
                wild.at_once = random.below(9);
                wild.rest_delay = random.coin() ? 1e9 : random.decade(-4.0, -1.5);
                break;
            case 3:
                for (int k = random.below(20); k >= 0; --k) {
                    wild.noise.push_back(static_cast<std::uint8_t>(random.below(256)));
                }
                break;
            case 4:
                wild.wrong_id = true;
                break;
            case 5:
                wild.not_finite = true;
                break;
            case 6:
                bench.cable.plug(random.coin());
                break;
            case 7:
                bench.guard.alive = random.coin();
                bench.guard.tripped = random.coin();
                break;
            default:
                break;
        }
        bench.board.set_faults(wild);
        for (int k = 0; k < span; ++k, ++i) {
            const Vec2 force = random.below(50) == 0
                                 ? Vec2{std::numeric_limits<double>::quiet_NaN(), 1.0}
                                 : random.point(-3.0, 3.0);
            const bool bad = !bench.tick(force).ok();
            faults += bad ? 1 : 0;
            if (bad && random.below(20) == 0) {
                bench.guard.tripped = false;
                static_cast<void>(bench.device->reconnect());
            }
        }
    }
    CHECK(faults > 0);
    const bool in = random.coin();
    bench.cable.plug(in);
    bench.board.set_faults({});
    bench.device.reset();
    const Packets& sent = bench.cable.sent();
    CHECK(wrong_with(sent, 5) == "");
    CHECK(bench.board.torque() == Vec2{});
    CHECK(bench.board.journal().undefined_duty == 0);
    CHECK(bench.board.journal().id_0 == 0);
    CHECK(bench.board.journal().unknown == 0);
    CHECK(bench.board.journal().missing == 0);
}
