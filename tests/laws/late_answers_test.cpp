#include "tests/support/free_board.hpp"
#include "tests/support/pressed_desk.hpp"
#include "tests/support/program.hpp"

// What befalls a board and its wire while a session runs, done to the shipped program: an emulator
// that is typed to, a window, and the file.

namespace {

/// A session at a window, of a hand that explores for ever, and the emulator behind it.
class TypedRig {
public:
    /// @param open  an open board, in a simulated session of any force instead of a pilot's
    explicit TypedRig(bool open)
        : board_(folder_, open ? "--open" : ""),
          session_(joined(
              run_words(write(folder_.file("p.toml"),
                              replaced(pressed_study(), "dead_man = true", "dead_man = false")),
                        "P1",
                        file(),
                        {"--device", board_.word(), "--windowed"}),
              open ? Words{} : Words{"--kind", "pilot"})) {
        session_.go_through({"welcome", "ready"});
    }

    void type(const std::string& line) { board_.type(line); }
    [[nodiscard]] WindowSession& session() { return session_; }
    [[nodiscard]] std::string file() const { return folder_.file("d.sqlite"); }
    [[nodiscard]] std::string cause() {
        return session_.ask("SELECT fault_cause FROM trial ORDER BY trial_id DESC LIMIT 1");
    }

    /// Goes on, whatever a busy machine ends, until the motors give something.
    [[nodiscard]] bool feels() {
        return session_.goes_on_until(
            [&] { return session_.screen_name() == "explore" && !off(); });
    }
    /// The stronger motor's torque now, N m, as the emulator says.
    [[nodiscard]] double torque() {
        double one = 0.0;
        double two = 0.0;
        REQUIRE(std::sscanf(board_.motors().c_str(), "%lf, %lf", &one, &two) == 2);
        return 1e-3 * std::fmax(std::fabs(one), std::fabs(two));
    }
    [[nodiscard]] bool off() { return torque() == 0.0; }
    /// Ends, and stays so.
    [[nodiscard]] bool ends() {
        bool ended = eventually([&] { return off(); });
        for (int i = 0; i < 20 && ended; ++i) {
            ended = off();
            wait_a_little();
        }
        return ended;
    }

private:
    TemporaryFolder folder_;
    TypedBoard board_;
    WindowSession session_;
};

}  // namespace

TEST_CASE(
    "a session whose answers become late ends the force, and waits until they are quick again",
    "[window][haply]") {
    TypedRig rig(false);
    WindowSession& session = rig.session();
    session.wait_for_screen("explore");
    rig.type("delay 6");
    session.wait_until(
        "SELECT fault_cause IN ('delayed', 'device_silent') FROM trial ORDER BY trial_id DESC "
        "LIMIT 1",
        "1");
    session.wait_for_screen("trouble");
    for (int i = 0; i < 1500; ++i) {
        wait_a_little();
    }
    CHECK(session.ask("SELECT count(*) FROM event WHERE event_kind = 'reconnect'") == "0");
    rig.type("delay 0");
    session.wait_until("SELECT count(*) FROM event WHERE event_kind = 'reconnect'", "1");
    CHECK(rig.feels());
    CHECK(session.program().ended_by(SIGTERM) == 3);
}

TEST_CASE("a packet read as a reset, another program's torques and a turned angle end at zero",
          "[window][haply]") {
    TypedRig rig(false);
    // The motors keep what they had, and no longer know their address; torques that nobody here
    // asked for; an angle that is no whole count.
    for (const std::string befalls : {"misread", "stranger 200", "turned 0.03"}) {
        CAPTURE(befalls);
        REQUIRE(rig.feels());
        rig.type(befalls);
        rig.session().wait_for_screen("trouble");
        CHECK_THAT(rig.cause(), StartsWith("device_"));
        CHECK(rig.ends());
        rig.type("turned 0");
    }
    rig.session().wait_for_screen("trouble");
    rig.type("stranger 200");  // while the session waits
    CHECK(rig.ends());
    CHECK(rig.session().program().ended_by(SIGTERM) == 3);
    CHECK(rig.ends());
}

TEST_CASE("encoders that all stand still under a force end it, and a stopped program's ends, too",
          "[window][open]") {
    TypedRig rig(true);
    tried(5, [&] {  // more than encoders may stand still under
        REQUIRE(rig.feels());
        eventually([&] { return rig.torque() > 0.05 || rig.session().screen_name() != "explore"; });
        return rig.torque() > 0.05;
    });
    rig.type("unplug 1");
    rig.type("unplug 2");
    rig.session().wait_for_screen("trouble");
    CHECK(rig.cause() == "stuck_encoder");
    CHECK(rig.ends());
    rig.type("plug 1");
    rig.type("plug 2");

    REQUIRE(rig.feels());
    rig.session().program().signal(SIGSTOP);
    CHECK(rig.ends());
    rig.session().program().signal(SIGCONT);
    CHECK(rig.ends());  // nothing by itself
    rig.session().wait_for_screen("trouble");

    REQUIRE(rig.feels());
    rig.session().program().signal(SIGINT);
    CHECK(rig.ends());
    CHECK(rig.session().finish().code == 3);
    ran({"verify", rig.file()});
}
