#include "engine/device/device.hpp"
#include "data/store/reader.hpp"
#include "tests/support/child.hpp"
#include "tests/support/program.hpp"
#include "tests/support/rig_file.hpp"
#include "tests/support/sql_first.hpp"

namespace {

bool has_ticks(const std::string& file) {
    try {
        return sql_lines(file, "SELECT count(*) FROM trace_chunk") != "0\n";
    } catch (const data::StoreError&) {  // it is not there yet
        return false;
    }
}

/// The processes that `parent` has started and that still run.
std::vector<pid_t> children_of(pid_t parent) {
    std::vector<pid_t> children;
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
        std::ifstream stat(entry.path() / "stat");
        std::string line;
        if (!std::getline(stat, line)) {
            continue;
        }
        std::istringstream rest(line.substr(line.rfind(')') + 1));
        char state = ' ';
        pid_t from = 0;
        rest >> state >> from;
        if (from == parent && state != 'Z') {
            children.push_back(static_cast<pid_t>(std::stol(entry.path().filename().string())));
        }
    }
    return children;
}

}  // namespace

TEST_CASE("a limit that every hand breaks: three faults, a sentence, exit code 1, a sound file",
          "[cli][fault][law]") {
    const TemporaryFolder folder;
    const std::string protocol = folder.file("slow.toml");
    std::string text = slurp(PALPATE_SOURCE_DIR "/protocols/library/shape_friction_demo.toml");
    const std::string section = "[safety]\n";
    REQUIRE_THAT(text, Has(section));
    text.insert(text.find(section) + section.size(), "speed_limit_m_per_s = 0.05\n");
    std::ofstream(protocol) << text;
    const std::string file = folder.file("d.sqlite");
    for (int run = 1; run <= 2; ++run) {  // the same protocol resumes, and has the same limit
        CAPTURE(run);
        const Finished end = ran(run_words(protocol, "P1", file, {"--headless"}), 1);
        CHECK_THAT(end.error, Has("gave up after 3 faults in a row: the handle was "
                                  "faster than the limit: move more slowly",
                                  ". The force is off"));
        CHECK_THAT(end.out, Has("fault: the handle was faster than the limit"));
        CHECK(sql_lines(file, "PRAGMA integrity_check") == "ok\n");
        CHECK(sql_lines(file, "SELECT count(*) FROM fault WHERE fault_cause = 'over_speed'") ==
              std::to_string(3 * run) + "\n");
        CHECK(sql_lines(file, "SELECT count(*) FROM trial WHERE outcome <> 'faulted'") == "0\n");
        CHECK(sql_lines(file, "SELECT count(*) FROM event WHERE event_kind = 'gave up'") ==
              std::to_string(run) + "\n");
        CHECK(sql_lines(file, "SELECT count(*) FROM event WHERE event_kind = 'timing'") == "0\n");
    }
}

TEST_CASE("a device that dies and stays away: ten tries, exit code 1, and another day goes on",
          "[cli][fault][haply][law]") {
    const TemporaryFile file("d.sqlite");
    const Words words =
        run_words("shape_friction_haply", "P1", file, {"--device", "haply-emulator"});
    const Words command = joined({palpate_program()}, words);
    for (int run = 1; run <= 2; ++run) {
        CAPTURE(run);
        Process program(command, {"DISPLAY", "WAYLAND_DISPLAY"});
        REQUIRE(eventually([&] { return has_ticks(file) || !program.running(); }));
        REQUIRE(eventually([&] {
            return !program.running() ||
                   sql_lines(file,
                             "SELECT count(*) FROM trial WHERE outcome = 'running' AND trial_id IN "
                             "(SELECT trial_id FROM trace_chunk)") == "1\n";
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
        CHECK(sql_lines(file, "PRAGMA integrity_check") == "ok\n");
        // Exactly so many on a quiet machine; a busy one may have had ticks too late before.
        CHECK(sql_lines(file, "SELECT count(*) >= " + std::to_string(run) +
                                  " FROM trial WHERE outcome = 'faulted'") == "1\n");
        CHECK(sql_lines(file, "SELECT count(*) FROM trial WHERE outcome = 'running'") == "0\n");
        CHECK(sql_lines(file, "SELECT count(*) FROM event WHERE event_kind = 'gave up'") ==
              std::to_string(run) + "\n");
        CHECK(sql_lines(file, "SELECT count(*) > 0 FROM event WHERE event_kind = 'timing'") ==
              "1\n");
        if (run == 2) {
            CHECK_THAT(end.out, Has("Resuming at practice 1 of 10"));
        }
    }
}

TEST_CASE("the doctor fails a board that is not there with the remedy and exit code 1",
          "[cli][doctor][fault]") {
    const TemporaryFile file("d.sqlite");
    const Finished doctor = ran({"doctor", "--device", "haply:/nonexistent", "--protocol",
                                 "shape_friction_haply", "--seconds", "0.1", "--db", file},
                                1);
    CHECK(doctor.out.starts_with("fail  device"));
    CHECK_THAT(doctor.out, Has("/nonexistent"));
    CHECK_THAT(doctor.out, !Has("passivity and force"));
}

TEST_CASE("the doctor says by what margin the device can render a protocol, or that it cannot",
          "[cli][doctor][law]") {
    const TemporaryFolder folder;
    const std::string stiff = folder.file("stiff.toml");
    std::string text = slurp(PALPATE_SOURCE_DIR "/protocols/library/shape_friction_demo.toml");
    const std::string key = "stiffness_n_per_m = ";
    const std::size_t at = text.find(key);
    REQUIRE(at != std::string::npos);
    text.replace(at, text.find_first_of("\n#", at) - at, key + "20000.0 ");
    std::ofstream(stiff) << text;
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

TEST_CASE("a question at the terminal obeys a signal, and nothing is begun", "[cli][fault][law]") {
    const TemporaryFolder folder;
    EACH(number, SIGINT, SIGTERM, SIGHUP);
    const std::string rig = commissioned_rig(folder, "haply:/nonexistent");
    TypedTo run(folder, "keys",
                "run pilot --participant P1 --db '" + folder.file("d.sqlite") +
                    "' --device haply:/nonexistent --calibration '" + rig + "'",
                {"SDL_VIDEODRIVER=dummy"});
    REQUIRE(run.program().says("Type yes:"));
    run.program().signal(number);
    const Finished end = run.program().wait();
    check_end(end, 3, Has("stopped at the question; nothing was begun"));
    CHECK_FALSE(std::filesystem::exists(folder.file("d.sqlite")));
}
