#include "engine/device/drivers/udp_link.hpp"
#include "engine/device/emulator/served_board.hpp"
#include "engine/device/open/open_line.hpp"
#include "tests/support/board_link.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/child.hpp"
#include "tests/support/emulated_machine.hpp"

using namespace palpate::engine;

namespace {

/// A driver in a process of its own that presses without end.
pid_t press(const std::string& path, const Calibration& machine, bool guarded) {
    return in_a_child([&] {
        const BoardTiming patient{.patience = 5.0, .silence = 1.0};
        ScriptedGuard::Script nobody;
        for (int tries = 0; tries < 20; ++tries) {
            try {
                const auto device =
                    guarded ? open_board(path, machine, patient)
                            : std::make_unique<BoardDevice>(
                                  machine, std::make_unique<UdpLink>(udp_address(path)), open_line,
                                  std::make_unique<ScriptedGuard>(nobody), patient);
                while (true) {
                    static_cast<void>(device->read());
                    static_cast<void>(device->write({0.3, -0.4, 0.0}));
                    palpate::sleep_until(palpate::monotonic_ns() + 1'000'000);
                }
            } catch (const std::exception&) {  // a busy machine
            }
        }
    });
}

}  // namespace

TEST_CASE("a UDP address is a machine and a port, and anything else is refused with an example",
          "[open]") {
    CHECK(udp_address("udp:127.0.0.1:5000").host == "127.0.0.1");
    CHECK(udp_address("udp:127.0.0.1:5000").port == "5000");
    CHECK(udp_address("udp:[::1]:65535").host == "::1");
    CHECK(UdpLink(udp_address("udp:[::1]:65535")).name() == "udp:[::1]:65535");
    CHECK(UdpLink(udp_address("udp:rig:1")).name() == "udp:rig:1");
    for (const char* wrong :
         {"udp:", "udp::5000", "udp:rig", "udp:rig:", "udp:rig:0", "udp:rig:65536", "udp:rig:5000x",
          "udp:rig:-1", "udp:rig: 5", "udp:5000"}) {
        CAPTURE(wrong);
        CHECK_THROWS_WITH(udp_address(wrong), Has(wrong, "udp:127.0.0.1:5000"));
    }
}

TEST_CASE("nobody at a UDP port is said with what to do, and so is a machine that is not there",
          "[open]") {
    const Calibration machine = open_machine();
    GuidedHand plant(machine);
    OpenBoard board(plant, machine, *machine.board);
    const std::string path = UdpBoard(board, 0).path();  // and it is gone
    CHECK_THROWS_WITH(open_board(path, machine), Has("does the device's program run there"));
    CHECK_THROWS_WITH(open_board("udp:no such machine:5000", machine), Has("there is no machine"));
}

TEST_CASE(
    "a host that dies over UDP is disarmed by its guard, and by the board's watchdog without one",
    "[open]") {
    EACH(guarded, true, false);
    const Calibration machine = open_machine();
    GuidedHand plant(machine);
    OpenBoard board(plant, machine, *machine.board);
    UdpBoard port(board, 0);
    const auto lives_until = [&](const auto& done) {
        const std::int64_t end = palpate::monotonic_ns() + 20'000'000'000;
        while (!done() && palpate::monotonic_ns() < end) {
            port.step(250);
        }
        return done();
    };
    int as_promised = 0;
    for (int tries = 0; tries < 10 && as_promised == 0; ++tries) {
        const pid_t host = press(port.path(), machine, guarded);
        REQUIRE(lives_until([&] { return board.torque() != Vec3{}; }));
        kill(host, SIGKILL);
        CHECK(lives_until([&] { return board.torque() == Vec3{}; }));
        CHECK_FALSE(board.enabled());
        // A busy machine keeps the guard waiting for longer than the watchdog does: then once more.
        const OpenState left = guarded ? OpenState::configured : OpenState::stopped;
        as_promised += board.state() == static_cast<int>(left) ? 1 : 0;
        waitpid(host, nullptr, 0);
    }
    CHECK(as_promised == 1);
}
