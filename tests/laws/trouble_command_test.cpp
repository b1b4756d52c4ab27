#include "engine/device/device.hpp"
#include "data/store/reader.hpp"
#include "tests/support/child.hpp"
#include "tests/support/program.hpp"
#include "tests/support/rig_file.hpp"
#include "tests/support/sql_first.hpp"

TEST_CASE("a limit that every hand breaks: three faults, a sentence, exit code 1, a sound file") {
    const TemporaryFolder folder;
    const std::string protocol =
        write(folder.file("slow.toml"),
              replaced(slurp(PALPATE_SOURCE_DIR "/protocols/library/shape_friction_demo.toml"),
                       "[safety]\n", "[safety]\nspeed_limit_m_per_s = 0.05\n"));
    const std::string file = folder.file("d.sqlite");
    for (int run = 1; run <= 2; ++run) {  // the same protocol resumes, and has the same limit
        CAPTURE(run);
        const Finished end = ran(run_words(protocol, "P1", file, {"--headless"}), 1);
        CHECK_THAT(end.error, Has("gave up after 3 faults in a row: the handle was "
                                  "faster than the limit: move more slowly",
                                  ". The force is off"));
        CHECK_THAT(end.out, Has("fault: the handle was faster than the limit"));
        CHECK(sql_first(file, "PRAGMA integrity_check") == "ok");
        CHECK(sql_lines(file,
                        "SELECT (SELECT count(*) FROM fault WHERE fault_cause = "
                        "'over_speed'), (SELECT sum(outcome <> 'faulted') FROM trial), "
                        "sum(event_kind = 'gave up'), sum(event_kind = 'timing') FROM "
                        "event") == fmt::format("{}|0|{}|0\n", 3 * run, run));
    }
}

TEST_CASE("a device that dies and stays away: ten tries, exit code 1, and another day goes on",
          "[haply]") {
    const TemporaryFile file("d.sqlite");
    const Words words =
        run_words("shape_friction_haply", "P1", file, {"--device", "haply-emulator"});
    const Words command = joined({palpate_program()}, words);
    for (int run = 1; run <= 2; ++run) {
        CAPTURE(run);
        Process program(command, kNoDisplay);
        REQUIRE(eventually([&] {
            return !program.running() ||
                   sql_now(file,
                           "SELECT count(*) FROM trial WHERE outcome = 'running' AND "
                           "trial_id IN (SELECT trial_id FROM trace_chunk)") == "1";
        }));
        for (const pid_t child : children_of(program.id())) {  // the board and the guard
            kill(child, SIGKILL);
        }
        // Nobody who asks hears that the force is off.
        std::string shown;
        CHECK(eventually([&] {
            shown = palpate_command({"status", file, "--json"}).out;
            return shown.find(R"("on":null)") != std::string::npos || !program.running();
        }));
        CHECK_THAT(shown, Has(engine::kForceUnproved));
        check_end(palpate_command({"stop", file}), 1, Has(engine::kForceUnproved));
        const Finished end = program.wait();
        check_end(end, 1, Has(fmt::format("palpate: {}", engine::kForceUnproved)));
        CHECK_THAT(end.error, Has("gave up after 10 tries to reach the device again: ") ||
                                  Has("faults in a row: "));
        CHECK(sql_first(file, "PRAGMA integrity_check") == "ok");
        // Exactly so many on a quiet machine; a busy one may have had ticks too late before.
        CHECK(sql_lines(file, fmt::format("SELECT (SELECT sum(outcome = 'faulted') >= {} FROM "
                                          "trial), (SELECT sum(outcome = 'running') FROM trial), "
                                          "sum(event_kind = 'gave up'), sum(event_kind = 'timing') "
                                          "> 0 FROM event",
                                          run)) == fmt::format("1|0|{}|1\n", run));
        if (run == 2) {
            CHECK_THAT(end.out, Has("Resuming at practice 1 of 10"));
        }
    }
}

TEST_CASE("the doctor fails a board that is not there with the remedy and exit code 1") {
    const TemporaryFile file("d.sqlite");
    const Finished doctor = ran({"doctor", "--device", "haply:/nonexistent", "--protocol",
                                 "shape_friction_haply", "--seconds", "0.1", "--db", file},
                                1);
    CHECK(doctor.out.starts_with("fail  device"));
    CHECK_THAT(doctor.out, Has("/nonexistent"));
    CHECK_THAT(doctor.out, !Has("passivity and force"));
}

TEST_CASE("the doctor says by what margin the device can render a protocol, or that it cannot") {
    const TemporaryFolder folder;
    const std::string stiff =
        write(folder.file("stiff.toml"),
              replaced(slurp(PALPATE_SOURCE_DIR "/protocols/library/shape_friction_demo.toml"),
                       "stiffness_n_per_m = 1000", "stiffness_n_per_m = 20000"));
    for (const std::string& protocol : {std::string("shape_friction_demo"), stiff}) {
        CAPTURE(protocol);
        const Finished doctor = palpate_command({"doctor", "--protocol", protocol, "--seconds",
                                                 "0.1", "--db", folder.file("d.sqlite")});
        CAPTURE(doctor.out);
        const bool refused = protocol == stiff;
        CHECK_THAT(doctor.out,
                   Has(refused ? "fail  passivity and force" : "ok    passivity and force",
                       " N s/m, the device damps ", "creep"));
        if (refused) {
            CHECK(doctor.code == 1);
            CHECK_THAT(doctor.out, Has("lower stiffness_n_per_m to "));
        }
    }
}

TEST_CASE("a question at the terminal obeys a signal, and nothing is begun") {
    const TemporaryFolder folder;
    EACH(number, SIGINT, SIGTERM, SIGHUP);
    const std::string rig = commissioned_rig(folder, "haply:/nonexistent");
    TypedTo run(folder, "keys",
                "run pilot --participant P1 --db '" + folder.file("d.sqlite") +
                    "' --device haply:/nonexistent --calibration '" + rig + "'",
                {"SDL_VIDEODRIVER=dummy"});
    REQUIRE(run.program().says("Type yes:"));
    run.program().signal(number);
    check_end(run.program().wait(), 3, Has("stopped at the question; nothing was begun"));
    CHECK_FALSE(std::filesystem::exists(folder.file("d.sqlite")));
}
