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

// What befalls a board and its wire while a session runs, done to the shipped program: an emulator
// that is typed to, a window, and the file.

namespace {

/// Whether the motors give nothing now, as the emulator says.
bool off(tests::TypedTo& board) {
    const std::size_t before = board.program().out().size();
    board.type("motors");
    std::string said;
    CHECK(eventually([&] {
        said = board.program().out().substr(before);
        return said.find("mN m\n") != std::string::npos;
    }));
    return said.find("give 0, 0 mN") != std::string::npos;
}

bool stays_off(tests::TypedTo& board) {
    for (int i = 0; i < 20; ++i) {
        if (!off(board)) {
            return false;
        }
        tests::wait_a_little();
    }
    return true;
}

}  // namespace

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
    const bool silent = session.ask(
                            "SELECT fault_cause FROM trial ORDER BY trial_id DESC LIMIT "
                            "1") == "device_silent";
    // A board that went away is back as soon as it answers at all.
    CHECK((silent ||
           session.ask("SELECT count(*) FROM event WHERE event_kind = 'reconnect'") == "0"));
    board.type("delay 0");
    session.wait_until("SELECT count(*) FROM event WHERE event_kind = 'reconnect'", "1");
    for (int tries = 0; tries < 20 && session.screen_name() == "trouble"; ++tries) {
        if (silent) {  // a busy machine's board went away: the experimenter goes on
            session.hand().chord("p");
        } else {
            session.hand().key("space");
        }
        tests::pause(0.5);
    }
    session.wait_for_screen("ready");
    session.program().signal(SIGTERM);
    CHECK(session.finish().code == 3);
}

TEST_CASE("a packet read as a reset, and another program's torques, end at zero in a session",
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
    REQUIRE(eventually([&] { return !off(board); }));
    board.type("misread");  // the motors keep what they had, and no longer know their address
    session.wait_for_screen("trouble");
    session.wait_until(
        "SELECT fault_cause LIKE 'device_%' FROM trial ORDER BY trial_id DESC LIMIT 1", "1");
    CHECK(eventually([&] { return off(board); }));
    CHECK(stays_off(board));
    board.type("stranger 200");  // while the session waits
    CHECK(eventually([&] { return off(board); }));
    tests::pause(0.5);
    CHECK(stays_off(board));
    session.program().signal(SIGTERM);
    CHECK(session.finish().code == 3);
    CHECK(stays_off(board));
}
