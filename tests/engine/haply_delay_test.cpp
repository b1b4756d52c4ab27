#include "tests/support/catch.hpp"
#include "tests/support/haply_bench.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

TEST_CASE("whatever answers take, every tick has a new reading, as old as the device says",
          "[haply][law]") {
    EACH(trip, 0.0, 0.3e-3, 0.8e-3, 1.1e-3, 2.1e-3, 4.6e-3, 9.2e-3);
    Random random(29);
    HaplyBench bench;
    bench.board.set_faults({.delay = trip});
    bench.open();
    const DeviceTraits traits = bench.device->traits();
    CHECK(traits.round_trip >= trip);
    CHECK(traits.round_trip <= trip + 0.15e-3);  // two polls of the board, one of the link
    CHECK(traits.delay_ticks == std::ceil(traits.round_trip / 1e-3));
    const auto behind = static_cast<std::size_t>(traits.delay_ticks);
    for (const double force : {0.0, 0.2}) {  // in free space and in a press
        std::vector<Vec2> led;
        int stale = 0;
        for (std::size_t k = 0; k < 300; ++k) {
            led.push_back({random.in(-0.02, 0.02), 0.05});
            bench.plant.lead(led.back());
            const Reading reading = bench.tick({force, 0.0});
            REQUIRE(reading.ok());
            if (k > 40) {  // the first ones fill the way
                stale += reading.fresh ? 0 : 1;
                CHECK(glm::length(Vec2(reading.hip) - led[k - behind]) < 3e-4);
            }
        }
        CHECK(stale == 0);
    }
    CHECK(wrong_with(bench.cable.sent(), 5) == "");
}

TEST_CASE("answers that take too long for a force are refused, at first and after a reconnection",
          "[haply][law]") {
    HaplyBench bench;
    bench.board.set_faults({.delay = 11e-3});
    CHECK_THROWS_WITH(bench.open(), Has("ms, too long for a force: use a port"));
    bench.board.set_faults({.delay = 2.5e-3});
    bench.open({.still = 0.05});
    CHECK(bench.device->traits().delay_ticks == 3.0);
    bench.cable.plug(false);
    bench.ticks({}, 3);
    bench.cable.plug(true);
    bench.board.set_faults({.delay = 3.5e-3});
    CHECK_FALSE(bench.device->reconnect());
    CHECK_THAT(bench.device->trouble(), Has("more than when the session began"));
    bench.board.set_faults({.delay = 0.0});
    for (int i = 0; i < 3 && !bench.device->reconnect(); ++i) {
    }
    CHECK(bench.device->trouble().empty());
    CHECK(bench.device->traits().delay_ticks == 3.0);
}

TEST_CASE("each reading is as old as it says, however the board's answers come", "[haply][law]") {
    SEEDED(random, 12U);
    HaplyBench bench;
    bench.board.set_faults({.delay = seed % 2 == 0 ? 0.3e-3 : 2.1e-3});
    bench.open();
    const double promised = bench.device->traits().delay_ticks;
    std::vector<Vec2> led;
    double max = 0.0;
    for (std::size_t k = 0; k < 400; ++k) {
        if (k % 50 == 49) {
            bench.board.set_faults({.delay = random.in(0.0, 6e-3)});
        }
        led.push_back({random.in(-0.02, 0.02), 0.05});
        bench.plant.lead(led.back());
        const Reading reading = bench.tick({0.2, 0.0});
        REQUIRE(reading.ok());
        max = std::fmax(max, reading.behind);
        if (k > 10) {  // one that is quicker than promised is newer
            const auto oldest = static_cast<std::size_t>(promised + reading.behind);
            double missed = 1.0;
            for (std::size_t age = reading.behind > 0.0 ? oldest : 0; age <= oldest; ++age) {
                missed = std::fmin(missed, glm::length(Vec2(reading.hip) - led[k - age]));
            }
            CHECK(missed < 3e-4);
        }
    }
    CHECK(max >= 3.0);
}

TEST_CASE("a board that was late and then gone is opened anew, and says that its place is lost",
          "[haply][law]") {
    HaplyBench bench;
    bench.board.set_faults({.delay = 0.3e-3});
    bench.open();
    bench.ticks({0.2, 0.0}, 20);
    bench.board.set_faults({.delay = 3.3e-3});
    double oldest = 0.0;
    for (int i = 0; i < 20; ++i) {
        oldest = std::fmax(oldest, bench.tick({0.2, 0.0}).behind);
    }
    REQUIRE(oldest >= 1.0);
    CHECK(bench.device->prove_zero());
    bench.cable.plug(false);  // into another port, as the advice says, while nobody ticks
    bench.board.set_faults({.delay = 0.3e-3});
    bench.cable.plug(true);
    int tries = 1;
    for (; !bench.device->reconnect() && tries < 10; ++tries) {
        bench.cable.pass(500'000'000);
    }
    CHECK(tries < 5);
    CHECK(bench.device->homings() == 1);
    CHECK(bench.tick({0.2, 0.0}).ok());
}

TEST_CASE("answers that became later in service are refused until they are quick again",
          "[haply][law]") {
    HaplyBench bench;
    bench.board.set_faults({.delay = 0.3e-3});
    bench.open();
    CHECK(bench.ticks({0.2, 0.0}, 50).behind == 0.0);
    CHECK(bench.device->reconnect());
    bench.board.set_faults({.delay = 1.6e-3});
    double sum = 0.0;
    bench.ticks({0.2, 0.0}, 50);
    for (int i = 0; i < 200; ++i) {
        sum += bench.tick({0.2, 0.0}).behind;
    }
    CHECK(sum / 200.0 == Approx(1.5).epsilon(0.05));  // every second one new, and two ticks old
    bench.ticks({}, 5);
    CHECK_FALSE(bench.device->reconnect());
    CHECK_THAT(bench.device->trouble(), Has("more than when the session began"));
    bench.board.set_faults({.delay = 0.3e-3});
    CHECK(bench.device->reconnect());
    CHECK(bench.device->trouble().empty());
    CHECK(bench.ticks({0.2, 0.0}, 20).behind == 0.0);
}

TEST_CASE("a board that failed is not back before its answers are as quick as they were",
          "[haply][law]") {
    const bool silent = GENERATE(true, false);
    HaplyBench bench;
    bench.board.set_faults({.delay = 0.3e-3});
    bench.open();
    bench.ticks({0.2, 0.0}, 20);
    bench.board.set_faults({.silent = silent, .delay = 0.3e-3, .wrong_id = !silent});
    CHECK(bench.ticks({0.2, 0.0}, 80).fault ==
          (silent ? DeviceFault::silent : DeviceFault::garbage));
    bench.board.set_faults({.delay = 3.6e-3});
    CHECK_FALSE(bench.device->reconnect());
    CHECK_THAT(bench.device->trouble(), Has("more than when the session began"));
    CHECK_FALSE(bench.device->reconnect());
    bench.board.set_faults({.delay = 0.3e-3});
    CHECK(bench.device->reconnect());
    CHECK(bench.device->trouble().empty());
    CHECK(bench.device->homings() == 0);  // it kept its counts
    CHECK(bench.ticks({0.2, 0.0}, 20).behind == 0.0);
}
