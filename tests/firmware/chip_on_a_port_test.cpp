#include "tests/firmware/boards.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/child.hpp"
#include "tests/support/process.hpp"

using namespace palpate::engine;

// The very binary behind a pseudo-terminal in real time, and real processes before it. Nothing is
// asserted about time.

namespace {

std::unique_ptr<PortBoard> simulated_chip(BoardPlant& plant, const Calibration& machine) {
    return std::make_unique<SimBoard>(plant, machine, *machine.board, kAtmega328p,
                                      PALPATE_FIRMWARE_328P);
}

struct Port {
    Calibration machine = open_machine();
    EmulatedBoard board{
        machine, [this] { return std::make_unique<GuidedHand>(machine); }, {}, simulated_chip};
};

}  // namespace

TEST_CASE("the shipped program takes the chip itself on a port", "[open]") {
    const Port port;
    const TemporaryFolder folder;
    std::string said;
    for (int i = 0; i < 20 && said.find("ok    device") != 0; ++i) {
        said = palpate_command({"doctor", "--device", "board:" + port.board.path(), "--calibration",
                                "2diy_gen3", "--seconds", "0.05", "--db", folder.file("d.sqlite")})
                   .out;
    }
    CAPTURE(said);
    CHECK(said.find("ok    device") == 0);
    CHECK_THAT(said, Has("own watchdog stops it"));
    CHECK(port.board.motors().off());
}

TEST_CASE("killed with the force on, with or without its guard, palpate leaves a board that stops",
          "[open]") {
    EACH(both, false, true);
    const Port port;
    const auto presser = pressing(port.board, port.machine);
    const pid_t guard = presser->guard();
    if (both) {
        kill(guard, SIGKILL);
    }
    presser->signal(SIGKILL);
    presser->reap();
    CHECK(eventually([&] { return port.board.motors().off(); }));
    for (int i = 0; i < 100; ++i) {
        wait_a_little();
        REQUIRE(port.board.motors().off());
    }
}
