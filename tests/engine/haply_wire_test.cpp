#include "engine/device/emulator/emulated_board.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/emulated_machine.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

namespace {

/// "01 FF": the golden bytes as they are printed (written from the protocol's rules, section 2.1 of
/// the facts on devices; not captured from hardware).
std::vector<std::uint8_t> bytes_of(const std::string& text) {
    std::istringstream in(text);
    std::vector<std::uint8_t> bytes;
    unsigned byte = 0;
    while (in >> std::hex >> byte) {
        bytes.push_back(static_cast<std::uint8_t>(byte));
    }
    return bytes;
}

std::vector<std::uint8_t> bytes_of(const HaplyPacket& packet) {
    return {packet.view().begin(), packet.view().end()};
}

}  // namespace

TEST_CASE("a set-up is the bytes that the makers' examples give", "[haply][golden]") {
    const HaplySetup gen2{.id = 5,
                          .motor_clockwise = {true, false},
                          .encoder_clockwise = {true, false},
                          .sensor_pin = {},
                          .offset_deg = {-61.0, 241.0},
                          .counts_per_turn = {10752.0, 10752.0}};
    CHECK(
        bytes_of(setup_packet(gen2)) ==
        bytes_of("01 05 03 00 01 03 00 01 00 00 00 00 74 C2 00 00 28 46 00 00 71 43 00 00 28 46"));
    HaplySetup gen3{.id = 5,
                    .sensor_pin = {},
                    .offset_deg = {12.0, 168.0},
                    .counts_per_turn = {4880.0, 4880.0}};
    CHECK(
        bytes_of(setup_packet(gen3)) ==
        bytes_of("01 05 03 01 01 03 01 01 00 00 00 00 40 41 00 80 98 45 00 00 28 43 00 80 98 45"));
    gen3.sensor_pin = 56;  // A2
    CHECK(bytes_of(setup_packet(gen3)) ==
          bytes_of("01 05 03 01 01 03 01 01 01 38 00 00 00 40 41 00 80 "
                   "98 45 00 00 28 43 00 80 98 45"));
    const HaplySetup haplet{.id = 3,
                            .motor_clockwise = {true, true},
                            .encoder_clockwise = {true, true},
                            .sensor_pin = {},
                            .offset_deg = {180.0, 0.0},
                            .counts_per_turn = {13824.0, 13824.0}};
    CHECK(
        bytes_of(setup_packet(haplet)) ==
        bytes_of("01 03 03 00 00 03 00 00 00 00 00 00 34 43 00 00 58 46 00 00 00 00 00 00 58 46"));
}

TEST_CASE("torques, zero, reset and replies are the bytes of the table", "[haply][golden]") {
    CHECK(bytes_of(*torque_packet(5, {0.05, -0.0125})) ==
          bytes_of("02 05 CD CC 4C 3D CD CC 4C BC"));
    CHECK(bytes_of(*torque_packet(5, {0.0, 0.0})) == bytes_of("02 05 00 00 00 00 00 00 00 00"));
    CHECK(bytes_of(*torque_packet(5, {-0.0, -0.0})) == bytes_of("02 05 00 00 00 00 00 00 00 00"));
    CHECK(bytes_of(reset_packet(5)) == bytes_of("00 05"));
    const auto reply = read_reply(bytes_of("05 49 2E 41 41 1B ED 27 43"), 5, false);
    REQUIRE(reply);
    CHECK(std::fabs(reply->angle_deg[0] - 12.0738) < 1e-4);
    CHECK(std::fabs(reply->angle_deg[1] - 167.9262) < 1e-4);
    CHECK_FALSE(reply->sensor);
}

TEST_CASE("id 0, foreign ports and pins, and torques beyond the board are refused", "[haply]") {
    CHECK_FALSE(torque_packet(0, {0.0, 0.0}));
    CHECK_THROWS_WITH(reset_packet(0), Has("give 1 to 255"));
    CHECK_THROWS_WITH(setup_packet({.id = 0, .counts_per_turn = {1.0, 1.0}}), Has("id is 0"));
    CHECK_THROWS_WITH(setup_packet({.sensor_pin = 53, .counts_per_turn = {1.0, 1.0}}),
                      Has("54 to 65"));
    const Calibration good = palpate::tests::emulated_calibration();
    for (const auto& ports :
         {std::array<std::uint8_t, 2>{1, 1}, std::array<std::uint8_t, 2>{0, 1},
          std::array<std::uint8_t, 2>{2, 3}, std::array<std::uint8_t, 2>{3, 4}}) {
        HaplyWiring wiring = *good.haply;
        wiring.port = ports;
        CHECK_THROWS_WITH(haply_setup(wiring, good.pantograph), Has("use 1 and 2 in either order"));
    }
    PantographSpec strong = good.pantograph;
    strong.axes[1].torque_limit = 0.124;
    CHECK_THROWS_WITH(haply_setup(*good.haply, strong), Has("gives 0.123 at most"));
    PantographSpec blind = good.pantograph;
    blind.axes[0].counts_per_turn = std::numeric_limits<double>::quiet_NaN();
    CHECK_THROWS_WITH(setup_packet(haply_setup(*good.haply, blind)), Has("counts a turn"));
}

TEST_CASE("a torque that is no finite float never becomes a packet", "[haply][law]") {
    const double bad =
        GENERATE(std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                 -std::numeric_limits<double>::infinity(), 1e300, -1e39);
    CHECK_FALSE(torque_packet(5, {bad, 0.0}));
    CHECK_FALSE(torque_packet(5, {0.0, bad}));
}

TEST_CASE("what is written as a float is read as that float", "[haply][law]") {
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

TEST_CASE("a reply that cannot be is none, and one that can be is read back", "[haply][law]") {
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
