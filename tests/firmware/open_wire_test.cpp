#include "engine/device/open/open_wire.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"
#include "tests/support/slurp.hpp"

using namespace palpate::engine;

namespace {

/// The body that ends with the last byte of these.
std::vector<std::uint8_t> body_in(std::span<const std::uint8_t> wire) {
    OpenReader reader;
    std::span<const std::uint8_t> body;
    for (const std::uint8_t byte : wire) {
        body = reader.take(byte);
    }
    return {body.begin(), body.end()};
}

}  // namespace

TEST_CASE("frames of the open board are those of its protocol's table", "[open]") {
    const auto frame = [](const BoardBytes& body) {
        return hex_of(open_frame(body).view());
    };
    CHECK(frame(open_hello(1)) == "00 03 01 01 02 01 03 50 C1 00");
    CHECK(frame(open_config(2, {.token = 0x1234,
                                .watchdog_ms = 20,
                                .zero_counts = true,
                                .limit = {123000, 123000}})) ==
          "00 03 02 02 08 34 12 14 01 78 E0 01 04 78 E0 01 03 D5 B3 00");
    CHECK(frame(open_token(OpenType::arm, 3, 0x1234)) == "00 03 03 03 05 34 12 27 15 00");
    CHECK(frame(open_torque(5, {50000, -12500})) ==
          "00 03 10 05 03 50 C3 01 07 2C CF FF FF 54 9D 00");
    CHECK(frame(open_torque(6, {0, 0})) == "00 03 10 06 01 01 01 01 01 01 01 01 03 43 96 00");
    CHECK(frame(open_bare(OpenType::disarm, 0)) == "00 02 04 01 03 AD A5 00");
    CHECK(frame(open_token(OpenType::clear, 4, 0x1234)) == "00 03 05 04 05 34 12 9E 79 00");
    CHECK(frame(open_bare(OpenType::peek, 7)) == "00 03 11 07 03 8D 54 00");
    const auto state = read_open(body_in(
        bytes_of_hex("00 03 90 05 02 03 05 01 87 D6 12 07 FF FF FF FF 80 0A 01 01 03 9C 9E 00")));
    REQUIRE(state);
    CHECK(state->type == OpenType::state);
    CHECK(state->seq == 5);
    CHECK(state->report.state == OpenState::armed);
    CHECK(state->report.flags == 0x100);
    CHECK(state->report.time_us == 1234567);
    CHECK(state->report.counts == OpenAxes{-1, 2688, 0});
    CHECK(state->report.bad_frames == 0);
    const std::string check = "123456789";
    CHECK(open_crc({reinterpret_cast<const std::uint8_t*>(check.data()), check.size()}) == 0x906E);
}

// Worked out by a script with a bitwise CRC and a COBS by splitting at zeros, which shares nothing
// with ours.
TEST_CASE("frames of three axes are longer by a number for each array, and nothing else",
          "[open]") {
    const auto frame = [](const BoardBytes& body) {
        return hex_of(open_frame(body).view());
    };
    CHECK(frame(open_config(2, {.token = 0x1234,
                                .watchdog_ms = 20,
                                .zero_counts = true,
                                .limit = {123000, 123000, 90000},
                                .axes = 3})) ==
          "00 03 02 02 08 34 12 14 01 78 E0 01 04 78 E0 01 04 90 5F 01 03 E4 31 00");
    CHECK(frame(open_torque(5, {50000, -12500, 75001}, 3)) ==
          "00 03 10 05 03 50 C3 01 08 2C CF FF FF F9 24 01 03 E8 DA 00");
    CHECK(frame(open_torque(6, {0, 0, 0}, 3)) ==
          "00 03 10 06 01 01 01 01 01 01 01 01 01 01 01 01 03 04 90 00");
    const auto state = read_open(body_in(bytes_of_hex(
        "00 03 90 05 02 03 05 05 87 D6 12 07 FF FF FF FF 80 0A 01 05 90 EE FE FF 03 DA A0 00")));
    REQUIRE(state);
    CHECK(state->report.axes == 3);
    CHECK(state->report.flags == (1U << 8U | kOpenClamped3));
    CHECK(state->report.time_us == 1234567);
    CHECK(state->report.counts == OpenAxes{-1, 2688, -70000});
    const auto ident = read_open(body_in(
        bytes_of_hex("00 03 81 01 02 01 02 01 01 01 01 01 03 60 09 01 03 60 09 01 03 60 09 01 "
                     "04 C0 D4 01 04 C0 D4 01 04 90 5F 01 08 05 32 01 04 01 60 7D 00")));
    REQUIRE(ident);
    CHECK(ident->ident.axes == 3);
    CHECK(ident->ident.counts_per_turn == OpenAxes{2400, 2400, 2400});
    CHECK(ident->ident.torque_full == OpenAxes{120000, 120000, 90000});
    CHECK(ident->ident.watchdog_max == 50);
    CHECK(ident->ident.time_step == 4);
}

TEST_CASE("a body comes out of its frame as it went in, behind any noise", "[open]") {
    Random random(3);
    for (int i = 0; i < 2000; ++i) {
        BoardBytes body;
        body.size = 1 + random.index(kOpenBody);
        for (std::size_t at = 0; at < body.size; ++at) {
            body.bytes[at] =
                static_cast<std::uint8_t>(random.below(4) == 0 ? 0 : random.below(256));
        }
        const BoardBytes frame = open_frame(body);
        REQUIRE(frame.size == body.size + 3);
        OpenReader reader;
        for (int noise = random.below(70); noise > 0; --noise) {
            static_cast<void>(reader.take(static_cast<std::uint8_t>(random.below(256))));
        }
        std::span<const std::uint8_t> found;
        for (const std::uint8_t byte : frame.view()) {
            found = reader.take(byte);
        }
        REQUIRE(hex_of(found) == hex_of(body.view()));
    }
}

TEST_CASE("an answer with a bit flipped, cut or longer is none", "[open]") {
    const auto good =
        bytes_of_hex("90 05 00 03 00 01 87 D6 12 00 FF FF FF FF 80 0A 00 00 00 9C 9E");
    REQUIRE(read_open(good));
    for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
        auto bad = good;
        bad[bit / 8] = static_cast<std::uint8_t>(bad[bit / 8] ^ 1U << bit % 8);
        CHECK_FALSE(read_open(bad));
    }
    for (std::size_t size = 0; size < good.size(); ++size) {
        CHECK_FALSE(read_open(std::span(good).first(size)));
    }
    auto longer = good;
    longer.push_back(0);
    CHECK_FALSE(read_open(longer));
}
