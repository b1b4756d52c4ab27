#include <cmath>
#include <limits>

#include "tests/support/catch.hpp"
#include "tests/support/haply_bench.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;
using namespace palpate::tests;
using Catch::Matchers::ContainsSubstring;

TEST_CASE("every way out ends with zero torque five times", "[haply][law]") {
    HaplyBench bench;
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

TEST_CASE("an answer on its way at a rest is never taken for another: no garbage, no old reading",
          "[haply][law]") {
    const auto seed = GENERATE(range(0U, 60U));
    CAPTURE(seed);
    Random random(seed);
    HaplyBench bench;
    bench.open();
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
            CHECK((!reading.fresh || glm::length(reading.hip - hip) < 3e-4));
        } else {
            REQUIRE(bench.ticks({}, random.below(5)).ok());
        }
    }
    CHECK(asked_anew > 10);
}

TEST_CASE("a late answer is no fault but not fresh, and one that stays away is", "[haply][law]") {
    HaplyBench bench;
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
    CHECK(bench.board.torque() == Vec2{});
}

TEST_CASE("an answer in pieces is put together", "[haply][law]") {
    HaplyBench bench;
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
    HaplyBench bench;
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
    HaplyBench bench;
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

TEST_CASE("without a guard there is no force, and one that was started again gives it back",
          "[haply][law]") {
    HaplyBench bench;
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
        bench.cable.pass(kPeriodNs);
        CHECK(bench.board.torque() == Vec2{});
    }
    CHECK(bench.ticks({0.3, 0.3}, 3).fault == expected);
    CHECK_THAT(
        bench.device->trouble(),  // at once, not only after a reconnection in vain
        ContainsSubstring(expected == DeviceFault::silent ? "stopped answering" : "guard process"));
    CHECK(bench.board.torque() == Vec2{});
    CHECK_FALSE(bench.guard.force);
    CHECK(bench.device->reconnect());
    CHECK(bench.tick({0.3, 0.3}).ok());
    CHECK_FALSE(bench.board.torque() == Vec2{});
    bench.guard.there = false;
    bench.device.reset();
    CHECK_THROWS_WITH(bench.open(), ContainsSubstring("no guard process"));
}

TEST_CASE("in a thousand seconds of random faults the driver never sends what it must not",
          "[haply][law]") {
    const auto seed = static_cast<std::uint64_t>(GENERATE(range(0, 100)));
    CAPTURE(seed);
    Random random(seed);
    HaplyBench bench;
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
    CHECK(bench.board.journal().hot_resets == 0);
}

TEST_CASE("packets that go out cut never leave a torque on, nor a rule broken", "[haply][law]") {
    const auto seed = static_cast<std::uint64_t>(GENERATE(range(0, 200)));
    CAPTURE(seed);
    Random random(seed);
    HaplyBench bench;
    bench.open({.still = 0.05});
    for (int i = 0; i < 20; ++i) {
        bench.ticks(random.point(-3.0, 3.0), 1 + random.below(20));
        bench.cable.cut_next(static_cast<std::size_t>(random.below(26)));
        if (random.coin()) {
            bench.ticks(random.point(-3.0, 3.0), 1 + random.below(3));
        }
        for (int k = random.below(4); k > 0 && !bench.device->reconnect(); --k) {
        }
    }
    bench.device.reset();
    CHECK(wrong_with(bench.cable.sent(), 5) == "");
    CHECK(ends_in_silence(bench.cable.sent()));
    CHECK(bench.board.torque() == Vec2{});
    CHECK(bench.board.journal().hot_resets == 0);
}

TEST_CASE("zero torque is sent though an answer is still due", "[haply][law]") {
    HaplyBench bench;
    bench.open();
    bench.ticks({0.3, 0.3}, 3);
    bench.board.set_faults({.delay = 10e-3});
    bench.ticks({0.3, 0.3}, 3);
    REQUIRE_FALSE(bench.board.torque() == Vec2{});
    bench.tick({});
    CHECK(bench.board.torque() == Vec2{});
    const double bad = std::numeric_limits<double>::quiet_NaN();
    bench.ticks({0.3, 0.3}, 30);
    REQUIRE_FALSE(bench.board.torque() == Vec2{});
    bench.tick({bad, bad});
    CHECK(bench.board.torque() == Vec2{});
}

TEST_CASE("what answers but is no Haply board is refused as that", "[haply]") {
    HaplyBench bench;
    bench.board.set_faults({.wrong_id = true});
    CHECK_THROWS_WITH(bench.open(), ContainsSubstring("not as a Haply board with id 5"));
    CHECK(bench.board.torque() == Vec2{});
}

TEST_CASE("a board that took a packet for a reset is at zero within 50 ms, whoever saw it first",
          "[haply][law]") {
    const bool seen_by_driver = GENERATE(true, false);
    HaplyBench bench;
    bench.open({.still = 0.05});
    bench.ticks({0.4, -0.5}, 20);
    bench.cable.spoil_next(2);
    const std::int64_t cause = bench.cable.now_ns();
    bench.tick({0.4, -0.5});
    REQUIRE(bench.board.journal().resets > 0);
    if (seen_by_driver) {  // the id alone is no part of an answer, nor garbage only once there are nine
        Reading reading;
        int ticks = 0;
        for (; reading.ok() && ticks < 40; ++ticks) {
            reading = bench.tick(ticks < 10 ? Vec2{0.4, -0.5} : Vec2{});  // as the chain does
        }
        CHECK(reading.fault == DeviceFault::garbage);
        CHECK(ticks <= 15);
    }
    REQUIRE_FALSE(bench.board.torque() == Vec2{});  // zeros alone do not reach the motors
    CHECK(bench.device->prove_zero());
    CHECK(bench.board.torque() == Vec2{});
    CHECK(bench.board.zero_since() - 1e-9 * static_cast<double>(cause) < 0.050);
    CHECK(bench.device->read().fault == DeviceFault::garbage);
    CHECK(bench.device->reconnect());  // the handle rests where it is: at home
    CHECK(bench.tick({0.3, 0.0}).ok());
}

TEST_CASE("zero is proved in 50 ms on a sound board, and never said of one that does not answer",
          "[haply][law]") {
    HaplyBench bench;
    bench.open();
    bench.ticks({0.4, -0.5}, 20);
    const std::int64_t before = bench.cable.now_ns();
    SECTION("sound: its counts stay") {
        CHECK(bench.device->prove_zero());
        CHECK(bench.cable.now_ns() - before < 50'000'000);
        CHECK(bench.board.torque() == Vec2{});
        CHECK(bench.tick({0.3, 0.0}).ok());
        CHECK(bench.board.journal().setups == 1);
    }
    SECTION("mute: a fault, and zeros all the same") {
        bench.board.set_faults({.silent = true});
        CHECK_FALSE(bench.device->prove_zero());
        CHECK(bench.board.torque() == Vec2{});
        CHECK(bench.device->read().fault == DeviceFault::silent);
        CHECK_FALSE(bench.device->reconnect());
    }
    SECTION("unplugged") {
        bench.cable.plug(false);
        CHECK_FALSE(bench.device->prove_zero());
        CHECK(bench.device->read().fault != DeviceFault::none);
    }
}

TEST_CASE("whoever else speaks to the board while nobody ticks is answered with zero at once",
          "[haply][law]") {
    HaplyBench bench;
    bench.open();
    bench.ticks({0.4, -0.5}, 20);
    CHECK(bench.device->prove_zero());
    CHECK(bench.guard.repeats);
    const HaplyPacket foreign = *torque_packet(5, {0.1, 0.1});
    int on = 0;
    for (int ms = 0; ms < 1000; ++ms) {
        if (ms % 3 == 0 && ms < 600) {
            bench.board.receive(foreign.view());
        }
        bench.cable.pass(500'000);
        bench.device->keep_off();
        bench.cable.pass(500'000);
        on += bench.board.torque() == Vec2{} ? 0 : 1;
    }
    CHECK(on == 0);
    CHECK(bench.tick({0.3, 0.0}).ok());  // and the next trial finds its own answers
    CHECK_FALSE(bench.guard.repeats);
}

TEST_CASE("no motor has a torque at a reset, whatever a program that died left behind",
          "[haply][law]") {
    const int left = GENERATE(5, 3, 9, 0);  // the id of its motors, 0: none any more
    CAPTURE(left);
    HaplyBench bench;
    HaplySetup other = haply_setup(*bench.machine.haply, bench.machine.pantograph);
    other.id = left == 0 ? std::uint8_t{5} : static_cast<std::uint8_t>(left);
    for (const HaplyPacket& packet : {setup_packet(other), *torque_packet(other.id, {0.1, -0.1})}) {
        bench.board.receive(packet.view());
        bench.cable.pass(5'000'000);
    }
    if (left == 0) {
        bench.board.receive(reset_packet(5).view());
        bench.cable.pass(5'000'000);
    }
    REQUIRE_FALSE(bench.board.torque() == Vec2{});
    const int before = bench.board.journal().hot_resets;
    bench.open();
    CHECK(bench.board.torque() == Vec2{});
    // Which of 255 ids somebody else gave it is not known: such a one is zeroed behind the reset.
    CHECK(bench.board.journal().hot_resets == before + (left == 9 ? 1 : 0));
    CHECK(bench.board.zero_since() < 0.040);
}

namespace {

/// A line that brings back what a board with these counts would, with one bit wrong.
class Spoilt : public ByteLink {
public:
    std::array<std::uint8_t, 9> answer{5};
    bool send(std::span<const std::uint8_t> /*packet*/) noexcept override {
        left_ = true;
        return true;
    }
    std::ptrdiff_t receive(std::span<std::uint8_t> into, std::int64_t /*wait*/) noexcept override {
        if (!std::exchange(left_, false)) {
            return 0;
        }
        std::copy(answer.begin(), answer.end(), into.begin());
        return static_cast<std::ptrdiff_t>(answer.size());
    }
    void drain() noexcept override { left_ = false; }
    void pause(std::int64_t ns) noexcept override { now_ += ns; }
    std::int64_t now_ns() const noexcept override { return now_; }
    bool reopen() override { return true; }
    void close() noexcept override {}
    std::string trouble() const override { return {}; }
    std::string name() const override { return "a spoilt line"; }

private:
    bool left_ = false;
    std::int64_t now_ = 0;
};

}  // namespace

TEST_CASE("an angle that is no whole count is refused: of flipped bits nearly all that matter",
          "[haply][law]") {
    Random random(41);
    int flips = 0;
    int refused = 0;
    int harmless = 0;  // the same counts all the same
    for (const char* name : {"gen3", "gen2", "haplet"}) {
        const Calibration machine = emulated_calibration(name);
        Spoilt link;
        HaplyWiring wiring = *machine.haply;
        wiring.id = 5;
        HaplyLine line(link, wiring, machine.pantograph);
        const auto resolution = haply_setup(wiring, machine.pantograph).counts_per_turn;
        const auto spell = [&](const std::array<int, 2>& counts) {
            for (std::size_t i = 0; i < 2; ++i) {
                const auto four = wire_bytes(static_cast<float>(360.0 * counts[i] / resolution[i]));
                std::copy(four.begin(), four.end(),
                          link.answer.begin() + 1 + 4 * static_cast<int>(i));
            }
        };
        spell({0, 0});
        REQUIRE(line.set_up() == BoardLine::Answer::complete);
        for (int i = 0; i < 300; ++i) {
            spell({random.below(4000) - 2000, random.below(4000) - 2000});
            REQUIRE(line.probe(1) == BoardLine::Answer::complete);  // a sound one is taken
            const auto sound = line.reply().counts;
            for (std::size_t bit = 0; bit < 72; ++bit) {
                link.answer[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
                const bool taken = line.probe(1) == BoardLine::Answer::complete;
                link.answer[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
                ++flips;
                refused += taken ? 0 : 1;
                harmless += taken && line.reply().counts == sound ? 1 : 0;
                static_cast<void>(line.probe(1));
            }
        }
    }
    CAPTURE(flips, refused, harmless);
    // What is left are the signs, 2 of 72.
    CHECK(flips - refused - harmless <= flips * 2 / 72 + flips / 500);
    CHECK(refused > flips * 9 / 10);
}
