#include "tests/firmware/boards.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

// What only the chip itself can show: its own watchdog, its load, its times.

#define CHIP_CASE(name) TEMPLATE_TEST_CASE(name, "[firmware][law]", On328p, On2560)

CHIP_CASE("a program that hangs has its motors off within 17 ms, whatever hangs") {
    const bool interrupts = GENERATE(false, true);
    Talk<TestType> talk;
    talk.make_ready(50);
    talk.torque(60000, 60000);
    talk.board.hang(interrupts);
    CHECK(talk.until_off(60.0) <= 17.0);
    CHECK(talk.board.torque() == Vec3{});
    talk.pass_ms(100);
    CHECK(talk.board.resets() > 0);
    CHECK_FALSE(talk.board.enabled());
}

CHIP_CASE("a torque that comes with the tick that stops the motors does not start them") {
    Talk<TestType> talk;
    talk.hello();
    int stopped = 0;
    for (int i = 0; i < 120; ++i) {  // 10 us apart, over more than a tick
        talk.config({.token = 0x1234, .watchdog_ms = 5, .limit = {123000, 123000}});
        talk.arm();
        talk.torque(60000, 60000);
        talk.pass_ms(3.0);
        const std::vector<std::uint8_t> zeros(static_cast<std::size_t>(i), 0);
        talk.send(zeros);
        talk.send(open_frame(open_torque(++talk.seq, {90000, 90000})).view());
        talk.pass_ms(2.5);
        stopped += talk.board.enabled() ? 0 : 1;
        if (!talk.board.enabled()) {
            CHECK_FALSE(talk.board.driven(0));
            CHECK_FALSE(talk.board.driven(1));
        }
        talk.disarm();
        CHECK_FALSE(talk.board.enabled());
        CHECK_FALSE(talk.board.driven(0));
    }
    CHECK(stopped > 10);
    CHECK(stopped < 110);
}

CHIP_CASE("the host's watchdog is there while the program's loop hangs") {
    Talk<TestType> talk;
    talk.make_ready(10);
    talk.torque(60000, 60000);
    talk.board.hang(true);
    CHECK(talk.until_off(60.0) <= 10.1);
    CHECK(talk.board.resets() == 0);
}

CHIP_CASE("at the fastest that encoders may turn no count, byte or answer is lost") {
    Talk<TestType> talk;
    talk.make_ready(50);
    counts_edges(talk, std::array{40000.0, -40000.0}, 200);
}

CHIP_CASE("encoders that turn too fast are reported, or the motors are off") {
    Talk<TestType> talk;
    talk.make_ready(20);
    talk.torque(60000, 60000);
    const std::array<std::int64_t, 2> before{talk.board.edges(0), talk.board.edges(1)};
    const OpenReport first = talk.peek();
    talk.board.spin(0, 100000.0);
    talk.board.spin(1, 100000.0);
    talk.pass_ms(100);
    talk.board.spin(0, kStill);
    talk.board.spin(1, kStill);
    talk.pass_ms(20);
    const OpenReport last = talk.peek();
    const bool right = last.counts[0] - first.counts[0] == talk.board.edges(0) - before[0] &&
                       last.counts[1] - first.counts[1] == talk.board.edges(1) - before[1];
    CHECK((right || (last.flags & kOpenSkippedEdge) != 0 || last.state == OpenState::boot));
    CHECK_FALSE(talk.board.enabled());
}

// Not a law: the numbers that the manual tells. palpate_test_firmware "[numbers]"
TEMPLATE_TEST_CASE("numbers of the chip", "[.][numbers]", On328p, On2560) {
    std::vector<double> watchdog;
    std::vector<double> stop;
    Random random(17);
    for (int i = 0; i < 200; ++i) {
        Talk<TestType> talk;
        talk.make_ready(20);
        talk.pass_ms(random.in(0.0, 1.0));
        talk.send(open_frame(open_torque(++talk.seq, {60000, 60000})).view());
        talk.pass_ms(0.15);
        watchdog.push_back(talk.until_off(60.0));
        Talk<TestType> other;
        other.make_ready(20);
        other.pass_ms(random.in(0.0, 1.0));
        other.board.press_stop(true);
        stop.push_back(other.until_off(60.0));
    }
    const auto ends = std::minmax_element(watchdog.begin(), watchdog.end());
    const auto stops = std::minmax_element(stop.begin(), stop.end());
    WARN("watchdog of 20 ms: " << *ends.first << " to " << *ends.second << " ms; stop: "
                               << *stops.first << " to " << *stops.second << " ms");
    for (const double speed : {0.0, 25000.0, 40000.0, 50000.0}) {
        Talk<TestType> talk;
        talk.make_ready(50);
        WARN(numbers_at(speed, talk));
    }
}
