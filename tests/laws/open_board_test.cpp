#include "tests/support/catch.hpp"
#include "tests/support/free_board.hpp"
#include "tests/support/pressed_desk.hpp"

// The shipped program on an open board: its firmware behind a pseudo-terminal.

TEST_CASE(
    "an emergency stop in a trial is kept with its cause, and the session goes on once it is "
    "released",
    "[window][open][safety]") {
    PressedDesk desk(PressingHand::Does::presses, {}, true);
    REQUIRE(desk.feel());
    desk.board.press_stop(true);
    CHECK(desk.force_ends());
    CHECK(desk.waits_for_fault("device_stopped"));
    desk.session->wait_for_screen("trouble");
    CHECK(desk.stays_off());
    desk.board.press_stop(false);
    CHECK(desk.stays_off());  // nothing by itself
    desk.goes_on();
    CHECK(desk.feel());

    // Both who could switch the motors off are killed together: the board does it.
    const pid_t guard = desk.guard();
    REQUIRE(guard > 0);
    kill(guard, SIGSTOP);
    kill(desk.session->program().id(), SIGKILL);
    kill(guard, SIGKILL);
    CHECK(desk.force_ends());
    CHECK(desk.stays_off());
}

TEST_CASE("a cable that is pulled with the force on ends it, and the session waits for the board",
          "[window][open][safety]") {
    PressedDesk desk(PressingHand::Does::presses, {}, true);
    REQUIRE(desk.feel());
    desk.board.plug(false);
    CHECK(desk.force_ends());
    CHECK(desk.waits_for_fault("device_lost"));
    desk.session->wait_for_screen("trouble");
    desk.board.plug(true);
    desk.press_anew();  // the participant's Space does nothing
    CHECK(desk.stays_off());
    desk.goes_on();
    CHECK(desk.feel());
}

TEST_CASE("the doctor and calibrate take an open board, and say what is wrong with another one",
          "[open]") {
    const TemporaryFolder folder;
    const auto doctor = [&](const std::string& calibration, const std::string& part = "") {
        return doctored(folder, "board:" + folder.file("board"), calibration, part);
    };
    CHECK_THAT(doctor("2diy_gen3"), Has("is the board plugged in"));
    const TypedBoard emulator(folder, "--open");
    CHECK_THAT(doctor("2diy_gen3", "\"ok\""),
               Has("\"ok\"", "its own watchdog stops it after 20 ms"));
    CHECK_THAT(doctor("2diy_gen2"), Has("add [board]"));
    std::string other = slurp(PALPATE_SOURCE_DIR "/protocols/library/pantographs.toml");
    const std::string name = "name = \"2diy_gen3\"";
    other = "format = 1\n[[pantograph]]\n" + name + behind(other, name, "[[pantograph]]");
    CHECK_THAT(doctor(write(folder.file("other.toml"),
                            replaced(other, "counts_per_turn = 4880", "counts_per_turn = 4900"))),
               Has("was flashed for 4880 and 4880 counts a turn"));
}
