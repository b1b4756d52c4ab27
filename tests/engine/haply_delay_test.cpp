#include "tests/support/catch.hpp"
#include "tests/support/haply_bench.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

TEST_CASE("whatever answers take, every tick has a new reading, as old as the device says",
          "[haply]") {
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
          "[haply]") {
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

TEST_CASE("each reading is as old as it says, however the board's answers come", "[haply]") {
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
          "[haply]") {
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
          "[haply]") {
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
          "[haply]") {
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

TEST_CASE("a board that took a packet for a reset is at zero within 50 ms, whoever saw it first",
          "[haply]") {
    const bool seen_by_driver = GENERATE(true, false);
    HaplyBench bench;
    bench.open({.still = 0.05});
    bench.ticks({0.4, -0.5}, 20);
    bench.cable.spoil_next(2);
    const std::int64_t cause = bench.cable.now_ns();
    bench.tick({0.4, -0.5});
    REQUIRE(bench.board.journal().resets > 0);
    // The id alone is no part of an answer, nor garbage only once there are nine.
    if (seen_by_driver) {
        Reading reading;
        int ticks = 0;
        for (; reading.ok() && ticks < 40; ++ticks) {
            reading = bench.tick(ticks < 10 ? Vec2{0.4, -0.5} : Vec2{});  // as the chain does
        }
        CHECK(reading.fault == DeviceFault::garbage);
        CHECK(ticks <= 15);
    }
    REQUIRE_FALSE(bench.board.torque() == Vec3{});  // zeros alone do not reach the motors
    CHECK(bench.device->prove_zero());
    CHECK(bench.board.torque() == Vec3{});
    CHECK(bench.board.zero_since() - 1e-9 * static_cast<double>(cause) < 0.050);
    CHECK(bench.device->read().fault == DeviceFault::garbage);
    CHECK_FALSE(bench.device->reconnect());  // it may be anywhere
    CHECK_THAT(bench.device->trouble(), Has("put the handle at its home pose (0, 60) mm"));
    CHECK(bench.device->reconnect());  // the handle rests where it is: at home
    CHECK(bench.tick({0.3, 0.0}).ok());
}

TEST_CASE("zero is proved in 50 ms on a sound board, and never said of one that does not answer",
          "[haply]") {
    OpenHaply bench({0.4, -0.5}, 20);
    const std::int64_t before = bench.cable.now_ns();
    SECTION("sound: its counts stay") {
        CHECK(bench.device->prove_zero());
        CHECK(bench.cable.now_ns() - before < 50'000'000);
        CHECK(bench.board.torque() == Vec3{});
        CHECK(bench.tick({0.3, 0.0}).ok());
        CHECK(bench.board.journal().setups == 1);
    }
    SECTION("late, as late as a board may be") {
        const double delay = GENERATE(1e-3, 4e-3, 6e-3, 9.5e-3);
        bench.board.set_faults({.delay = delay});
        bench.ticks({0.4, -0.5}, GENERATE(0, 3, 12));
        const std::int64_t from = bench.cable.now_ns();
        CHECK(bench.device->prove_zero());
        CHECK(bench.cable.now_ns() - from < 50'000'000);
        CHECK(bench.board.torque() == Vec3{});
    }
    SECTION("mute: a fault, and zeros all the same") {
        bench.board.set_faults({.silent = true});
        CHECK_FALSE(bench.device->prove_zero());
        CHECK(bench.board.torque() == Vec3{});
        CHECK(bench.device->read().fault == DeviceFault::silent);
        CHECK_THAT(bench.device->trouble(), Has("the motors are off: hands off"));
        CHECK_FALSE(bench.device->reconnect());
        CHECK_THAT(bench.device->trouble(), Has("the motors are off: hands off"));
        bench.board.set_faults({});
        for (int i = 0; i < 5 && !bench.device->reconnect(); ++i) {
            CHECK_THAT(bench.device->trouble(), !Has("hands off"));  // set up: proved
        }
        CHECK(bench.device->trouble().empty());
    }
    SECTION("unplugged") {
        bench.cable.plug(false);
        CHECK_FALSE(bench.device->prove_zero());
        CHECK(bench.device->read().fault != DeviceFault::none);
        CHECK_THAT(bench.device->trouble(), Has("switch off the motors' supply"));
    }
}

TEST_CASE("whoever else speaks to the board while nobody ticks is answered with zero at once",
          "[haply]") {
    OpenHaply bench({0.4, -0.5}, 20);
    CHECK(bench.device->prove_zero());
    CHECK(bench.guard.repeats);
    const BoardBytes foreign = *torque_packet(5, {0.1, 0.1});
    int on = 0;
    for (int ms = 0; ms < 1000; ++ms) {
        if (ms % 3 == 0 && ms < 600) {
            bench.board.receive(foreign.view());
        }
        bench.cable.pass(500'000);
        bench.device->keep_off();
        bench.cable.pass(500'000);
        on += bench.board.torque() == Vec3{} ? 0 : 1;
    }
    CHECK(on == 0);
    CHECK(bench.tick({0.3, 0.0}).ok());  // and the next trial finds its own answers
    CHECK_FALSE(bench.guard.repeats);
}

TEST_CASE("no motor has a torque at a reset, whatever a program that died left behind", "[haply]") {
    EACH(left, 5, 3, 9, 0);  // the id of its motors, 0: none any more
    HaplyBench bench;
    HaplySetup other = haply_setup(*bench.machine.haply, bench.machine.pantograph);
    other.id = left == 0 ? std::uint8_t{5} : static_cast<std::uint8_t>(left);
    for (const BoardBytes& packet : {setup_packet(other), *torque_packet(other.id, {0.1, -0.1})}) {
        bench.board.receive(packet.view());
        bench.cable.pass(5'000'000);
    }
    if (left == 0) {
        bench.board.receive(reset_packet(5).view());
        bench.cable.pass(5'000'000);
    }
    REQUIRE_FALSE(bench.board.torque() == Vec3{});
    const int before = bench.board.journal().hot_resets;
    bench.open();
    CHECK(bench.board.torque() == Vec3{});
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

TEST_CASE(
    "an angle that is no whole count is refused, which of flipped bits leaves signs and powers of "
    "two",
    "[haply]") {
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
                static_cast<void>(line.silence());  // what was kept of it is forgotten
            }
        }
    }
    CAPTURE(flips, refused, harmless);
    // What is left are signs, 2 of 72, and twice or half a count that is whole again: 9.5 % seen,
    // as jumps.
    CHECK(flips - refused - harmless <= flips / 10);
    CHECK(refused > flips * 8 / 10);
}
