#include <csignal>
#include <filesystem>
#include <fstream>

#include "tests/support/catch.hpp"
#include "tests/support/pressed_desk.hpp"
#include "tests/support/rig_file.hpp"

using namespace palpate;
using tests::eventually;
using tests::TemporaryFolder;
using tests::WindowSession;

// A board whose answers become late while a session runs, done to the shipped program: an emulator that is typed
// to, a window, and the file.

TEST_CASE(
    "a session whose answers become late ends the force, and waits until they are quick again",
    "[window][haply][law]") {
    const TemporaryFolder folder;
    tests::TypedTo board(folder, "keys", "haply-emulator --link '" + folder.file("board") + "'");
    board.type("delay 0");
    REQUIRE(eventually([&] { return std::filesystem::exists(folder.file("board")); }));
    std::string study = tests::pressed_study();
    study.replace(study.find("dead_man = true"), 15, "dead_man = false");
    std::ofstream(folder.file("p.toml")) << study;
    WindowSession session(
        {"run", folder.file("p.toml"), "--participant", "P1", "--db", folder.file("d.sqlite"),
         "--device", "haply:" + folder.file("board"), "--kind", "pilot", "--windowed"},
        folder.file("d.sqlite"));
    session.press_at("welcome", "space");
    session.press_at("ready", "space");
    session.wait_for_screen("explore");
    board.type("delay 6");
    session.wait_until(
        "SELECT fault_cause IN ('delayed', 'device_silent') FROM trial ORDER BY trial_id DESC "
        "LIMIT 1",
        "1");
    session.wait_for_screen("trouble");
    for (int i = 0; i < 1500; ++i) {
        tests::wait_a_little();
    }
    CHECK(session.ask("SELECT count(*) FROM event WHERE event_kind = 'reconnect'") == "0");
    board.type("delay 0");
    session.wait_until("SELECT count(*) FROM event WHERE event_kind = 'reconnect'", "1");
    session.press_at("trouble", "space");
    session.wait_for_screen("ready");
    session.program().signal(SIGTERM);
    CHECK(session.finish().code == 3);
}
