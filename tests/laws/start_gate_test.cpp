#include <csignal>
#include <fstream>

#include "tests/support/catch.hpp"
#include "tests/support/free_board.hpp"
#include "tests/support/slurp.hpp"

using namespace palpate;
using Catch::Matchers::ContainsSubstring;
using tests::pause;
using tests::TemporaryFolder;
using tests::WindowSession;

// Where a trial begins, and how a question ends that nobody answers: the shipped program in a
// window.

namespace {

std::string four_trials() {
    return tests::slurp(PALPATE_SOURCE_DIR "/tests/golden/four_trials.toml");
}

/// Presses Space at Ready for some time. @return nothing began
bool stays_ready(WindowSession& session) {
    session.wait_for_screen("ready");
    for (int i = 0; i < 5; ++i) {
        session.hand().key("space");
        pause(0.3);
    }
    return session.screen_name() == "ready" && session.ask("SELECT count(*) FROM trial") == "0";
}

}  // namespace

TEST_CASE("a trial begins with the handle at the start, and nowhere else",
          "[window][haply][gate][law]") {
    const TemporaryFolder folder;
    tests::FreeBoard board(folder);
    std::string text =
        tests::replaced(four_trials(), "stiffness_n_per_m = 1000", "stiffness_n_per_m = 200");
    std::ofstream(folder.file("p.toml"))
        << text + "\n[safety]\nlate_in_a_row = 0\nlate_of_100 = 0\n";
    const std::string file = folder.file("d.sqlite");
    WindowSession session(
        {"run", folder.file("p.toml"), "--participant", "P1", "--db", file, "--device",
         board.word(), "--calibration", "2diy_gen3", "--kind", "pilot", "--windowed"},
        file);
    session.press_at("welcome", "space");
    CHECK(stays_ready(session));  // at home, 29 mm away
    board.bring("0,20");          // inside all of them
    CHECK(stays_ready(session));
    board.bring("0,66");
    CHECK(stays_ready(session));
    board.bring("3,61");
    session.press_at("ready", "space");
    session.wait_for_screen("explore");
    session.hand().key("Escape");
    session.wait_until("SELECT count(*) FROM trial WHERE outcome = 'faulted'", "1");
    CHECK(session.ask("SELECT abs(start_x_m - 0.003) < 0.0005 AND abs(start_y_m - 0.061) < 0.0005 "
                      "FROM presentation") == "1");
    session.program().signal(SIGTERM);
    const tests::Finished end = session.finish();
    CHECK(end.code == 3);
    CHECK_THAT(end.out, ContainsSubstring("four_trials: pilot, participant P1"));
    // It is a pilot: that is said before another device is looked for.
    const std::string rig = tests::commissioned_rig(folder, "haply:/nonexistent");
    const tests::Finished as_real =
        tests::Process({tests::palpate_program(), "run", folder.file("p.toml"), "--participant",
                        "P1", "--db", file, "--device", "haply:/nonexistent", "--calibration", rig},
                       {"SDL_VIDEODRIVER=dummy"})
            .wait();
    CHECK(as_real.code == 2);
    CHECK_THAT(as_real.error, ContainsSubstring("is a pilot session; it cannot go on as real"));
}

TEST_CASE("in a ring that reaches into an object no trial begins where it does",
          "[window][haply][gate][law]") {
    const TemporaryFolder folder;
    tests::FreeBoard board(folder);
    std::string text = tests::replaced(four_trials(), "stiffness_n_per_m = 1000",
                                       "start_radius_mm = 60\nstiffness_n_per_m = 200");
    std::ofstream(folder.file("p.toml"))
        << text + "\n[safety]\nlate_in_a_row = 0\nlate_of_100 = 0\n";
    const std::string file = folder.file("d.sqlite");
    WindowSession session(
        {"run", folder.file("p.toml"), "--participant", "P1", "--db", file, "--device",
         board.word(), "--calibration", "2diy_gen3", "--kind", "pilot", "--windowed"},
        file);
    session.press_at("welcome", "space");
    board.bring("0,20");
    CHECK(stays_ready(session));
    board.bring("0,66");
    session.press_at("ready", "space");
    session.wait_for_screen("explore");
    session.program().signal(SIGTERM);
    CHECK(session.finish().code == 3);
}

TEST_CASE("a question that nobody answers ends, and its trial runs again", "[window][desk][law]") {
    const TemporaryFolder folder;
    std::string text = tests::replaced(four_trials(), "explore_min_s = 0.5", "explore_min_s = 0.1");
    text = tests::replaced(text, "gap_s = 0.1", "gap_s = 0.1\nanswer_timeout_s = 3");
    std::ofstream(folder.file("p.toml")) << text;
    const std::string file = folder.file("d.sqlite");
    WindowSession session({"run", folder.file("p.toml"), "--participant", "P1", "--db", file,
                           "--device", "mouse", "--kind", "pilot"},
                          file);
    session.press_at("welcome", "space");
    session.press_at("ready", "space");
    session.press_at("explore", "space");
    session.wait_until("SELECT count(*) FROM trial WHERE outcome = 'unanswered'", "1");
    session.wait_for_text("nobody answered in time; runs again later in its block  (4 left)");
    for (int i = 0; i < 40 && session.screen_name() != "end"; ++i) {
        const std::string screen = session.screen_name();
        if (screen == "ready" || screen == "explore") {
            session.hand().key("space");
        } else if (screen == "question") {
            session.hand().key("1");
        }
        pause(0.4);
    }
    session.press_at("end", "space");
    CHECK(session.finish().code == 0);
    CHECK(session.ask("SELECT count(*) FROM response") == "4");
    CHECK(session.ask("SELECT count(DISTINCT plan_position) FROM trial WHERE outcome = "
                      "'complete'") == "4");
    CHECK(session.ask("SELECT unanswered FROM session_health") ==
          session.ask("SELECT count(*) - 4 FROM trial"));
    const tests::Finished verify = tests::palpate_command({"verify", file});
    CAPTURE(verify.out);
    CHECK(verify.code == 0);
}
