#include "engine/device/emulator/emulated_board.hpp"
#include "engine/device/pantograph.hpp"
#include "protocols/file/calibration_file.hpp"
#include "protocols/file/protocol_file.hpp"
#include "data/store/session_store.hpp"
#include "data/store/sqlite_recorder.hpp"
#include "tests/support/child.hpp"
#include "tests/support/console.hpp"
#include "tests/support/program.hpp"
#include "tests/support/studies.hpp"

namespace {

/// An emulated board at a port, with more words of `palpate haply-emulator`.
struct EmulatedPort {
    explicit EmulatedPort(const Words& more = {})
        : program(joined(command_of({"haply-emulator", "--link", link}), more)) {
        REQUIRE(eventually([&] { return std::filesystem::exists(link); }));
    }
    TemporaryFolder folder;
    std::string link = folder.file("board");
    Process program;
};

/// The report is wrapped where its lines end: not where a test looks for words.
std::string on_one_line(const std::string& text) {
    std::string line;
    for (const char c : text) {
        const bool space = c == ' ' || c == '\n';
        if (!space || (!line.empty() && line.back() != ' ')) {
            line += space ? ' ' : c;
        }
    }
    return line;
}

/// What `palpate doctor` says of a device, on one line.
std::string doctor(const std::string& device, const Words& environment = {}) {
    const TemporaryFile file("d.sqlite");
    return on_one_line(
        Process(command_of({"doctor", "--device", device, "--seconds", "0.05", "--db", file}),
                joined(kNoDisplay, environment))
            .wait()
            .out);
}

}  // namespace

TEST_CASE("palpate haply-emulator is a board that a driver can use, until it is interrupted",
          "[haply]") {
    EmulatedPort emulator({"--preset", "2diy_gen2"});
    {
        const engine::Calibration machine = protocols::load_calibration("2diy_gen2");
        const auto device = engine::open_haply(
            emulator.link, machine, {.patience = 200.0, .silence = 10.0}, {.patience = 100'000});
        const engine::Reading reading = device->read();
        CHECK(reading.fresh);
        const engine::Pantograph pantograph(machine.pantograph);
        CHECK(glm::length(engine::Vec2(reading.hip) -
                          pantograph.locate(pantograph.angles({0, 0}))->hip) < 1e-4);
    }
    emulator.program.signal(SIGINT);
    CHECK(ended(emulator.program.wait()).out == emulator.link + "\n");
    CHECK_FALSE(std::filesystem::is_symlink(emulator.link));
}

TEST_CASE("the doctor calls a sound board ok whatever its delay, and says how long answers take",
          "[haply]") {
    EACH(delay, as<std::string>{}, "0", "0.3", "1", "2");
    const EmulatedPort emulator({"--delay-ms", delay});
    bool well = false;
    for (int i = 0; i < 20 && !well; ++i) {  // a busy machine may keep the board silent for 20 ms
        const std::string out = doctor("haply:" + emulator.link);
        CAPTURE(out);
        REQUIRE_THAT(out, !Has("sent what cannot be"));
        well = out.starts_with("ok device ");
        const std::string said = behind(out, "answers after ");
        REQUIRE((!well || !said.empty()));
        CHECK((!well || std::stod(said) >= std::stod(delay)));
    }
    CHECK(well);
}

TEST_CASE("the doctor looks at the emulated board, and refuses answers that come too late",
          "[haply]") {
    CHECK_THAT(doctor("haply-emulator"), StartsWith("ok device ") && Has("answers after "));
    const EmulatedPort emulator({"--delay-ms", "40"});
    CHECK_THAT(doctor("haply:" + emulator.link),
               StartsWith("fail device ") && !Has("sent what cannot be"));
}

TEST_CASE("an emulator that cannot be is refused with a sentence", "[haply]") {
    const TemporaryFolder folder;
    std::ofstream(folder.file("notes")) << "mine";
    CHECK_THAT(ran({"haply-emulator", "--link", folder.file("notes")}, 1).error,
               Has("give a name that is free"));
    CHECK(std::filesystem::file_size(folder.file("notes")) == 4);
    CHECK_THAT(ran({"haply-emulator", "--link", "/proc/no/such/place"}, 1).error,
               Has("name a file in a folder that you may write"));
    EmulatedPort first;
    const auto leads_to = std::filesystem::read_symlink(first.link);
    for (const Words& kind : {Words{}, Words{"--open"}}) {
        refused(joined({"haply-emulator", "--link", first.link}, kind),
                "is there: end it, or give another name", 1);
        CHECK(std::filesystem::read_symlink(first.link) == leads_to);
    }
    CHECK(first.program.ended_by(SIGINT) == 0);
}

TEST_CASE("who had the port open before is named and left as it was, and nothing begins beside it",
          "[haply]") {
    EmulatedPort emulator;
    const TemporaryFolder folder;
    Process stranger(
        {"/bin/sh", "-c", "exec 3<>'" + emulator.link + "'; stty 9600 echo <&3; exec sleep 600"});
    const auto said = [&] {
        return doctor("haply:" + emulator.link);
    };
    std::string out;
    for (int i = 0; i < 20 && out.find(", sleep (process ") == std::string::npos; ++i) {
        out = said();  // the shell may not have come to its sleep
    }
    CHECK_THAT(out, Has("is in use by another program, sleep (process "));
    for (const Words& begins :
         {run_words("pilot", "P1", folder.file("d.sqlite"), {"--windowed", "--kind", "pilot"}),
          Words{"commission", "-o", folder.file("rig.toml"), "--handle-free"}}) {
        const Finished beside = unseen(
            joined(begins, {"--device", "haply:" + emulator.link, "--calibration", "2diy_gen3"}));
        CAPTURE(begins, beside.out, beside.error);
        CHECK(beside.code == 1);
        CHECK_THAT(on_one_line(beside.error), Has("in use by another program, sleep"));
    }
    CHECK(folder.names().empty());
    CHECK_THAT(Process({"/bin/stty", "-a", "-F", emulator.link}).wait().out,
               Has("speed 9600 baud", " echo "));
    stranger.signal(SIGKILL);
    CHECK(stranger.wait().code != 0);
    CHECK_THAT(said(), !Has("in use by another program"));
    CHECK(emulator.program.ended_by(SIGINT) == 0);
}

TEST_CASE("the guard goes into a control group of its own where systemd grants one, else stays",
          "[haply]") {
    EmulatedPort emulator;
    const TemporaryFolder folder;
    // What systemd does with the process named last but one.
    const std::string group = "/sys/fs/cgroup/freezer/palpate-" + std::to_string(getpid());
    const auto said = [&](const std::string& does) {
        std::ofstream(folder.file("busctl"))
            << "#!/bin/sh\nwhile [ $# -gt 2 ]; do shift; done\n" + does + "\n";
        std::filesystem::permissions(folder.file("busctl"), std::filesystem::perms::owner_all);
        return doctor("haply:" + emulator.link,
                      {"PATH=" + folder.path().string() + ":" + std::getenv("PATH")});
    };
    CHECK_THAT(said("exit 1"), Has("its guard shares palpate's control group"));
    std::error_code error;
    if (std::filesystem::create_directory(group, error)) {
        CHECK_THAT(said("echo $1 > " + group + "/cgroup.procs"),
                   Has("its guard has a control group of its own"));
        CHECK(eventually([&] { return std::filesystem::remove(group, error); }));
    }
    CHECK(emulator.program.ended_by(SIGINT) == 0);
}

TEST_CASE("an emulator of another container is behind no terminal of this one with its number",
          "[haply]") {
    const TemporaryFolder folder;
    const std::string there = folder.file("there");
    const Process other(joined({"unshare", "--user", "--map-root-user", "--mount", "sh", "-c",
                                "mount -t devpts devpts /dev/pts -o newinstance,ptmxmode=0666 && "
                                "mount --bind /dev/pts/ptmx /dev/ptmx && exec \"$@\"",
                                "sh"},
                               command_of({"haply-emulator", "--link", there})),
                        kNoDisplay);
    const Descriptor master(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC));
    std::error_code none;
    const bool alike =
        eventually([&] { return std::filesystem::is_symlink(there) || has_ended(other.id()); }) &&
        std::filesystem::read_symlink(there, none) == ptsname(master.get());
    if (!alike) {
        WARN("this kernel gives no terminals apart, or others have the first ones: not tried");
        return;
    }
    const std::string here = folder.file("here");
    std::filesystem::create_symlink(ptsname(master.get()), here);
    const Process emulator(command_of({"haply-emulator", "--link", here}));
    CHECK(eventually(
        [&] { return std::filesystem::read_symlink(here, none) != ptsname(master.get()); }));
}

TEST_CASE("a session on an emulated board is simulated unless --kind says otherwise", "[haply]") {
    const EmulatedPort emulator;
    const TemporaryFolder folder;
    const auto spec = session_spec(small_protocol());
    const std::string study = write(folder.file("small.toml"), protocols::to_toml(spec.protocol));
    const std::string file = folder.file("d.sqlite");
    {  // a simulated session that has begun, on another device
        data::Database database(file, data::Access::write);
        const auto opened = data::open_session(database, spec);
        data::SqliteRecorder recorder(database, spec.protocol, opened.id);
        static_cast<void>(begin_trial(recorder, spec.protocol, spec.plan.trials[0]));
    }
    const auto refused = [&](const Words& kind) {
        const Words words = run_words(study, "P01", file, {"--device", "haply:" + emulator.link});
        return ended(unseen(joined(words, kind)), 2).error;
    };
    CHECK_THAT(refused({}), Has("the session is recorded as simulated", "--other-device"));
    CHECK_THAT(refused({"--kind", "pilot"}), Has("cannot go on as pilot"));
    CHECK_THAT(refused({"--kind", "real"}), Has("no real session"));
}
