#include "protocols/library/shipped.hpp"
#include "tests/support/child.hpp"
#include "tests/support/program.hpp"
#include "tests/support/rig_file.hpp"
#include "tests/support/short_text.hpp"
#include "tests/support/sql_first.hpp"
#include "tests/support/window_session.hpp"

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
        : emulator(folder, "keys", emulated(wired)) {
        emulator.type("motors");
        REQUIRE(eventually([&] { return std::filesystem::exists(folder.file("board")); }));
        write(folder.file("p.toml"), two_patches(repetitions));
        session = std::make_unique<WindowSession>(run_words(
            folder.file("p.toml"), "P1", file,
            {"--device", "board:" + folder.file("board"), "--calibration", kGantry, "--windowed"}));
        session->press_at("welcome", "space");
    }
    [[nodiscard]] std::string emulated(const std::string& wired) const {
        return "haply-emulator --open --preset '" + wired + "' --link '" + folder.file("board") +
               "'";
    }
    /// What the motors give now, as the board says, N at the handle.
    [[nodiscard]] engine::Vec3 motors() {
        const std::size_t before = emulator.program().out().size();
        emulator.type("motors");
        std::string said;
        REQUIRE(eventually([&] {
            said = emulator.program().out().substr(before);
            return said.find("motors") != std::string::npos && said.back() == '\n';
        }));
        engine::Vec3 mn_m{};
        const char* at = said.c_str() + said.find("give ") + 5;
        for (int i = 0; i < 3; ++i) {
            char* end = nullptr;
            mn_m[i] = std::strtod(at, &end);
            at = end + 1;
        }
        return mn_m / 10.0;  // a drum of 10 mm
    }
    /// Explores until the hand is pressed by so much, N.
    [[nodiscard]] bool feel(double force = 0.3) {
        return session->goes_on_until(
            [&] { return session->screen_name() == "explore" && glm::length(motors()) > force; });
    }
    /// Explores each trial for some seconds and answers. A busy machine may fault a trial: it is
    /// run again.
    [[nodiscard]] bool finishes() {
        int felt = 0;
        return session->goes_on_until([&] {
            const bool explores = session->screen_name() == "explore";
            felt = !explores ? 0 : felt > 0 || glm::length(motors()) > 0.3 ? felt + 1 : 0;
            if (felt > 70) {
                press_on(session->hand());
            }
            return session->ask("SELECT finished FROM session") == "1";
        });
    }
    /// Trials that ended by one of these, as "'runaway', 'energy'".
    [[nodiscard]] bool faulted(const std::string& causes) const {
        return session->ask("SELECT count(*) > 0 FROM trial WHERE fault_cause IN (" + causes +
                            ")") == "1";
    }
    /// Explores until a trial has ended so, for some seconds; a busy machine may end one for
    /// another reason.
    [[nodiscard]] bool ends_by(const std::string& causes, int looks) {
        return session->goes_on_until([&] { return faulted(causes) || --looks < 0; }) &&
               faulted(causes);
    }
    /// Kills the session: what it recorded until then is what the board counted.
    void kill() {
        session->program().signal(SIGKILL);
        static_cast<void>(session->finish());
        ran({"verify", file});
    }
    [[nodiscard]] bool force_ends() {
        return eventually([&] { return motors() == engine::Vec3{}; });
    }

    TemporaryFolder folder;
    std::string file = folder.file("d.sqlite");
    TypedTo emulator;
    std::unique_ptr<WindowSession> session;
};

}  // namespace

TEST_CASE("patches are felt through a board of three axes, from its pins to the database and back",
          "[window][open][gantry][law]") {
    Desk desk(kGantry, 1);
    REQUIRE(desk.finishes());
    const std::string& file = desk.file;
    const auto row = [&](const std::string& sql) {
        const std::string csv = sql_csv(file, sql);
        const std::size_t head = csv.find('\n') + 1;
        return csv.substr(head, csv.find_first_of("\r\n", head) - head);
    };
    const Finished verify = ran({"verify", file});
    CHECK_THAT(verify.out, Has("Nothing differs"));
    // HIP is computed again from the counts: with another drum they say another place.
    const std::string other = desk.folder.file("other.sqlite");
    std::filesystem::copy_file(file, other);
    sql_edit(other,
             "UPDATE session_provenance SET value = replace(value, '[gantry.axis_z]\nradius_mm = "
             "10', '[gantry.axis_z]\nradius_mm = 10.1') WHERE key = 'calibration'");
    CHECK_THAT(ran({"verify", other}, 1).out, Has("trace.hip"));
    CHECK(row("SELECT device LIKE 'open board gantry at %' FROM session") == "1");
    CHECK(row("SELECT count(*) FROM session_provenance WHERE key = 'board' AND value LIKE 'id %, "
              "firmware %, protocol 1.%'") == "1");
    CHECK(row("SELECT count(*) FROM session_provenance WHERE key = 'calibration' AND value LIKE "
              "'%[gantry.axis_z]%'") == "1");
    const std::string whole = " FROM sample JOIN trial USING (trial_id) WHERE fault_cause IS NULL";
    // HIP follows from counts: 10 mm of drum, 2400 a turn, home 40 mm up, in whole steps of 100 nm.
    CHECK(row("SELECT max(abs(hip_z_m - (0.040 + 0.010 * 6.283185307179586 / 2400 * count_3))) < "
              "0.51e-7 AND max(abs(hip_x_m - 0.010 * 6.283185307179586 / 2400 * count_1)) < "
              "0.51e-7 AND min(count_3) < -1500 AND max(count_1) - min(count_1) > 500 AND "
              "max(count_2) - min(count_2) > 500" +
              whole) == "1");
    CHECK(row("SELECT count(*) FROM trace_chunk WHERE holds LIKE '%hip%'") == "0");
    // F = K (GO - HIP) upwards, and the third motor was asked to: 0.8 codes a mN m of a drum of 10
    // mm, a tick later.
    CHECK(row("SELECT max(abs(rendered_z_n - 800 * (go_z_m - hip_z_m))) < 1e-9 AND "
              "max(rendered_z_n) > 1 AND min(hip_z_m) < -0.002 FROM sample WHERE mode <> "
              "'free'") == "1");
    CHECK(row("SELECT max(code_3) > 60 AND max(abs(code_3 - commanded_z_n * 10 / 120 * 800)) <= "
              "0.51" +
              whole) == "1");
    // The recorded hands are felt again, tick by tick the same.
    const std::string again = desk.folder.file("again.sqlite");
    ran(run_words(desk.folder.file("p.toml"), "P1", again,
                  {"--headless", "--device", "replay:" + file}));
    ran({"verify", again});
}

TEST_CASE("a host that is killed with its guard leaves no force on any of three motors",
          "[window][open][gantry][safety][law]") {
    Desk desk;
    REQUIRE(desk.feel());
    CHECK(desk.motors().z > 0.1);
    const pid_t guard = guard_of(desk.session->program().id());
    REQUIRE(guard > 0);
    kill(guard, SIGSTOP);
    kill(desk.session->program().id(), SIGKILL);
    kill(guard, SIGKILL);
    CHECK(desk.force_ends());
    for (int i = 0; i < 20; ++i) {
        CHECK(desk.motors() == engine::Vec3{});
        pause(0.01);
    }
}

TEST_CASE("a board of three axes that is gone under a force ends the trial, and its file verifies",
          "[window][open][gantry][safety][law]") {
    Desk desk;
    REQUIRE(desk.feel());
    desk.emulator.program().signal(SIGKILL);
    CHECK(desk.ends_by("'device_lost', 'device_silent'", 400));
    desk.kill();
}

TEST_CASE("a third motor that pulls the wrong way is ended with its cause, and leaves no force",
          "[window][open][gantry][safety][law]") {
    const TemporaryFile file("wired.toml");
    write(file, replaced(slurp(kGantry), "motor_z = \"forward\"", "motor_z = \"backward\""));
    Desk desk(file);
    CHECK(desk.ends_by("'runaway', 'energy', 'over_speed'", 1200));
    CHECK(desk.force_ends());
    desk.kill();
}

TEST_CASE("a third encoder whose cable comes out under a force ends it, and no force is left",
          "[window][open][gantry][safety][law]") {
    // A busy machine may end the trial for another reason while the cable is out: then the proof of
    // the rig refuses the next trial, and another session is begun.
    bool found = false;
    for (int tries = 0; tries < 6 && !found; ++tries) {
        Desk desk;
        found = desk.feel(1.0);
        desk.emulator.type("unplug 3");
        found = found && desk.ends_by("'stuck_encoder'", 100);
        CHECK(desk.force_ends());
        desk.kill();
    }
    CHECK(found);
}

TEST_CASE(
    "what a machine of three axes cannot do is refused with a sentence, before a file is made",
    "[open][gantry]") {
    const TemporaryFolder folder;
    const auto refused = [&](const Words& words) {
        const Finished done = ran(words, 2);
        return done.error;
    };
    const std::string db = folder.file("d.sqlite");
    const std::string out = folder.file("rig.toml");
    CHECK_THAT(refused(run_words("shape_friction", "P1", db,
                                 {"--device", "board:/dev/null", "--calibration", kGantry})),
               Has("curves in a plane, and the machine of that calibration has three axes"));
    CHECK_THAT(refused(run_words("patch_friction", "P1", db, {"--device", "board:/dev/null"})),
               Has("board:PORT with the --calibration of a machine of three axes"));
    CHECK_THAT(refused({"check", "patch_friction", "--device", "haply:/dev/null", "--calibration",
                        kGantry}),
               Has("which an open board alone drives"));
    CHECK_THAT(refused({"calibrate", "--preset", kGantry, "-o", out}),
               Has("straight axes have no zeros to be found"));
    CHECK_THAT(refused({"haply-emulator", "--open", "--preset", kGantry, "--free", "--handle-g",
                        "60"}),  // its default
               Has("--handle-friction are of a linkage"));
    CHECK_THAT(refused({"haply-emulator", "--preset", kGantry}),
               Has("this machine has no Haply board"));
    CHECK(folder.names().empty());
    // A workspace that does not hold the patch.
    write(folder.file("narrow.toml"),
          replaced(slurp(kGantry), "high_mm = 60\nhome_mm = 40", "high_mm = 25\nhome_mm = 20"));
    TypedTo emulator(folder, "keys",
                     "haply-emulator --open --preset '" + folder.file("narrow.toml") +
                         "' --link '" + folder.file("board") + "'");
    REQUIRE(eventually([&] { return std::filesystem::exists(folder.file("board")); }));
    std::string said;
    for (int i = 0; i < 10 && said.find("cannot reach") == std::string::npos; ++i) {
        said =
            palpate_command({"check", "patch_friction", "--device", "board:" + folder.file("board"),
                             "--calibration", folder.file("narrow.toml")})
                .out;  // a busy machine may leave the board without its turn
    }
    CHECK_THAT(said, Has("the handle cannot reach the start pose (0.0, 0.0, 40.0) mm"));
}
