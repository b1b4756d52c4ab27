#include "tests/support/free_board.hpp"
#include "tests/support/program.hpp"
#include "tests/support/short_text.hpp"

// Where a trial begins, and how a question ends that nobody answers: the shipped program in a
// window.

namespace {

/// A pilot on a board, of a study as it is but for a busy machine.
struct Gated : WindowSession {
    Gated(const TemporaryFolder& folder,
          const FreeBoard& board,
          const std::string& study,
          const std::string& calibration = "2diy_gen3")
        : WindowSession(run_words(written(folder, study),
                                  "P1",
                                  folder.file("d.sqlite"),
                                  {"--device", board.word(), "--calibration", calibration, "--kind",
                                   "pilot", "--windowed"})) {
        press_at("welcome", "space");
    }
    static std::string written(const TemporaryFolder& folder, const std::string& study) {
        std::string text =
            all_replaced(study, "stiffness_n_per_m = 1000", "stiffness_n_per_m = 200");
        text += text.find("[safety]\n") == std::string::npos ? "\n[safety]\n" : "";
        return write(
            folder.file("p.toml"),
            replaced(text, "[safety]\n", "[safety]\nlate_in_a_row = 0\nlate_of_100 = 0\n"));
    }
};

/// Presses Space at Ready for some time. @return nothing began
bool stays_ready(WindowSession& session) {
    std::string screen;
    for (int tries = 0; tries < 6 && screen != "ready"; ++tries) {
        if (!session.comes_to("ready")) {
            continue;
        }
        for (int i = 0; i < 5; ++i) {
            session.hand().key("space");
            pause(0.3);
        }
        screen = session.screen_name();
        if (screen != "trouble") {
            break;
        }
    }
    return screen == "ready" && session.ask("SELECT count(*) FROM trial") == "0";
}

/// Presses Space at Ready. @return a trial began
bool begins(WindowSession& session) {
    return session.goes_on_until([&] { return session.screen_name() == "explore"; });
}

}  // namespace

TEST_CASE("a trial begins with the handle at the start, and nowhere else", "[window][haply]") {
    const TemporaryFolder folder;
    FreeBoard board(folder);
    const std::string file = folder.file("d.sqlite");
    Gated session(folder, board, four_trials());
    CHECK(stays_ready(session));  // at home, 29 mm away
    board.bring("0,20");          // inside all of them
    CHECK(stays_ready(session));
    board.bring("0,66");
    CHECK(stays_ready(session));
    board.bring("3,61");
    CHECK(begins(session));
    session.hand().key("Escape");
    session.wait_until("SELECT count(*) > 0 FROM trial WHERE outcome = 'faulted'", "1");
    for (const Words& second :  // the port has its program
         {run_words(folder.file("p.toml"), "P2", folder.file("second.sqlite"), {"--kind", "pilot"}),
          Words{"commission", "--handle-free", "-o", folder.file("second.sqlite")}}) {
        check_end(unseen(joined(second, {"--device", board.word(), "--calibration", "2diy_gen3"})),
                  1, Has("in use by another program, palpate"));
    }
    CHECK_FALSE(std::filesystem::exists(folder.file("second.sqlite")));
    CHECK(session.ask("SELECT min(abs(start_x_m - 0.003) < 0.0005 AND abs(start_y_m - 0.061) < "
                      "0.0005) FROM presentation") == "1");
    session.program().signal(SIGTERM);
    CHECK_THAT(ended(session.finish(), 3).out, Has("four_trials: pilot, participant P1"));
    // It is a pilot: that is said before another device is looked for.
    const std::string rig = commissioned_rig(folder, "haply:/nonexistent");
    const Words as_real = run_words(folder.file("p.toml"), "P1", file,
                                    {"--device", "haply:/nonexistent", "--calibration", rig});
    check_end(unseen(as_real), 2,
              Has("is a pilot session; it cannot go on as real", "--kind it was begun with",
                  "--session 2"));
}

TEST_CASE("in a ring that reaches into an object no trial begins where it does",
          "[window][haply]") {
    const TemporaryFolder folder;
    FreeBoard board(folder);
    Gated session(folder, board,
                  replaced(four_trials(), "stiffness_n_per_m = 1000",
                           "start_radius_mm = 60\nstiffness_n_per_m = 1000"));
    board.bring("0,20");
    CHECK(stays_ready(session));
    board.bring("0,66");
    CHECK(begins(session));
    CHECK(session.ask("SELECT count(value) FROM session_provenance WHERE key LIKE 'SDL2%'") == "2");
    CHECK(session.program().ended_by(SIGTERM) == 3);
}

TEST_CASE(
    "at the second interval, too, the handle comes to the start, and a board that is gone says",
    "[window][haply]") {
    const TemporaryFolder folder;
    auto board = std::make_unique<FreeBoard>(folder);
    Gated session(folder, *board, short_text("softness_2afc"));
    const auto replugged = [&] {
        const std::string back =
            session.ask("SELECT count(*) FROM event WHERE event_kind = 'reconnect'");
        board->signal(SIGKILL);  // one that ends in its own time is silent before
        unplug(folder, board);
        session.wait_for_screen("trouble");
        board = std::make_unique<FreeBoard>(folder);
        session.wait_until("SELECT count(*) > " + back +
                               " FROM event WHERE event_kind = "
                               "'reconnect'",
                           "1");
    };
    session.wait_for_screen("ready");
    replugged();
    leave_trouble(session.hand());
    CHECK(session.ask("SELECT count(*) FROM trial") == "0");
    CHECK(session.ask("SELECT count(*) FROM event WHERE event_kind = 'fault' AND value = "
                      "'device_lost' AND trial_id IS NULL") == "1");
    REQUIRE(tried(6, [&] {  // a busy machine may end it
        board->bring("0,60");
        REQUIRE(begins(session));
        board->bring("0,66");  // where it is left
        pause(2.5);            // no trial is over sooner
        session.hand().key("space");
        return session.comes_to("ready");
    }));
    const std::string begun = session.ask("SELECT count(*) FROM presentation");
    for (int i = 0; i < 5; ++i) {
        session.hand().key("space");
        pause(0.2);
    }
    CHECK(session.screen_name() == "ready");
    CHECK(session.ask("SELECT count(*) FROM presentation") == begun);
    replugged();  // before the second interval
    leave_trouble(session.hand());
    CHECK(session.ask("SELECT outcome || ' ' || (fault_cause LIKE 'device_%') FROM trial ORDER BY "
                      "trial_id DESC LIMIT 1") == "faulted 1");
    board->bring("1,58");
    CHECK(begins(session));
    CHECK(session.program().ended_by(SIGTERM) == 3);
    CHECK(session.ask("SELECT abs(start_x_m - 0.001) < 0.0005 AND abs(start_y_m - 0.058) < 0.0005 "
                      "FROM presentation ORDER BY trial_id DESC, interval DESC LIMIT 1") == "1");
    ran({"verify", session.database()});
}

TEST_CASE("in space a trial begins within the start's radius, in each direction",
          "[window][open]") {
    const TemporaryFolder folder;
    constexpr const char* kGantry = PALPATE_SOURCE_DIR "/examples/gantry.toml";
    FreeBoard board(folder, std::string("--open --preset '") + kGantry + "'");
    Gated session(folder, board, short_text("patch_friction"), kGantry);
    for (const char* beside : {"8,0,40", "0,-8,40", "0,0,48"}) {
        CAPTURE(beside);
        board.bring(beside);
        CHECK(stays_ready(session));
    }
    board.bring("1,-1,42");
    CHECK(begins(session));
    CHECK(session.program().ended_by(SIGTERM) == 3);
}

TEST_CASE("a question that nobody answers ends, and its trial runs again", "[window]") {
    PointerSession session(
        edited(four_trials(), {{"explore_min_s = 0.5", "explore_min_s = 0.1"},
                               {"gap_s = 0.1", "gap_s = 0.1\nanswer_timeout_s = 3"}}));
    session.go_through({"welcome", "ready", "explore"});
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
    ran({"verify", session.database()});
}
