#include "tests/support/adaptive.hpp"
#include "tests/support/child.hpp"
#include "tests/support/program.hpp"
#include "tests/support/window_session.hpp"

// The experimenter's desk while the shipped program runs a session in a window: what its chords
// leave in the database, and that nothing begins without a press.

namespace {

/// A session in which every key is pressed as often as it takes, and never while another screen
/// comes.
class Desk {
public:
    Desk(const TemporaryFolder& folder, const std::string& protocol, const std::string& device)
        : session_(run_words(write(folder.file("p.toml"), protocol),
                             "P1",
                             folder.file("d.sqlite"),
                             {"--device", device, "--kind", "pilot"})) {}

    void at(const std::string& screen, const std::string& key) {
        session_.wait_for_screen(screen);
        for (int tries = 0; tries < 20; ++tries) {
            pause(0.35);
            session_.hand().key(key);
            for (int i = 0; i < 100; ++i) {
                if (!session_.program().running() || session_.screen_name() != screen) {
                    return;
                }
                pause(0.03);
            }
        }
        FAIL("the screen \"" << screen << "\" stays");
    }
    void go_through(std::initializer_list<const char*> screens) {
        for (const char* screen : screens) {
            at(screen, "space");
        }
    }
    void pause_at(const std::string& screen) {
        session_.wait_for_screen(screen);
        pause(0.3);
        session_.hand().chord("p");
    }
    void mark_at(const std::string& screen) {
        session_.wait_for_screen(screen);
        pause(0.3);
        session_.hand().chord("m");
        pause(0.2);
        session_.hand().key("y");
        pause(0.2);
    }
    /// The pause has come for the `nth` time; ends it, and Ready waits for a press.
    void end_pause(int nth) {
        session_.wait_for_screen("pause");
        session_.wait_until(count("event WHERE event_kind = 'pause'"), std::to_string(nth));
        session_.wait_for_text("pause: Ctrl+Shift+P at the participant's screen goes on");
        session_.hand().key("space");  // nobody but the experimenter goes on
        pause(0.3);
        CHECK(session_.screen_name() == "pause");
        session_.hand().chord("p");
        session_.wait_until(
            count("event WHERE event_kind = 'go on' AND text LIKE 'after a pause%'"),
            std::to_string(nth));
        session_.wait_for_text("the pause is over");
        stays_ready();
    }
    /// No force without a press.
    void stays_ready() {
        session_.wait_for_screen("ready");
        const std::string begun = session_.ask(count("trial"));
        pause(0.7);
        CHECK(session_.screen_name() == "ready");
        CHECK(session_.ask(count("trial")) == begun);
    }
    void wait_for(const std::string& rows, int n) {
        session_.wait_until(count(rows), std::to_string(n));
    }
    /// The experimenter ends the session, and asks again where a fault took the question away.
    void stop() {
        for (int tries = 0; tries < 20 && session_.program().running(); ++tries) {
            session_.hand().chord("q");
            pause(0.3);
            session_.hand().key("y");
            for (int i = 0; i < 100 && session_.program().running(); ++i) {
                pause(0.03);
            }
        }
        ended(session_.finish(), 3);
    }
    [[nodiscard]] WindowSession& session() { return session_; }

    static std::string count(const std::string& rows) { return "SELECT count(*) FROM " + rows; }

private:
    WindowSession session_;
};

/// Two intervals, as the board can render them, on a machine that has other things to do.
std::string board_study() {
    return edited(adaptive_text(kStaircaseRule),
                  {{"start_mm = [0, 45]",
                    "start_mm = [0, 60]\nstart_radius_mm = 0\nstiffness_n_per_m = 200\n"
                    "force_limit_n = 1.5\n[safety]\nlate_in_a_row = 0\nlate_of_100 = 0"},
                   {"path_min_mm = 0", "path_min_mm = 0\nlate_share = 1"},
                   {"explore_prompt_s = 0.2\nexplore_timeout_s = 0.3",
                    "explore_prompt_s = 30\nexplore_timeout_s = 60"}});
}

constexpr const char* kMarked = "trial WHERE invalid_reason LIKE 'marked by the experimenter%'";

}  // namespace

TEST_CASE("pauses and marks on every screen of a session with the pointer are obeyed",
          "[long][window]") {
    const TemporaryFolder folder;
    Desk desk(folder,
              edited(four_trials(), {{"break_every = 0", "break_every = 1"},
                                     {"explore_min_s = 0.5", "explore_min_s = 0.1"}}),
              "mouse");
    desk.pause_at("welcome");
    desk.at("welcome", "space");
    desk.end_pause(1);
    desk.pause_at("ready");
    desk.end_pause(2);
    const auto window = desk.session().wait_for_screen("ready");
    const auto edge = [&] {
        return desk.session().hand().pixels(window, 0.9);
    };
    const auto plain = edge();
    desk.session().hand().chord("m");
    CHECK(eventually([&] { return edge() != plain; }));
    pause(0.3);
    const auto asked = edge();
    desk.session().hand().key("y");
    desk.wait_for("event WHERE event_kind = 'note' AND text LIKE '%no answer that counts'", 1);
    desk.session().wait_for_text("nothing to mark");
    CHECK(eventually([&] {  // the answer stands where the question was
        const auto now = edge();
        pause(0.1);
        return now != plain && now != asked && now == edge();
    }));
    desk.stays_ready();

    desk.at("ready", "space");
    desk.mark_at("explore");
    desk.pause_at("explore");
    desk.at("explore", "space");
    desk.at("question", "1");
    desk.end_pause(3);
    desk.wait_for(kMarked, 1);
    desk.session().wait_for_text("trial 1 of 4 #1 is marked: it does not count and runs again");

    desk.go_through({"ready", "explore"});
    desk.mark_at("question");
    desk.pause_at("question");
    desk.pause_at("question");  // not after all
    desk.at("question", "1");
    desk.wait_for(kMarked, 2);
    desk.stays_ready();

    desk.go_through({"ready", "explore"});
    desk.at("question", "2");
    const auto waits_for = [&](const char* trial) {
        const Finished said = ran({"status", folder.file("d.sqlite")});
        return said.out.find(std::string("a break before ") + trial) != std::string::npos;
    };
    desk.session().wait_for_screen("break");
    CHECK(eventually([&] { return waits_for("trial 2 of 4"); }));
    desk.mark_at("break");
    desk.session().wait_for_text("ATTENTION: 3 of the last 3 trials do not count");
    CHECK(waits_for("trial 1 of 4"));
    desk.pause_at("break");
    desk.at("break", "space");
    desk.end_pause(4);
    desk.wait_for(kMarked, 3);

    while (desk.session().screen_name() == "ready") {  // each position, until it counts
        desk.go_through({"ready", "explore"});
        desk.at("question", "1");
        desk.session().wait_past("gap");
        if (desk.session().screen_name() == "break") {
            desk.at("break", "space");
        }
        desk.session().wait_past("gap");
    }
    desk.mark_at("end");
    desk.at("end", "space");
    ended(desk.session().finish());
    CHECK(desk.session().ask(Desk::count("trial")) == "7");
    CHECK(desk.session().ask(Desk::count(kMarked)) == "3");
    CHECK(desk.session().ask(Desk::count("event WHERE event_kind = 'pause'")) == "4");
    CHECK(desk.session().ask("SELECT count(DISTINCT plan_position) FROM trial WHERE invalid_reason "
                             "IS NULL AND outcome = 'complete'") == "4");
    ran({"verify", folder.file("d.sqlite")});
}

TEST_CASE("so are those between two intervals, at the confidence and in trouble",
          "[long][window]") {
    const TemporaryFolder folder;
    Desk desk(folder, board_study(), "sim");
    desk.at("welcome", "space");
    desk.pause_at("ready");
    desk.end_pause(1);

    desk.go_through({"ready", "explore"});
    desk.session().wait_for_screen("ready");  // of the second interval: the trial has begun
    desk.pause_at("ready");
    pause(0.7);
    CHECK(desk.session().screen_name() == "ready");
    desk.go_through({"ready", "explore"});
    desk.at("question", "1");
    desk.mark_at("confidence");
    desk.at("confidence", "2");
    desk.end_pause(2);
    desk.wait_for(kMarked, 1);
    desk.wait_for("presentation", 2);

    desk.at("ready", "space");
    desk.at("explore", "Escape");
    desk.mark_at("trouble");
    desk.wait_for("event WHERE event_kind = 'reconnect'", 1);
    pause(0.5);
    desk.session().hand().key("space");
    pause(0.3);
    CHECK(desk.session().screen_name() == "trouble");
    desk.session().hand().chord("p");
    desk.wait_for("event WHERE event_kind = 'note' AND text LIKE '%no answer that counts'", 1);
    desk.session().wait_for_text("nothing to mark");
    desk.stays_ready();
    desk.wait_for("event WHERE event_kind = 'pause'", 2);

    desk.stop();
    ran({"verify", folder.file("d.sqlite")});
}

TEST_CASE("on a board a pause and a mark before the first trial begin no force",
          "[window][haply]") {
    const TemporaryFolder folder;
    const bool at_a_port = GENERATE(true, false);
    Process board({palpate_program(), "haply-emulator", "--link", folder.file("board")});
    REQUIRE(eventually([&] { return std::filesystem::exists(folder.file("board")); }));
    Desk desk(folder, board_study(),
              at_a_port ? "haply:" + folder.file("board") : "haply-emulator");
    desk.at("welcome", "space");
    desk.pause_at("ready");
    desk.end_pause(1);
    desk.mark_at("ready");
    desk.wait_for("event WHERE event_kind = 'note' AND text LIKE '%no answer that counts'", 1);
    desk.stays_ready();
    CHECK(desk.session().ask(Desk::count("trial")) == "0");
    desk.at("ready", "space");
    desk.wait_for("trial", 1);
    desk.stop();
}
