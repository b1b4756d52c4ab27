#include "tests/firmware/boards.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

// What the open board promises, whoever runs its firmware: this machine's processor or, where
// simavr is installed, the two chips, cycle by cycle.
#if defined(PALPATE_FIRMWARE_328P)
#define BOARDS OnHost, On328p, On2560
#else
#define BOARDS OnHost
#endif
#define BOARD_CASE(name) TEMPLATE_TEST_CASE(name, "[firmware][law]", BOARDS)

namespace {

bool is_state(const std::optional<OpenAnswer>& answer, OpenState state) {
    return answer && answer->type == OpenType::state && answer->report.state == state;
}

bool is_nak(const std::optional<OpenAnswer>& answer, int why) {
    return answer && answer->type == OpenType::nak && answer->why == why;
}

constexpr OpenConfig kConfig{.token = 0x1234, .watchdog_ms = 20, .limit = {123000, 123000}};
constexpr double kStep = 123000.0 / 800.0;  // uN m

}  // namespace

BOARD_CASE("a board says what it is, and repeats its limits to the byte") {
    Talk<TestType> talk;
    CHECK(talk.peek().state == OpenState::boot);
    const auto ident = talk.hello();
    REQUIRE(ident);
    REQUIRE(ident->type == OpenType::ident);
    CHECK(ident->seq == talk.seq);
    CHECK(ident->ident.major == 1);
    CHECK(ident->ident.counts_per_turn == OpenAxes{4880, 4880});
    CHECK(ident->ident.torque_full == OpenAxes{123000, 123000});
    CHECK(ident->ident.watchdog_min == 5);
    CHECK(ident->ident.watchdog_max == 50);
    CHECK(ident->ident.state == OpenState::identified);
    const auto taken = talk.config(kConfig);
    REQUIRE(taken);
    REQUIRE(taken->type == OpenType::configured);
    CHECK(taken->config == kConfig);
    CHECK(talk.peek().state == OpenState::configured);
    CHECK_FALSE(talk.board.enabled());
}

BOARD_CASE("no state but armed has motors on, and every way between states is the table's") {
    Talk<TestType> talk;
    CHECK(is_nak(talk.config(kConfig), 2));
    CHECK(is_nak(talk.arm(), 2));
    CHECK(is_nak(talk.clear(), 2));
    CHECK(is_state(talk.disarm(), OpenState::boot));
    BoardBytes other = open_hello(9);
    other.bytes[3] = 2;  // of version 2
    other.size -= 2;
    const std::uint16_t crc = open_crc(other.view());
    other.bytes[other.size++] = static_cast<std::uint8_t>(crc);
    other.bytes[other.size++] = static_cast<std::uint8_t>(crc >> 8U);
    CHECK(is_nak(talk.ask(other), 1));
    talk.hello();
    CHECK(is_nak(talk.arm(), 2));
    for (const OpenConfig& wrong :
         {OpenConfig{.token = 0, .limit = {1, 1}}, OpenConfig{.token = 1, .watchdog_ms = 4},
          OpenConfig{.token = 1, .watchdog_ms = 51}, OpenConfig{.token = 1, .limit = {-1, 0}},
          OpenConfig{.token = 1, .limit = {0, 123001}}}) {
        CHECK(is_nak(talk.config(wrong), 3));
    }
    CHECK(talk.config(kConfig)->type == OpenType::configured);
    CHECK(is_nak(talk.arm(0x4321), 5));
    const auto refused = talk.torque(100000, 100000);
    CHECK(is_state(refused, OpenState::configured));
    CHECK((refused->report.flags & 1U << 9U) != 0);
    CHECK((talk.peek().flags & 1U << 9U) == 0);
    CHECK_FALSE(talk.board.enabled());
    CHECK(is_state(talk.arm(), OpenState::armed));
    CHECK(talk.board.enabled());
    CHECK(talk.board.torque() == Vec3{});
    CHECK(is_nak(talk.config(kConfig), 2));
    CHECK(is_nak(talk.clear(), 2));
    talk.torque(50000, -50000);
    CHECK(is_state(talk.disarm(), OpenState::configured));
    CHECK_FALSE(talk.board.enabled());
    CHECK(talk.board.torque() == Vec3{});
    CHECK(is_nak(talk.arm(), 2));  // nobody asked since
    CHECK(talk.peek().state == OpenState::configured);
    CHECK(is_state(talk.arm(), OpenState::armed));
    CHECK(talk.board.torque() == Vec3{});  // until the first torque
    talk.pass_ms(30);
    CHECK(talk.peek().state == OpenState::stopped);
    CHECK(is_nak(talk.arm(), 2));
    CHECK(is_state(talk.disarm(), OpenState::stopped));
    CHECK(is_nak(talk.clear(1), 5));
    CHECK(is_state(talk.clear(), OpenState::configured));
    const auto unknown = talk.ask(open_bare(static_cast<OpenType>(0x42), 77));
    CHECK(is_nak(unknown, 6));
    CHECK(is_nak(talk.ask(open_token(OpenType::peek, 78, 1)), 6));
}

BOARD_CASE("torques come out as asked, and never beyond the limit") {
    Talk<TestType> talk;
    talk.make_ready(50, 80000);
    obeys_torques(talk, {80000, 80000}, kStep);
}

BOARD_CASE("motors are off when no torque came for as long as was asked") {
    Talk<TestType> talk;
    const int ms = GENERATE(5, 20, 50);
    talk.make_ready(static_cast<std::uint8_t>(ms));
    for (int i = 0; i < 2 * ms; ++i) {
        REQUIRE(is_state(talk.torque(60000, 60000), OpenState::armed));
        talk.pass_ms(1);
    }
    REQUIRE(is_state(talk.torque(60000, 60000), OpenState::armed));
    const double begin = talk.board.time();
    while (talk.board.enabled() && talk.board.time() - begin < 0.1) {
        talk.peek();  // does not count
    }
    const double took = 1e3 * (talk.board.time() - begin);
    CHECK(took >= ms - 1.7);  // the torque was obeyed within its round trip
    CHECK(took <= ms + 0.7);
    CHECK(talk.board.torque() == Vec3{});
    CHECK((talk.peek().flags & kOpenWatchdog) != 0);
    CHECK(is_state(talk.torque(60000, 60000), OpenState::stopped));
    CHECK_FALSE(talk.board.enabled());
    CHECK(is_state(talk.clear(), OpenState::configured));
    CHECK((talk.peek().flags & kOpenWatchdog) == 0);
}

BOARD_CASE("the emergency stop switches off within a tick, and must be released and forgiven") {
    Talk<TestType> talk;
    talk.make_ready();
    talk.torque(60000, 60000);
    talk.board.press_stop(true);
    CHECK(talk.until_off(5.0) <= 1.05);
    OpenReport report = talk.peek();
    CHECK(report.state == OpenState::stopped);
    CHECK((report.flags & kOpenStopPressed) != 0);
    CHECK(is_nak(talk.clear(), 4));
    CHECK(talk.config(kConfig)->type == OpenType::configured);
    CHECK(is_nak(talk.arm(), 4));
    talk.board.press_stop(false);
    talk.pass_ms(2);
    report = talk.peek();
    CHECK((report.flags & kOpenStopPressed) != 0);  // somebody did press it
    CHECK(is_state(talk.clear(), OpenState::configured));
    CHECK((talk.peek().flags & kOpenStopPressed) == 0);
    CHECK(is_state(talk.arm(), OpenState::armed));
}

BOARD_CASE("a torque is obeyed only in the order of its number") {
    Talk<TestType> talk;
    const int start = GENERATE(100, 65400);
    talk.seq = static_cast<std::uint16_t>(start);
    talk.make_ready(50);
    const std::uint16_t now = talk.seq;
    const auto obeyed = [&](int step, std::int32_t torque) {
        const auto seq = static_cast<std::uint16_t>(now + step);
        const auto answer = talk.ask(open_torque(seq, {torque, 0}));
        REQUIRE(is_state(answer, OpenState::armed));
        const bool stale = (answer->report.flags & 1U << 4U) != 0;
        const bool given = std::fabs(1e6 * talk.board.torque().x - torque) <= kStep;
        CHECK(stale == !given);
        return given;
    };
    CHECK(obeyed(1, 10000));
    CHECK_FALSE(obeyed(1, 20000));
    CHECK_FALSE(obeyed(0, 20000));
    CHECK_FALSE(obeyed(-5, 20000));
    CHECK_FALSE(obeyed(257, 20000));
    CHECK(obeyed(256, 30000));
    CHECK_FALSE(obeyed(32000, 40000));
    CHECK(obeyed(257, 50000));
}

BOARD_CASE("an ARM that comes late, or again, switches nothing on") {
    Talk<TestType> talk;
    const int start = GENERATE(100, 65530);
    talk.seq = static_cast<std::uint16_t>(start);
    talk.make_ready();
    talk.disarm();
    const std::uint16_t now = talk.seq;
    const auto arm = [&](int step) {
        const auto seq = static_cast<std::uint16_t>(now + step);
        return talk.ask(open_token(OpenType::arm, seq, talk.kToken));
    };
    for (const int step : {0, 1, 2}) {  // the host may have died when its guard disarmed
        CHECK(is_nak(arm(step), 2));
    }
    talk.seq = static_cast<std::uint16_t>(now + 5);
    CHECK(talk.peek().state == OpenState::configured);  // number 6
    for (const int step : {6, 5, 2, 0, -1, -300, 262, 32000}) {
        CHECK(is_nak(arm(step), 2));
        CHECK_FALSE(talk.board.enabled());
    }
    CHECK(is_state(arm(7), OpenState::armed));
    talk.pass_ms(30);
    talk.seq = static_cast<std::uint16_t>(now + 8);
    CHECK(is_state(talk.clear(), OpenState::configured));
    for (const int step : {7, 8, 9}) {
        CHECK(is_nak(arm(step), 2));
        CHECK_FALSE(talk.board.enabled());
    }
    CHECK(is_state(arm(10), OpenState::armed));
}

BOARD_CASE("a spoilt frame is never obeyed, and the next one always") {
    Talk<TestType> talk;
    const bool sim = !std::is_same_v<TestType, OnHost>;
    const int trials = sim ? 300 : 6000;
    talk.make_ready(50);
    Random random(11);
    int unheard = 0;
    for (int i = 0; i < trials; ++i) {
        const BoardBytes frame = open_frame(open_torque(++talk.seq, {90000, 90000}));
        std::vector<std::uint8_t> spoilt(frame.bytes.begin() + 1,
                                         frame.bytes.begin() + static_cast<int>(frame.size) - 1);
        const auto at = random.index(spoilt.size());
        const auto place = spoilt.begin() + static_cast<std::ptrdiff_t>(at);
        switch (i % 5) {
            case 0:
                *place = static_cast<std::uint8_t>(*place ^ 1U << random.below(8));
                break;
            case 1:
                spoilt.resize(at);
                break;
            case 2:
                spoilt.erase(place);
                break;
            case 3:
                spoilt.insert(place, static_cast<std::uint8_t>(random.below(256)));
                break;
            default:
                for (std::uint8_t& byte : spoilt) {
                    byte = static_cast<std::uint8_t>(random.below(256));
                }
        }
        spoilt.insert(spoilt.begin(), 0);
        spoilt.push_back(0);
        if (spoilt == std::vector<std::uint8_t>(frame.view().begin(), frame.view().end())) {
            continue;  // the byte that was put in was its neighbour's like
        }
        talk.send(spoilt);
        const auto answer = talk.torque(1000, 1000);
        REQUIRE(talk.board.torque().x < 0.002);
        unheard += is_state(answer, OpenState::armed) ? 0 : 1;
    }
    CHECK(unheard == 0);
    CHECK(talk.peek().bad_frames != 0);
}

BOARD_CASE("nonsense is not answered and switches nothing on") {
    Talk<TestType> talk;
    const int bytes = std::is_same_v<TestType, OnHost> ? 60000 : 10000;
    Random random(7);
    std::vector<std::uint8_t> noise(static_cast<std::size_t>(bytes));
    for (std::uint8_t& byte : noise) {
        byte = static_cast<std::uint8_t>(random.below(3) == 0 ? 0 : random.below(256));
    }
    talk.hello();
    talk.config(kConfig);
    talk.answers.clear();
    talk.send(noise);
    talk.pass_ms(0.012 * bytes);
    CHECK(talk.answers.empty());
    CHECK_FALSE(talk.board.enabled());
    const std::array<std::uint8_t, 2> end{};
    talk.send(end);
    CHECK(talk.peek().state == OpenState::configured);
}

BOARD_CASE("a reset switches off, and the board has to be begun anew") {
    Talk<TestType> talk;
    talk.make_ready();
    talk.torque(60000, 60000);
    CHECK(talk.board.enabled());
    talk.board.power_cycle();
    CHECK_FALSE(talk.board.enabled());
    talk.pass_ms(20);
    CHECK(talk.peek().state == OpenState::boot);
    CHECK(is_state(talk.torque(60000, 60000), OpenState::boot));
    CHECK(is_nak(talk.arm(), 2));
    CHECK_FALSE(talk.board.enabled());
}

BOARD_CASE("counts follow the joints both ways, and begin where they are asked to") {
    Talk<TestType> talk;
    talk.hello();
    talk.config(kConfig);
    const Pantograph pantograph(talk.machine.pantograph);
    const auto home = pantograph.counts(*pantograph.reach(*talk.machine.home));
    Random random(13);
    for (int i = 0; i < 12; ++i) {
        const Vec2 place{random.in(-0.03, 0.03), random.in(0.03, 0.08)};
        talk.plant.lead(place);
        talk.pass_ms(60);  // an edge of each encoder every 40 us
        const auto counts = pantograph.counts(*pantograph.reach(place));
        const OpenReport report = talk.peek();
        CHECK(report.counts[0] == counts[0] - home[0]);
        CHECK(report.counts[1] == counts[1] - home[1]);
        CHECK((report.flags & kOpenSkippedEdge) == 0);
    }
    OpenConfig zero = kConfig;
    zero.zero_counts = true;
    talk.config(zero);
    CHECK(talk.peek().counts == OpenAxes{});
}

BOARD_CASE("the board's clock runs as time does") {
    Talk<TestType> talk;
    talk.hello();
    const OpenReport first = talk.peek();
    const double begin = talk.board.time();
    talk.pass_ms(137.3);
    const OpenReport second = talk.peek();
    const double passed = 1e6 * (talk.board.time() - begin);
    CHECK(std::fabs(static_cast<double>(second.time_us - first.time_us) - passed) <= 100.0);
}
