#include "engine/device/emulator/emulated_board.hpp"
#include "engine/device/pantograph.hpp"
#include "protocols/file/calibration_file.hpp"
#include "protocols/file/protocol_file.hpp"
#include "data/store/session_store.hpp"
#include "data/store/sqlite_recorder.hpp"
#include "tests/support/child.hpp"
#include "tests/support/program.hpp"
#include "tests/support/studies.hpp"

namespace engine = palpate::engine;
namespace protocols = palpate::protocols;

TEST_CASE("palpate haply-emulator is a board that a driver can use, until it is interrupted",
          "[laws][haply]") {
    const TemporaryFile link("board");
    Process emulator(
        {palpate_program(), "haply-emulator", "--link", link, "--preset", "2diy_gen2"});
    REQUIRE(eventually([&] { return std::filesystem::exists(link); }));
    {
        const engine::Calibration machine = protocols::load_calibration("2diy_gen2");
        const auto device = engine::open_haply(link, machine, {.patience = 200.0, .silence = 10.0},
                                               {.patience = 100'000});
        const engine::Reading reading = device->read();
        CHECK(reading.fresh);
        const engine::Pantograph pantograph(machine.pantograph);
        CHECK(glm::length(engine::Vec2(reading.hip) -
                          pantograph.locate(pantograph.angles({0, 0}))->hip) < 1e-4);
    }
    emulator.signal(SIGINT);
    const Finished finished = emulator.wait();
    CHECK(finished.code == 0);
    CHECK(finished.out == link + "\n");
    CHECK_FALSE(std::filesystem::is_symlink(link));
}

/// The report is wrapped where its lines end: not where a test looks for words.
static std::string on_one_line(const std::string& text) {
    std::string line;
    for (const char c : text) {
        const bool space = c == ' ' || c == '\n';
        if (!space || (!line.empty() && line.back() != ' ')) {
            line += space ? ' ' : c;
        }
    }
    return line;
}

TEST_CASE("the doctor calls a sound board ok whatever its delay, and says how long answers take",
          "[laws][haply][doctor]") {
    const TemporaryFolder folder;
    const std::string link = folder.file("board");
    EACH(delay, as<std::string>{}, "0", "0.3", "1", "2");
    const Process emulator({palpate_program(), "haply-emulator", "--link", link, "--preset",
                            "2diy_gen3", "--delay-ms", delay});
    REQUIRE(eventually([&] { return std::filesystem::exists(link); }));
    bool well = false;
    for (int i = 0; i < 20 && !well; ++i) {  // a busy machine may keep the board silent for 20 ms
        const Finished doctor = palpate_command({"doctor", "--device", "haply:" + link, "--seconds",
                                                 "0.05", "--db", folder.file("d.sqlite")});
        CAPTURE(doctor.out);
        REQUIRE_THAT(doctor.out, !Has("sent what cannot be"));
        well = doctor.out.find("ok    device ") == 0;
        const std::string out = on_one_line(doctor.out);
        const auto said = out.find("answers after ");
        REQUIRE((!well || said != std::string::npos));
        CHECK((!well || std::stod(out.substr(said + 14)) >= std::stod(delay)));
    }
    CHECK(well);
}

TEST_CASE("the doctor looks at the emulated board, and refuses answers that come too late",
          "[laws][haply][doctor]") {
    const TemporaryFolder folder;
    const auto look = [&](const std::string& device) {
        return on_one_line(palpate_command({"doctor", "--device", device, "--seconds", "0.05",
                                            "--db", folder.file("d.sqlite")})
                               .out);
    };
    CHECK_THAT(look("haply-emulator"), StartsWith("ok device ") && Has("answers after "));
    const std::string link = folder.file("board");
    const Process emulator({palpate_program(), "haply-emulator", "--link", link, "--preset",
                            "2diy_gen3", "--delay-ms", "40"});
    REQUIRE(eventually([&] { return std::filesystem::exists(link); }));
    CHECK_THAT(look("haply:" + link), StartsWith("fail device ") && !Has("sent what cannot be"));
}

TEST_CASE("an emulator that cannot be is refused with a sentence", "[laws][haply]") {
    const Finished preset = ran({"haply-emulator", "--preset", "gen9"}, 2);
    CHECK_THAT(preset.error, Has("one of haplet, 2diy_gen2, 2diy_gen3"));
    CHECK_THAT(ran({"haply-emulator", "--preset", "mk2"}, 2).error, Has("no Haply board"));
    const TemporaryFolder folder;
    std::ofstream(folder.file("notes")) << "mine";
    CHECK_THAT(ran({"haply-emulator", "--link", folder.file("notes")}, 1).error,
               Has("give a name that is free"));
    CHECK(std::filesystem::file_size(folder.file("notes")) == 4);
    CHECK_THAT(ran({"haply-emulator", "--link", "/proc/no/such/place"}, 1).error,
               Has("name a file in a folder that you may write"));
    CHECK_THAT(ran({"haply-emulator", "--free", "--start", "900,0"}, 2).error,
               Has("--start 900,0: the handle of 2diy_gen3 does not reach there"));
    const std::string link = folder.file("board");
    Process first({palpate_program(), "haply-emulator", "--link", link});
    REQUIRE(eventually([&] { return std::filesystem::exists(link); }));
    const auto leads_to = std::filesystem::read_symlink(link);
    for (const Words& kind : {Words{}, Words{"--open"}}) {
        CHECK_THAT(ran(joined({"haply-emulator", "--link", link}, kind), 1).error,
                   Has("is there: end it, or give another name"));
        CHECK(std::filesystem::read_symlink(link) == leads_to);
    }
    CHECK(first.ended_by(SIGINT) == 0);
}

TEST_CASE("who had the port open before is named and left as it was, and nothing begins beside it",
          "[laws][haply][doctor]") {
    const TemporaryFolder folder;
    const std::string link = folder.file("board");
    Process emulator({palpate_program(), "haply-emulator", "--link", link});
    REQUIRE(eventually([&] { return std::filesystem::exists(link); }));
    Process stranger(
        {"/bin/sh", "-c", "exec 3<>'" + link + "'; stty 9600 echo <&3; exec sleep 600"});
    const auto said = [&] {
        return on_one_line(palpate_command({"doctor", "--device", "haply:" + link, "--seconds",
                                            "0.05", "--db", folder.file("d.sqlite")})
                               .out);
    };
    std::string out;
    for (int i = 0; i < 20 && out.find(", sleep (process ") == std::string::npos; ++i) {
        out = said();  // the shell may not have come to its sleep
    }
    CHECK_THAT(out, Has("is in use by another program, sleep (process "));
    for (const Words& begins :
         {run_words("pilot", "P1", folder.file("d.sqlite"), {"--windowed", "--kind", "pilot"}),
          Words{"commission", "-o", folder.file("rig.toml"), "--handle-free"}}) {
        const Words words =
            joined(command_of(begins), {"--device", "haply:" + link, "--calibration", "2diy_gen3"});
        const Finished beside = Process(words, {"SDL_VIDEODRIVER=dummy"}).wait();
        CAPTURE(begins, beside.out, beside.error);
        CHECK(beside.code == 1);
        CHECK_THAT(on_one_line(beside.error), Has("in use by another program, sleep"));
    }
    CHECK(folder.names().size() == 1);  // the board's
    CHECK_THAT(Process({"/bin/stty", "-a", "-F", link}).wait().out,
               Has("speed 9600 baud", " echo "));
    stranger.signal(SIGKILL);
    CHECK(stranger.wait().code != 0);
    CHECK_THAT(said(), !Has("in use by another program"));
    CHECK(emulator.ended_by(SIGINT) == 0);
}

TEST_CASE("the guard goes into a control group of its own where systemd grants one, else stays",
          "[laws][haply][guard][doctor]") {
    const TemporaryFolder folder;
    const std::string link = folder.file("board");
    Process emulator({palpate_program(), "haply-emulator", "--link", link});
    REQUIRE(eventually([&] { return std::filesystem::exists(link); }));
    // What systemd does with the process named last but one.
    const std::string group = "/sys/fs/cgroup/freezer/palpate-" + std::to_string(getpid());
    const auto said = [&](const std::string& does) {
        std::ofstream(folder.file("busctl"))
            << "#!/bin/sh\nwhile [ $# -gt 2 ]; do shift; done\n" + does + "\n";
        std::filesystem::permissions(folder.file("busctl"), std::filesystem::perms::owner_all);
        const std::string out =
            Process({palpate_program(), "doctor", "--device", "haply:" + link, "--seconds", "0.05",
                     "--db", folder.file("d.sqlite")},
                    {"PATH=" + folder.path().string() + ":" + std::getenv("PATH")})
                .wait()
                .out;
        return on_one_line(out);
    };
    CHECK_THAT(said("exit 1"), Has("its guard shares palpate's control group"));
    std::error_code error;
    if (std::filesystem::create_directory(group, error)) {
        CHECK_THAT(said("echo $1 > " + group + "/cgroup.procs"),
                   Has("its guard has a control group of its own"));
        CHECK(eventually([&] { return std::filesystem::remove(group, error); }));
    }
    CHECK(emulator.ended_by(SIGINT) == 0);
}

TEST_CASE("a session on an emulated board is simulated unless --kind says otherwise",
          "[laws][haply][law]") {
    const TemporaryFolder folder;
    const std::string link = folder.file("board");
    const Process emulator({palpate_program(), "haply-emulator", "--link", link});
    REQUIRE(eventually([&] { return std::filesystem::exists(link); }));
    const auto spec = session_spec(small_protocol());
    write(folder.file("small.toml"), protocols::to_toml(spec.protocol));
    const std::string file = folder.file("d.sqlite");
    {  // a simulated session that has begun, on another device
        palpate::data::Database database(file, palpate::data::Access::write);
        const auto opened = palpate::data::open_session(database, spec);
        palpate::data::SqliteRecorder recorder(database, spec.protocol, opened.id);
        static_cast<void>(begin_trial(recorder, spec.protocol, spec.plan.trials[0]));
    }
    const auto refused = [&](const Words& kind) {
        const Words words =
            joined({palpate_program(), "run", folder.file("small.toml"), "--participant", "P01",
                    "--db", file, "--device", "haply:" + link},
                   kind);
        const Finished finished = Process(words, {"SDL_VIDEODRIVER=dummy"}).wait();
        CHECK(finished.code == 2);
        return finished.error;
    };
    const std::string simulated = refused({});
    CHECK_THAT(simulated, Has("the session is recorded as simulated", "--other-device"));
    CHECK_THAT(refused({"--kind", "pilot"}), Has("cannot go on as pilot"));
    CHECK_THAT(refused({"--kind", "real"}), Has("no real session"));
}
