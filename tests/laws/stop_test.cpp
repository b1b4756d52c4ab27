#include "data/store/database.hpp"
#include "tests/support/program.hpp"
#include "tests/support/stop_ways.hpp"
#include "tests/support/studies.hpp"

// Ways to stop a force that need no window's focus, and windows out of reach, tried on the program
// itself: a real window, a board on a pseudo-terminal with a hand that presses, the experimenter's
// terminal, another shell and a pipe in place of a button. Nothing is asserted about time.

namespace {

/// A force that one way after the other ends, and the experimenter's chord after each.
class StoppedDesk {
public:
    StoppedDesk(const Terminal& terminal, const std::string& button)
        : desk_(PressingHand::Does::presses,
                {std::string(kTerminal) + "=" + terminal.name()},
                false,
                {"--stop-button", button}) {}

    /// Feels an object, does what ends it, and looks at what came of it.
    void ends(const std::string& way, const std::string& cause, const std::function<void()>& act) {
        CAPTURE(way);
        REQUIRE(desk_.feel());
        const std::string before = stops(way);
        act();
        CHECK(desk_.force_ends());
        CHECK(desk_.stays_off());
        desk_.session->wait_for_screen("trouble");
        desk_.session->hand().release("space");
        CHECK(stops(way) != before);
        CHECK(desk_.session->ask("SELECT trial.fault_cause FROM event JOIN trial USING (trial_id) "
                                 "WHERE event_kind = 'stop' ORDER BY event_id DESC LIMIT 1") ==
              cause);
    }
    /// Space does not go on, the chord does.
    void goes_on() {
        session().wait_for_screen("trouble");
        pause(0.3);
        session().hand().focus(session().hand().find_window("palpate: "));
        session().hand().key("space");
        pause(0.3);
        CHECK(session().screen_name() == "trouble");
        desk_.goes_on();
    }
    [[nodiscard]] std::string stops(const std::string& way) const {
        return desk_.session->ask(
            "SELECT count(*) FROM event WHERE event_kind = 'stop' AND value = '" + way + "'");
    }
    [[nodiscard]] WindowSession& session() { return *desk_.session; }
    [[nodiscard]] XHand::Window window() { return session().hand().find_window("palpate: "); }
    [[nodiscard]] PressedDesk& desk() { return desk_; }

private:
    PressedDesk desk_;
};

}  // namespace

TEST_CASE(
    "whoever takes the window away, types at the terminal, calls from a shell or presses the "
    "button ends the force, and the experimenter's chord alone goes on",
    "[window][haply][safety]") {
    const TemporaryFolder folder;
    const Terminal terminal;
    StopButton button(folder.file("button"));
    StoppedDesk stopped(terminal, folder.file("button"));
    PressedDesk& desk = stopped.desk();
    XHand& hand = stopped.session().hand();

    stopped.ends("keyboard elsewhere", "focus_lost", [&] { hand.take_keyboard_away(); });
    stopped.goes_on();
    CHECK_FALSE(terminal.can_be_held());
    stopped.ends("terminal", "stopped", [&] { terminal.type("\x1b"); });
    stopped.goes_on();
    stopped.ends("terminal", "stopped", [&] { terminal.type("\n"); });
    stopped.goes_on();
    stopped.ends("palpate stop", "stopped", [&] {
        CHECK_THAT(ran({"stop", desk.file}).out,
                   Has("No force any more in 1 session", "participant P1"));
    });
    stopped.goes_on();
    stopped.ends("stop button", "stopped", [&] { button.send(1); });
    pause(0.3);  // and is still held
    hand.chord("p");
    pause(1.0);
    CHECK(stopped.session().screen_name() == "trouble");
    button.send(0);
    stopped.goes_on();
    stopped.ends("window to be closed", "focus_lost", [&] { hand.ask_to_close(stopped.window()); });
    CHECK_THAT(stopped.session().program().out(), Has("was to be closed, and stays"));
    stopped.goes_on();

    // Between trials: no force until the chord, and no trial has begun.
    const std::string begun = stopped.session().ask("SELECT count(*) FROM trial");
    ran({"stop", desk.file});
    stopped.goes_on();
    hand.ask_to_close(stopped.window());  // nothing comes of it
    pause(0.3);
    CHECK(stopped.session().screen_name() == "ready");
    const auto at_ready = [&] {  // a busy machine may lose the board meanwhile
        if (stopped.session().screen_name() == "trouble") {
            desk.goes_on();
        }
        return hand.pixels(stopped.window(), 0.8);  // below the mark, which follows the hand
    };
    std::uint64_t before = 0;
    CHECK(eventually([&] {
        pause(0.5);
        const std::uint64_t now = at_ready();
        return std::exchange(before, now) == now;
    }));
    hand.take_keyboard_away();
    CHECK(eventually([&] { return hand.pixels(stopped.window(), 0.8) != before; }));  // it says so
    hand.focus(stopped.window());
    CHECK(eventually([&] { return at_ready() == before; }));
    CHECK(stopped.session().ask("SELECT count(*) FROM trial") == begun);

    // One that hangs is said to, and stops when it goes on.
    stopped.session().program().signal(SIGSTOP);
    CHECK_THAT(ran({"stop", desk.file}, 1).error, Has("1 session did not answer"));
    stopped.session().program().signal(SIGCONT);
    stopped.goes_on();
    CHECK(stopped.session().ask("SELECT count(*) FROM trial") == begun);

    // A button that is gone: no force, whatever anybody presses, until it is there again.
    stopped.ends("stop button gone", "stopped", [&] { button.unplug(); });
    hand.chord("p");
    pause(1.0);
    CHECK(stopped.session().screen_name() == "trouble");
    button.plug_in();
    stopped.session().wait_for_text("The stop button is there again");
    stopped.goes_on();

    REQUIRE(desk.feel());
    hand.hide(stopped.window());
    CHECK(desk.force_ends());
    CHECK(desk.stays_off());
    CHECK(stopped.session().program().ended_by(SIGTERM) == 3);
    CHECK(terminal.as_before());
    ran({"stop", desk.file}, 1);
    ran({"verify", desk.file});
}

TEST_CASE(
    "on the pointer, too, a keyboard that goes elsewhere ends a trial until the chord goes on",
    "[window][safety]") {
    EACH(size, as<std::string>{}, "--windowed", "--fullscreen");
    PointerSession session(four_trials(), {size});
    XHand& hand = session.hand();
    session.go_through({"welcome", "ready"});
    session.wait_for_screen("explore");
    hand.take_keyboard_away();
    session.wait_until("SELECT fault_cause FROM trial", "focus_lost");
    session.wait_for_screen("trouble");
    session.wait_for_text("can go on: Ctrl+Shift+P at the participant's screen");
    hand.focus(hand.find_window("palpate: "));
    pause(0.3);
    hand.key("space");
    pause(0.5);
    CHECK(session.screen_name() == "trouble");
    leave_trouble(hand);
    session.wait_for_screen("ready");
    CHECK(session.ask("SELECT count(*) FROM trial") == "1");
    CHECK(session.program().ended_by(SIGTERM) == 3);
}

TEST_CASE("Escape holds a session on any screen, and a question without its keys is noted",
          "[window][safety]") {
    PointerSession session(four_trials(), {"--windowed"});
    XHand& hand = session.hand();
    const auto stops = [&](const char* screen) {
        CAPTURE(screen);
        session.wait_for_screen(screen);
        pause(0.3);
        hand.key("Escape");
        pause(0.3);
    };
    const auto goes_on = [&](const std::string& count) {
        session.wait_for_screen("trouble");
        session.wait_until("SELECT count(*) FROM event WHERE event_kind = 'stop'", count);
        hand.key("space");
        pause(0.3);
        CHECK(session.screen_name() == "trouble");
        leave_trouble(hand);
    };
    session.press_at("welcome", "space");
    stops("ready");
    goes_on("1");
    CHECK(session.ask("SELECT count(*) FROM trial") == "0");
    session.press_at("ready", "space");
    session.wait_for_screen("explore");
    pause(0.7);
    session.press_at("explore", "space");
    stops("question");  // it keeps its answer
    hand.take_keyboard_away();
    pause(1.0);
    hand.focus(hand.find_window("palpate: "));
    pause(0.3);
    session.press_at("question", "1");
    goes_on("2");
    CHECK(session.ask("SELECT outcome FROM trial") == "complete");
    CHECK(session.ask("SELECT count(*) FROM event WHERE key = 'question away' AND trial_id = 1 AND "
                      "duration_s BETWEEN 0.8 AND (SELECT reaction_s FROM response)") == "1");
    session.wait_for_text("the keyboard with another window: its answer is kept");
    CHECK(session.program().ended_by(SIGTERM) == 3);
    ran({"verify", session.database()});
}

// With those that have boards: palpate stop asks a rig that is being commissioned, too.
TEST_CASE("without a window, too, palpate stop, Enter and Escape at the terminal end the force",
          "[open][safety]") {
    const TemporaryFolder folder;
    const Terminal terminal;
    const StopButton button(folder.file("button"));  // a session with one listens without a window
    const std::string file = folder.file("d.sqlite");
    Process session({palpate_program(), "run", kFourTrials, "--participant", "P1", "--db", file,
                     "--headless", "--speed", "0.2", "--stop-button", folder.file("button")},
                    {std::string(kTerminal) + "=" + terminal.name()});
    REQUIRE(session.says("If it ends early"));
    data::Database database(file, data::Access::read);
    const auto ends = [&](const std::string& way, const std::function<void()>& act) {
        CAPTURE(way, session.out(), session.error());
        REQUIRE(eventually([&] { return count(database, "trial WHERE outcome = 'running'") > 0; }));
        const std::string stops =
            "event JOIN trial USING (trial_id) WHERE event_kind = 'stop' AND value = '" + way +
            "' AND fault_cause = 'stopped'";
        const std::int64_t before = count(database, stops);
        act();
        CHECK(eventually([&] { return count(database, stops) > before; }));
    };
    ends("palpate stop", [&] {
        Finished stopped;
        if (geteuid() == 0) {  // another user stops what they may write to, and nothing else
            const auto as_nobody = [&](unsigned mode) {
                for (const char* beside : {"", "-wal"}) {  // SQLite's log is made with the file's
                    std::filesystem::permissions(file + beside, std::filesystem::perms{mode});
                }
                return Process({"runuser", "-u", "nobody", "--", palpate_program(), "stop", file})
                    .wait();
            };
            std::filesystem::permissions(folder.path(), std::filesystem::perms{0755});
            check_end(as_nobody(0644), 1, Has("only who may write to it, or runs it"));
            stopped = as_nobody(0666);
        } else {
            stopped = palpate_command({"stop", file});
        }
        CHECK_THAT(stopped.out, Has("No force any more in 1 session"));
    });
    ends("terminal", [&] { terminal.type("\n"); });
    ends("terminal", [&] { terminal.type("\x1b"); });
    check_end(session.wait(), 1, Has("3 faults in a row"));  // nobody is there
    CHECK(terminal.as_before());
}

TEST_CASE("a stop in a break or a pause is shown at once, and one chord goes on", "[window]") {
    PointerSession session(replaced(four_trials(), "break_every = 0", "break_every = 1"));
    const auto stopped = [&] {
        ran({"stop", session.database()});
        session.wait_for_screen("trouble");
        pause(0.3);
        session.hand().chord("p");
        session.wait_for_screen("ready");
        pause(0.5);
        CHECK(session.screen_name() == "ready");
    };
    session.go_through({"welcome", "ready", "explore"});
    session.press_at("question", "1");
    session.wait_for_screen("break");
    stopped();
    session.hand().chord("p");
    session.wait_for_screen("pause");
    stopped();
    CHECK(session.ask("SELECT count(*) FROM event WHERE event_kind = 'stop'") == "2");
    CHECK(session.ask("SELECT count(*) FROM event WHERE event_kind = 'go on' AND text LIKE "
                      "'after a pause%'") == "0");
    CHECK(session.program().ended_by(SIGTERM) == 3);
}
