#include "engine/device/drivers/haply_line.hpp"
#include "engine/device/drivers/serial_link.hpp"
#include "tests/support/allocations.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/child.hpp"
#include "tests/support/emulated_machine.hpp"
#include "tests/support/process.hpp"

using namespace palpate::engine;

// Over a real pseudo-terminal, with the board in a process of its own.

namespace {

/// Patient with a busy machine.
std::unique_ptr<BoardDevice> patient(const std::string& path) {
    return std::make_unique<BoardDevice>(
        haply_machine(), std::make_unique<SerialLink>(path), haply_line,
        std::make_unique<GuardProcess>(GuardTiming{.patience = 2000, .alive_ms = 20'000}),
        BoardTiming{.patience = 200.0, .silence = 10.0, .still = 0.1});
}

}  // namespace

TEST_CASE("read and write over a real port allocate nothing", "[haply]") {
    EmulatedBoard board(haply_machine(), guided_hand());
    const auto device = patient(board.path());
    const std::size_t before = allocations();
    for (int i = 0; i < 200; ++i) {
        static_cast<void>(device->read());
        device->write({0.1, 0.1, 0.0});
    }
    board.hush(true);  // faults allocate nothing either
    const std::size_t between = allocations();
    for (int i = 0; i < 5; ++i) {
        static_cast<void>(device->read());
        device->write({0.1, 0.1, 0.0});
    }
    CHECK(allocations() - between == 0);
    CHECK(between - before < 5);  // hush() itself
    board.hush(false);
}

TEST_CASE("a port that is absent, taken, or no port gives a sentence with the remedy", "[haply]") {
    SerialLink absent("/dev/palpate-no-such-port");
    CHECK_FALSE(absent.reopen());
    CHECK_THAT(absent.trouble(), Has("is the board plugged in and switched on?"));
    SerialLink null("/dev/null");
    CHECK_FALSE(null.reopen());
    CHECK_THAT(null.trouble(), Has("is not a serial port"));
    CHECK_THROWS_WITH(open_haply("/dev/palpate-no-such-port", haply_machine()),
                      Has("there is no device at /dev/palpate-no-such-port"));

    EmulatedBoard board(haply_machine(), guided_hand());
    SerialLink first(board.path());
    SerialLink second(board.path());
    REQUIRE(first.reopen());
    CHECK(first.trouble().empty());
    CHECK_FALSE(second.reopen());
    CHECK_THAT(second.trouble(), Has("is in use by another program"));
    CHECK(first.send(std::array<std::uint8_t, 2>{0, 5}));  // the first one is none the worse
    first.close();
    CHECK(second.reopen());
    CHECK_FALSE(first.send(std::array<std::uint8_t, 2>{0, 5}));

    CHECK_THAT(port_trouble("/dev/ttyACM0", EACCES), Has("usermod -aG dialout"));
    CHECK_THAT(port_trouble("/dev/ttyACM0", EBUSY), Has("fuser -v /dev/ttyACM0"));
}

TEST_CASE("a board that does not answer over a real port is refused, and the port is free again",
          "[haply]") {
    EmulatedBoard board(haply_machine(), guided_hand());
    board.hush(true);
    CHECK_THROWS_WITH(patient(board.path()), Has("does not answer"));
    board.hush(false);
    CHECK(patient(board.path())->read().ok());
}

TEST_CASE("a packet counts as sent only if all of it went out", "[haply]") {
    const int board = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    REQUIRE(board >= 0);
    REQUIRE(grantpt(board) == 0);
    REQUIRE(unlockpt(board) == 0);
    SerialLink link(ptsname(board));
    REQUIRE(link.reopen());
    std::vector<std::uint8_t> packet(61, 7);  // the board reads nothing, and its buffer fills up
    std::size_t whole = 0;
    while (link.send(packet)) {
        ++whole;
    }
    std::size_t arrived = 0;
    std::array<std::uint8_t, 4096> bytes{};
    CHECK(eventually([&] {
        const ssize_t got = read(board, bytes.data(), bytes.size());
        arrived += got > 0 ? static_cast<std::size_t>(got) : 0U;
        return arrived >= whole * packet.size();
    }));
    close(board);
    CHECK(whole > 10);
}
