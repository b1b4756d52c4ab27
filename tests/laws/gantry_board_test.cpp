#include "protocols/library/shipped.hpp"
#include "tests/support/child.hpp"
#include "tests/support/free_board.hpp"
#include "tests/support/program.hpp"
#include "tests/support/short_text.hpp"
#include "tests/support/sql_first.hpp"

// The shipped program on a board of three axes, its firmware behind a pseudo-terminal, from
// outside.

namespace {

constexpr const char* kGantry = PALPATE_SOURCE_DIR "/examples/gantry.toml";

/// Two patches of the shipped study: a hand that strokes across one is pressed somewhere on every
/// stroke.
std::string two_patches(int repetitions) {
    std::string text = short_text("patch_friction", {});
    const std::size_t concave = text.find("[[object]]\nname = \"concave\"");
    text.erase(concave, text.find("[[friction]]\nname = \"on\"") - concave);
    return edited(text, {{"repetitions = 5", "repetitions = " + std::to_string(repetitions)},
                         {"max_run_friction = 3", "max_run_friction = 0"},
                         {"practice_repetitions = 1", "practice_repetitions = 0"},
                         {"explore_min_s = 2", "explore_min_s = 0.5"},
                         {"gap_s = 1.5", "gap_s = 0"},
                         {"[safety]\n", "[safety]\nlate_in_a_row = 0\nlate_of_100 = 0\n"}});
}

/// The emulated board, typed to, and a session in a window on it.
struct Desk {
    /// @param wired  how the machine is in truth, a calibration
    explicit Desk(const std::string& wired = kGantry, int repetitions = 20)
        : board(folder, "--open --preset '" + wired + "'"),
          session(run_words(write(folder.file("p.toml"), two_patches(repetitions)),
                            "P1",
                            file,
                            {"--device", board.word(), "--calibration", kGantry, "--windowed"})) {
        session.press_at("welcome", "space");
    }
    /// What the motors give now, as the board says, N at the handle.
    [[nodiscard]] engine::Vec3 motors() {
        const Words mn_m = split(board.motors());
        REQUIRE(mn_m.size() == 3);
        return {std::stod(mn_m[0]) / 10.0, std::stod(mn_m[1]) / 10.0,
                std::stod(mn_m[2]) / 10.0};  // a drum of 10 mm
    }
    /// Explores until the hand is pressed by so much, N.
    [[nodiscard]] bool feel(double force = 0.3) {
        return session.goes_on_until(
            [&] { return session.screen_name() == "explore" && glm::length(motors()) > force; });
    }
    /// Explores each trial for some seconds and answers. A busy machine may fault a trial: it is
    /// run again.
    [[nodiscard]] bool finishes() {
        int felt = 0;
        return session.goes_on_until([&] {
            const bool explores = session.screen_name() == "explore";
            felt = !explores ? 0 : felt > 0 || glm::length(motors()) > 0.3 ? felt + 1 : 0;
            if (felt > 70) {
                press_on(session.hand());
            }
            return session.ask("SELECT finished FROM session") == "1";
        });
    }
    /// Trials that ended by one of these, as "'runaway', 'energy'".
    [[nodiscard]] bool faulted(const std::string& causes) const {
        return session.ask("SELECT count(*) > 0 FROM trial WHERE fault_cause IN (" + causes +
                           ")") == "1";
    }
    /// Explores until a trial has ended so, for some seconds; a busy machine may end one for
    /// another reason.
    [[nodiscard]] bool ends_by(const std::string& causes, int looks) {
        return session.goes_on_until([&] { return faulted(causes) || --looks < 0; }) &&
               faulted(causes);
    }
    /// Kills the session: what it recorded until then is what the board counted.
    void kill() {
        session.program().signal(SIGKILL);
        static_cast<void>(session.finish());
        ran({"verify", file});
    }
    [[nodiscard]] bool force_ends() {
        return eventually([&] { return motors() == engine::Vec3{}; });
    }

    TemporaryFolder folder;
    std::string file = folder.file("d.sqlite");
    TypedBoard board;
    WindowSession session;
};

}  // namespace

TEST_CASE("patches are felt through a board of three axes, from its pins to the database and back",
          "[window][open]") {
    Desk desk(kGantry, 1);
    REQUIRE(desk.finishes());
    const std::string& file = desk.file;
    CHECK_THAT(ran({"verify", file}).out, Has("Nothing differs"));
    // HIP is computed again from the counts: with another drum they say another place.
    const std::string other = copied(file, desk.folder.file("other.sqlite"));
    sql_edit(other,
             "UPDATE session_provenance SET value = replace(value, '[gantry.axis_z]\nradius_mm = "
             "10', '[gantry.axis_z]\nradius_mm = 10.1') WHERE key = 'calibration'");
    CHECK_THAT(ran({"verify", other}, 1).out, Has("trace.hip"));
    check_truths(file, "gantry_truths.tsv");
    // The recorded hands are felt again, tick by tick the same.
    const std::string again = desk.folder.file("again.sqlite");
    ran(run_words(desk.folder.file("p.toml"), "P1", again,
                  {"--headless", "--device", "replay:" + file}));
    ran({"verify", again});
}

TEST_CASE("a host that is killed with its guard leaves no force on any of three motors",
          "[window][open][safety]") {
    Desk desk;
    REQUIRE(desk.feel());
    CHECK(desk.motors().z > 0.1);
    const pid_t guard = guard_of(desk.session.program().id());
    REQUIRE(guard > 0);
    kill(guard, SIGSTOP);
    kill(desk.session.program().id(), SIGKILL);
    kill(guard, SIGKILL);
    CHECK(desk.force_ends());
    for (int i = 0; i < 20; ++i) {
        CHECK(desk.motors() == engine::Vec3{});
        pause(0.01);
    }
}

TEST_CASE("a board of three axes that is gone under a force ends the trial, and its file verifies",
          "[window][open][safety]") {
    Desk desk;
    REQUIRE(desk.feel());
    desk.board.signal(SIGKILL);
    CHECK(desk.ends_by("'device_lost', 'device_silent'", 400));
    desk.kill();
}

TEST_CASE("a third motor that pulls the wrong way is ended with its cause, and leaves no force",
          "[window][open][safety]") {
    const TemporaryFile file("wired.toml");
    write(file, replaced(slurp(kGantry), "motor_z = \"forward\"", "motor_z = \"backward\""));
    Desk desk(file);
    CHECK(desk.ends_by("'runaway', 'energy', 'over_speed'", 1200));
    CHECK(desk.force_ends());
    desk.kill();
}

TEST_CASE("a third encoder whose cable comes out under a force ends it, and no force is left",
          "[window][open][safety]") {
    // A busy machine may end the trial for another reason while the cable is out: then the proof of
    // the rig refuses the next trial, and another session is begun.
    CHECK(tried(6, [] {
        Desk desk;
        const bool felt = desk.feel(1.0);
        desk.board.type("unplug 3");
        const bool found = felt && desk.ends_by("'stuck_encoder'", 100);
        CHECK(desk.force_ends());
        desk.kill();
        return found;
    }));
}

TEST_CASE("check says of a workspace that does not hold the patch what cannot be reached",
          "[open]") {
    const TemporaryFolder folder;
    write(folder.file("narrow.toml"),
          replaced(slurp(kGantry), "high_mm = 60\nhome_mm = 40", "high_mm = 25\nhome_mm = 20"));
    const TypedBoard board(folder, "--open --preset '" + folder.file("narrow.toml") + "'");
    std::string said;
    for (int i = 0; i < 10 && said.find("cannot reach") == std::string::npos; ++i) {
        said = palpate_command({"check", "patch_friction", "--device", board.word(),
                                "--calibration", folder.file("narrow.toml")})
                   .out;  // a busy machine may leave the board without its turn
    }
    CHECK_THAT(said, Has("the handle cannot reach the start pose (0.0, 0.0, 40.0) mm"));
}
