#include "tests/support/catch.hpp"
#include "tests/support/haply_bench.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

TEST_CASE("every way out ends with zero torque five times", "[haply]") {
    OpenHaply bench({0.5, -0.4}, 20);
    REQUIRE_FALSE(bench.board.torque() == Vec3{});
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
    CHECK(bench.board.torque() == Vec3{});
    CHECK((away || bench.guard.releases > 0));
}

TEST_CASE("an answer on its way at a rest is never taken for another: no garbage, no old reading",
          "[haply]") {
    SEEDED(random, 60U);
    OpenHaply bench;
    const double delay = random.in(0.0, 9e-3);
    bench.board.set_faults({.delay = delay});
    int asked_anew = 0;
    for (int i = 0; i < 60; ++i) {
        for (int left = random.below(4); left > 0; --left) {  // nobody reads: a desk, a doctor
            static_cast<void>(bench.device->write({}));
        }
        bench.cable.pass(static_cast<std::int64_t>(random.decade(4.0, 8.5)));
        if (random.coin()) {
            const Vec2 hip{random.in(-0.03, 0.03), random.in(0.01, 0.05)};
            bench.plant.lead(hip);
            bench.device->expect_move();
            const Reading reading = bench.tick({});
            REQUIRE(reading.ok());
            asked_anew += reading.fresh ? 1 : 0;
            CHECK((!reading.fresh || glm::length(Vec2(reading.hip) - hip) < 3e-4));
        } else {
            REQUIRE(bench.ticks({}, random.below(5)).ok());
        }
    }
    CHECK(asked_anew > 10);
}

TEST_CASE("a late answer is no fault but not fresh, and one that stays away is", "[haply]") {
    OpenHaply bench({0.1, 0.0}, 10);
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
    CHECK_FALSE(bench.board.torque() == Vec3{});

    bench.board.set_faults({.silent = true});
    const double force = GENERATE(0.1, 0.0);
    Reading reading;
    int ticks = 0;
    while (reading.ok() && ticks < 100) {
        reading = bench.tick({force, 0.0});
        ++ticks;
    }
    CHECK(reading.fault == DeviceFault::silent);
    CHECK(ticks >= 38);
    CHECK(ticks <= 46);
    bench.ticks({0.1, 0.0}, 10);
    CHECK(bench.board.torque() == Vec3{});
}

TEST_CASE("an answer in pieces is put together", "[haply]") {
    OpenHaply bench;
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
    CHECK(glm::length(Vec2(bench.tick({}).hip) -
                      bench.pantograph.locate(bench.plant.angles())->hip) < 3e-4);
}

TEST_CASE("an impossible answer latches a fault, zeroes the motors, and a reconnection mends it",
          "[haply]") {
    OpenHaply bench({0.3, 0.3}, 10);
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
    CHECK(bench.board.torque() == Vec3{});
    bench.board.set_faults({});
    CHECK(bench.ticks({0.3, 0.3}, 50).fault == DeviceFault::garbage);
    CHECK(bench.board.torque() == Vec3{});

    CHECK(bench.device->reconnect());
    CHECK(bench.device->trouble().empty());
    CHECK(bench.board.journal().setups == 1);  // the counts are still good
    const Reading good = bench.tick({0.3, 0.3});
    CHECK(good.ok());
    CHECK(glm::length(Vec2(good.hip) - Vec2{0.02, 0.04}) < 3e-4);
    CHECK_FALSE(bench.board.torque() == Vec3{});
}

TEST_CASE("unplugged and plugged in again it asks for the handle at home, then goes on",
          "[haply]") {
    HaplyBench bench;
    bench.open({.still = 0.5});
    bench.ticks({0.3, 0.3}, 10);
    bench.cable.plug(false);
    CHECK(bench.ticks({0.3, 0.3}, 3).fault == DeviceFault::lost);
    CHECK_FALSE(bench.device->reconnect());
    CHECK_FALSE(bench.device->trouble().empty());
    bench.cable.plug(true);
    bench.plant.lead({0.02, 0.03});
    CHECK_FALSE(bench.device->reconnect());
    CHECK_THAT(bench.device->trouble(), Has("put the handle at its home pose (0, 60) mm"));
    CHECK(bench.tick({0.3, 0.3}).fault == DeviceFault::lost);  // still latched
    CHECK(bench.board.torque() == Vec3{});

    bench.plant.lead(*bench.machine.home);
    CHECK(bench.device->reconnect());
    CHECK(bench.device->trouble().empty());
    bench.plant.lead({-0.01, 0.05});
    const Reading reading = bench.tick({0.3, 0.3});
    CHECK(reading.ok());
    CHECK(glm::length(Vec2(reading.hip) - Vec2{-0.01, 0.05}) < 3e-4);
    CHECK_FALSE(bench.board.torque() == Vec3{});
    bench.device.reset();
    CHECK(wrong_with(bench.cable.sent(), 5) == "");
}

TEST_CASE("a handle that moves is not taken for one at home", "[haply]") {
    OpenHaply bench;
    bench.cable.plug(false);
    bench.ticks({}, 2);
    bench.cable.plug(true);
    CHECK_FALSE(bench.device->reconnect());
    bench.plant.begin({.start = {0.0, 0.06}});  // the hand explores
    for (int i = 0; i < 3; ++i) {
        CHECK_FALSE(bench.device->reconnect());
    }
}

TEST_CASE("without a guard there is no force, and one that was started again gives it back",
          "[haply]") {
    OpenHaply bench({0.3, 0.3}, 5);
    CHECK(bench.guard.force);
    DeviceFault expected = DeviceFault::unguarded;
    SECTION("it died") {
        bench.guard.alive = false;
    }
    SECTION("it took the driver for hung") {
        bench.guard.tripped = true;
        expected = DeviceFault::held;
    }
    SECTION("it died between read and write") {
        static_cast<void>(bench.device->read());
        bench.guard.alive = false;
        bench.device->write({0.3, 0.3, 0.0});
        bench.cable.pass(kPeriodNs);
        CHECK(bench.board.torque() == Vec3{});
    }
    CHECK(bench.ticks({0.3, 0.3}, 3).fault == expected);
    CHECK_THAT(bench.device->trouble(),  // at once, not only after a reconnection in vain
               Has(expected == DeviceFault::held ? "palpate stood still" : "guard process"));
    CHECK(bench.board.torque() == Vec3{});
    CHECK_FALSE(bench.guard.force);
    CHECK(bench.device->reconnect());
    CHECK(bench.tick({0.3, 0.3}).ok());
    CHECK_FALSE(bench.board.torque() == Vec3{});
    bench.guard.there = false;
    bench.device.reset();
    CHECK_THROWS_WITH(bench.open(), Has("no guard process"));
}

TEST_CASE("a board that lost its place in a hang asks for home first, and costs one fault",
          "[haply]") {
    HaplyBench bench;
    bench.open({.still = 0.5});
    bench.ticks({0.3, 0.3}, 10);
    const bool hung = GENERATE(true, false);
    hung ? bench.guard.tripped = true : bench.guard.alive = false;
    CHECK(bench.ticks({0.3, 0.3}, 3).fault == (hung ? DeviceFault::held : DeviceFault::unguarded));
    bench.board.power_cycle();
    bench.plant.lead({0.02, 0.03});
    CHECK(bench.device->prove_zero());
    CHECK_FALSE(bench.device->reconnect());  // it rests, but nobody put it there
    CHECK_THAT(bench.device->trouble(), Has("put the handle at its home pose (0, 60) mm"));
    bench.plant.lead(*bench.machine.home);
    CHECK(bench.device->reconnect());
    CHECK(bench.device->homings() == 1);
    bench.plant.lead({-0.01, 0.05});
    const Reading reading = bench.ticks({0.3, 0.3}, 5);
    CHECK(reading.ok());
    CHECK(glm::length(Vec2(reading.hip) - Vec2{-0.01, 0.05}) < 3e-4);
    CHECK_FALSE(bench.board.torque() == Vec3{});
}

TEST_CASE("in five minutes of random faults the driver never sends what it must not", "[haply]") {
    SEEDED(random, std::uint64_t{30});
    HaplyBench bench;
    bench.open({.still = 0.05});
    int faults = 0;
    for (int i = 0; i < 10'000;) {
        const int span = 1 + random.below(200);
        BoardFaults wild;
        const std::function<void()> befalls[]{
            [] {},
            [&] { wild.silent = true; },
            [&] { wild.delay = random.decade(-4.0, -1.5); },
            [&] {
                wild.at_once = random.below(9);
                wild.rest_delay = random.coin() ? 1e9 : random.decade(-4.0, -1.5);
            },
            [&] {
                for (int k = random.below(20); k >= 0; --k) {
                    wild.noise.push_back(static_cast<std::uint8_t>(random.below(256)));
                }
            },
            [&] { wild.wrong_id = true; },
            [&] { wild.not_finite = true; },
            [&] { bench.cable.plug(random.coin()); },
            [&] {
                bench.guard.alive = random.coin();
                bench.guard.tripped = random.coin();
            }};
        befalls[random.index(9)]();
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
    CHECK(bench.board.torque() == Vec3{});
    CHECK(bench.board.journal().undefined_duty == 0);
    CHECK(bench.board.journal().id_0 == 0);
    CHECK(bench.board.journal().unknown == 0);
    CHECK(bench.board.journal().missing == 0);
    CHECK(bench.board.journal().hot_resets == 0);
}

TEST_CASE("packets that go out cut never leave a torque on, nor a rule broken", "[haply]") {
    SEEDED(random, std::uint64_t{200});
    HaplyBench bench;
    bench.open({.still = 0.05});
    for (int i = 0; i < 20; ++i) {
        bench.ticks(random.point(-3.0, 3.0), 1 + random.below(20));
        bench.cable.cut_next(random.index(26));
        if (random.coin()) {
            bench.ticks(random.point(-3.0, 3.0), 1 + random.below(3));
        }
        for (int k = random.below(4); k > 0 && !bench.device->reconnect(); --k) {
        }
    }
    bench.device.reset();
    CHECK(wrong_with(bench.cable.sent(), 5) == "");
    CHECK(ends_in_silence(bench.cable.sent()));
    CHECK(bench.board.torque() == Vec3{});
    CHECK(bench.board.journal().hot_resets == 0);
}

TEST_CASE("zero torque is sent though an answer is still due", "[haply]") {
    OpenHaply bench({0.3, 0.3}, 3);
    bench.board.set_faults({.delay = 10e-3});
    bench.ticks({0.3, 0.3}, 3);
    REQUIRE_FALSE(bench.board.torque() == Vec3{});
    bench.tick({});
    CHECK(bench.board.torque() == Vec3{});
    const double bad = std::numeric_limits<double>::quiet_NaN();
    bench.ticks({0.3, 0.3}, 30);
    REQUIRE_FALSE(bench.board.torque() == Vec3{});
    bench.tick({bad, bad});
    CHECK(bench.board.torque() == Vec3{});
}

TEST_CASE("what answers but is no Haply board is refused as that", "[haply]") {
    HaplyBench bench;
    bench.board.set_faults({.wrong_id = true});
    CHECK_THROWS_WITH(bench.open(), Has("not as a Haply board with id 5"));
    CHECK(bench.board.torque() == Vec3{});
}
