#include "tests/support/catch.hpp"
#include "tests/support/emulated_machine.hpp"
#include "tests/support/random.hpp"
#include "tests/support/slurp.hpp"

using namespace palpate::engine;

namespace {

/// A board and a naive host, who sends what it likes.
struct Naive {
    Calibration machine = palpate::tests::emulated_calibration();
    palpate::tests::GuidedHand plant{machine};
    HaplyBoard board{plant, machine.pantograph, *machine.haply};

    void poll(int times) {
        for (int i = 0; i < times; ++i) {
            board.poll();
        }
    }
    void send(const std::vector<std::uint8_t>& bytes) {
        board.receive(bytes);
        poll(20);
    }
    void send_packet(const BoardBytes& packet) {
        board.receive(packet.view());
        poll(20);
    }
    void set_up() { send_packet(setup_packet(haply_setup(*machine.haply, machine.pantograph))); }
    void torque(double one, double two) { send_packet(*torque_packet(5, {one, two})); }
    std::vector<std::uint8_t> heard() {
        std::vector<std::uint8_t> bytes(256);
        bytes.resize(board.transmit(bytes));
        return bytes;
    }
};

/// 12 bits of duty: the last step that does not exceed it.
double duty(double torque) {
    const double step = kHaplyTorque / 4095.0;
    return std::copysign(std::floor(std::fabs(torque) / step * (1.0 + 1e-7)) * step, torque);
}

}  // namespace

TEST_CASE("the board has no watchdog, so the last torque stays on for ever", "[haply]") {
    Naive host;
    host.set_up();
    host.torque(0.05, -0.02);
    const Vec3 given = host.board.torque();
    CHECK(std::fabs(given.y - duty(0.05)) < 1e-9);  // port 1 drives pivot 2
    CHECK(std::fabs(given.x - duty(-0.02)) < 1e-9);
    host.poll(20 * 3600 * 20);
    CHECK(host.board.torque() == given);
    CHECK(host.plant.torque() == given);
}

TEST_CASE("a reset leaves the motors on, and they can no longer be zeroed", "[haply]") {
    Naive host;
    host.set_up();
    host.torque(0.05, 0.05);
    const Vec3 given = host.board.torque();
    host.send({0, 0});  // as hAPI sends it
    CHECK(host.board.torque() == given);
    host.torque(0.0, 0.0);
    CHECK(host.board.torque() == given);
    CHECK(host.board.journal().desyncs == 1);
    host.set_up();
    CHECK(host.board.torque() == given);
    host.torque(0.0, 0.0);
    CHECK(host.board.torque() == Vec3{});
}

TEST_CASE("torques for an id that owns no motor are read as commands", "[haply]") {
    Naive host;
    host.set_up();
    host.torque(0.05, 0.05);
    const int resets = host.board.journal().resets;
    // The bytes of 2.35e-38 are 00 00 00 01 in reverse: a reset, and the first byte of a set-up.
    host.send({2, 9, 0, 0, 0, 1, 0, 0, 0, 0});
    CHECK(host.board.journal().desyncs == 1);
    CHECK(host.board.journal().resets > resets);
    host.torque(0.0, 0.0);
    CHECK_FALSE(host.board.torque() == Vec3{});  // the addresses are gone, the force is not
}

TEST_CASE("id 0 reaches every port that was not set up", "[haply]") {
    Naive host;
    host.send({2, 0, 0xCD, 0xCC, 0x4C, 0x3D, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
    CHECK(host.board.journal().id_0 == 1);
    CHECK_FALSE(host.board.torque() == Vec3{});
}

TEST_CASE("a packet cut in two is filled with 0xFF, and its rest is read as commands", "[haply]") {
    Naive host;
    host.set_up();
    host.torque(0.01, 0.01);
    host.send({2, 5, 0xCD, 0xCC});
    CHECK(host.board.journal().missing == 6);
    CHECK(host.board.journal().undefined_duty == 2);  // CD CC FF FF is a NaN, and FF FF FF FF
    CHECK(std::fabs(host.board.torque().x) == kHaplyTorque);
}

TEST_CASE("a torque that is not a number gives an undefined duty", "[haply]") {
    Naive host;
    host.set_up();
    host.send({2, 5, 0, 0, 0xC0, 0x7F, 0, 0, 0, 0});
    CHECK(host.board.journal().undefined_duty == 1);
    CHECK(std::fabs(host.board.torque().y) == kHaplyTorque);
}

TEST_CASE("a set-up is not acknowledged, and each one leaks", "[haply]") {
    Naive host;
    host.set_up();
    host.set_up();
    CHECK(host.heard().empty());
    CHECK(host.board.journal().setups == 2);
    host.torque(0.0, 0.0);
    CHECK(host.heard().size() == 9);
}

TEST_CASE("motor directions go to the first slots, whatever the ports are", "[haply]") {
    Naive host;
    // Motors at ports 2 and 3: the directions land at slots 1 and 2, so port 3 keeps the default.
    const auto f = wire_bytes(4880.0F);
    std::vector<std::uint8_t> setup{1, 5, 0b110, 1, 1, 0b011, 1, 1, 0, 0};
    for (int i = 0; i < 2; ++i) {
        setup.insert(setup.end(), 4, 0);
        setup.insert(setup.end(), f.begin(), f.end());
    }
    host.send(setup);
    host.torque(0.05, 0.05);
    CHECK(std::fabs(host.board.torque().x - duty(0.05)) < 1e-9);
    CHECK(host.board.torque().y == 0.0);  // pivot 2 hangs at port 1
}

TEST_CASE("torques are clamped at 0.123 N m and cut to 12 bits", "[haply]") {
    Naive host;
    host.set_up();
    Random random(3);
    for (int i = 0; i < 2000; ++i) {
        const double one = random.in(-0.2, 0.2);
        host.torque(one, -one);
        const double got = host.board.torque().y;
        CHECK(host.board.torque().x == -got);
        CHECK(std::fabs(got) <= kHaplyTorque);
        const double wanted = std::copysign(std::fmin(std::fabs(one), kHaplyTorque), one);
        CHECK(std::fabs(got) <= std::fabs(wanted) + 1e-7);
        CHECK(std::fabs(got - wanted) <= kHaplyTorque / 4095.0 + 1e-7);
    }
}

TEST_CASE("a counter starts at its offset and counts in the direction it was given", "[haply]") {
    Naive host;
    HaplySetup setup = haply_setup(*host.machine.haply, host.machine.pantograph);
    setup.offset_deg = {12.0, 168.0};
    setup.encoder_clockwise[1] = true;  // against the wiring
    host.send_packet(setup_packet(setup));
    const JointAngles before = host.plant.angles();
    host.plant.lead({0.010, 0.030});
    host.torque(0.0, 0.0);
    const auto reply = read_reply(host.heard(), 5, false);
    REQUIRE(reply);
    const double count = 360.0 / 4880.0;
    const double turned_1 = (host.plant.angles()[0] - before[0]) * 180.0 / M_PI;  // at port 2
    const double turned_2 = (host.plant.angles()[1] - before[1]) * 180.0 / M_PI;  // at port 1
    CHECK(std::fabs(reply->angle_deg[0] - (12.0 + turned_2)) <= 1.001 * count);
    CHECK(std::fabs(reply->angle_deg[1] - (168.0 - turned_1)) <= 1.001 * count);
}

// Golden bytes as they are printed, written from the protocol's rules, section 2.1 of the facts on
// devices; not captured from hardware.
TEST_CASE("a set-up is the bytes that the makers' examples give", "[haply]") {
    const HaplySetup gen2{.id = 5,
                          .motor_clockwise = {true, false},
                          .encoder_clockwise = {true, false},
                          .sensor_pin = {},
                          .offset_deg = {-61.0, 241.0},
                          .counts_per_turn = {10752.0, 10752.0}};
    CHECK(hex_of(setup_packet(gen2).view()) ==
          "01 05 03 00 01 03 00 01 00 00 00 00 74 C2 00 00 28 46 00 00 71 43 00 00 28 46");
    HaplySetup gen3{.id = 5,
                    .sensor_pin = {},
                    .offset_deg = {12.0, 168.0},
                    .counts_per_turn = {4880.0, 4880.0}};
    CHECK(hex_of(setup_packet(gen3).view()) ==
          "01 05 03 01 01 03 01 01 00 00 00 00 40 41 00 80 98 45 00 00 28 43 00 80 98 45");
    gen3.sensor_pin = 56;  // A2
    CHECK(hex_of(setup_packet(gen3).view()) ==
          "01 05 03 01 01 03 01 01 01 38 00 00 00 40 41 00 80 "
          "98 45 00 00 28 43 00 80 98 45");
    const HaplySetup haplet{.id = 3,
                            .motor_clockwise = {true, true},
                            .encoder_clockwise = {true, true},
                            .sensor_pin = {},
                            .offset_deg = {180.0, 0.0},
                            .counts_per_turn = {13824.0, 13824.0}};
    CHECK(hex_of(setup_packet(haplet).view()) ==
          "01 03 03 00 00 03 00 00 00 00 00 00 34 43 00 00 58 46 00 00 00 00 00 00 58 46");
}

TEST_CASE("torques, zero, reset and replies are the bytes of the table", "[haply]") {
    CHECK(hex_of(torque_packet(5, {0.05, -0.0125})->view()) == "02 05 CD CC 4C 3D CD CC 4C BC");
    CHECK(hex_of(torque_packet(5, {0.0, 0.0})->view()) == "02 05 00 00 00 00 00 00 00 00");
    CHECK(hex_of(torque_packet(5, {-0.0, -0.0})->view()) == "02 05 00 00 00 00 00 00 00 00");
    CHECK(hex_of(reset_packet(5).view()) == "00 05");
    const auto reply = read_reply(bytes_of_hex("05 49 2E 41 41 1B ED 27 43"), 5, false);
    REQUIRE(reply);
    CHECK(std::fabs(reply->angle_deg[0] - 12.0738) < 1e-4);
    CHECK(std::fabs(reply->angle_deg[1] - 167.9262) < 1e-4);
    CHECK_FALSE(reply->sensor);
}

TEST_CASE("id 0, foreign ports and pins, and torques beyond the board are refused", "[haply]") {
    CHECK_FALSE(torque_packet(0, {0.0, 0.0}));
    const Calibration good = palpate::tests::emulated_calibration();
    HaplyWiring nobody = *good.haply;
    nobody.id = 0;
    CHECK_THROWS_WITH(haply_setup(nobody, good.pantograph), Has("give 1 to 255"));
    HaplyWiring pinned = *good.haply;
    pinned.grip_pin = 53;
    CHECK_THROWS_WITH(haply_setup(pinned, good.pantograph), Has("54 to 65"));
    for (const auto& ports :
         {std::array<std::uint8_t, 2>{1, 1}, std::array<std::uint8_t, 2>{0, 1},
          std::array<std::uint8_t, 2>{2, 3}, std::array<std::uint8_t, 2>{3, 4}}) {
        HaplyWiring wiring = *good.haply;
        wiring.port = ports;
        CHECK_THROWS_WITH(haply_setup(wiring, good.pantograph), Has("port of the Haply board is"));
    }
    PantographSpec strong = good.pantograph;
    strong.axes[1].torque_limit = 0.124;
    CHECK_THROWS_WITH(haply_setup(*good.haply, strong), Has("is 124 mN m", "gives 123 at most"));
    PantographSpec blind = good.pantograph;
    blind.axes[0].counts_per_turn = std::numeric_limits<double>::quiet_NaN();
    CHECK_THROWS_WITH(haply_setup(*good.haply, blind), Has("counts per turn of axis 1 is nan"));
}

TEST_CASE("a torque that is no finite float never becomes a packet", "[haply]") {
    const double bad =
        GENERATE(std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                 -std::numeric_limits<double>::infinity(), 1e300, -1e39);
    CHECK_FALSE(torque_packet(5, {bad, 0.0}));
    CHECK_FALSE(torque_packet(5, {0.0, bad}));
}

TEST_CASE("what is written as a float is read as that float", "[haply]") {
    Random random(7);
    for (int i = 0; i < 20'000; ++i) {
        const double sign = random.coin() ? 1.0 : -1.0;
        const auto value = static_cast<float>(sign * random.decade(-30.0, 30.0));
        CHECK(wire_float(wire_bytes(value)) == value);
        const auto packet = torque_packet(7, {0.1 * sign, static_cast<double>(value)});
        if (packet) {
            const auto view = packet->view();
            REQUIRE(view.size() == 10);
            CHECK(wire_float(view.subspan<6, 4>()) == value);
        }
    }
}

TEST_CASE("a reply that cannot be is none, and one that can be is read back", "[haply]") {
    Random random(11);
    for (int i = 0; i < 20'000; ++i) {
        const bool sensor = random.coin();
        std::vector<std::uint8_t> bytes;
        const auto id = static_cast<std::uint8_t>(1 + random.below(255));
        bytes.push_back(id);
        std::vector<float> values;
        for (std::size_t k = 0; k < (sensor ? 3U : 2U); ++k) {
            values.push_back(static_cast<float>(random.in(-1e4, 1e4)));
        }
        const int spoil = random.below(6);
        if (spoil == 1) {
            values.back() = std::numeric_limits<float>::quiet_NaN();
        } else if (spoil == 2) {
            values.back() = 1.001e4F;
        } else if (spoil == 3) {
            values.front() = std::numeric_limits<float>::infinity();
        }
        for (const float value : values) {
            const auto four = wire_bytes(value);
            bytes.insert(bytes.end(), four.begin(), four.end());
        }
        if (spoil == 4) {
            bytes[0] ^= static_cast<std::uint8_t>(1 + random.below(255));
        } else if (spoil == 5) {
            bytes.resize(bytes.size() - 1U - random.index(8));
        }
        const auto reply = read_reply(bytes, id, sensor);
        REQUIRE(reply.has_value() == (spoil == 0));
        if (reply) {
            CHECK(reply->angle_deg[1] == static_cast<double>(values.back()));
            CHECK(reply->sensor.has_value() == sensor);
        }
    }
}
