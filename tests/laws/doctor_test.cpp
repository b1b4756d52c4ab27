#include <fstream>
#include <set>

#include "tests/support/catch.hpp"
#include "tests/support/free_board.hpp"
#include "tests/support/process.hpp"

using namespace palpate;
using Catch::Matchers::ContainsSubstring;
using tests::Finished;
using tests::palpate_command;
using tests::TemporaryFolder;

namespace {

// Every check of the issue's list is there once, with a status, a detail where all is well and a
// remedy where not; prints how many have failed.
constexpr const char* kReader = R"(
import json, sys
report = json.load(open(sys.argv[1]))
assert report["palpate"], report
checks = report["checks"]
names = [c["name"] for c in checks]
for name in ["device", "kinematics", "clock", "kernel", "scheduling", "memory", "processor sleep",
             "timer slack", "jitter", "cyclictest", "host", "display", "audio", "font", "disk"]:
    assert names.count(name) == 1, (name, names)
for c in checks:
    assert set(c) == {"name", "status", "detail", "remedy", "numbers"}, c
    assert c["status"] in ("ok", "warn", "fail"), c
    assert c["detail"], c
    assert c["status"] == "ok" or c["remedy"], c
    assert all(isinstance(v, (int, float)) for v in c["numbers"].values()), c
print(sum(c["status"] == "fail" for c in checks))
)";

}  // namespace

TEST_CASE(
    "the doctor's JSON is valid and whole, and its exit code is 1 exactly when a check failed",
    "[cli][doctor][law]") {
    const TemporaryFolder folder;
    std::ofstream(folder.file("reader.py")) << kReader;
    for (const std::string& db : {folder.file("d.sqlite"), folder.file("absent/d.sqlite")}) {
        CAPTURE(db);
        const Finished doctor =
            palpate_command({"doctor", "--json", "--seconds", "0.1", "--db", db});
        CAPTURE(doctor.out, doctor.error);
        std::ofstream(folder.file("doctor.json")) << doctor.out;
        CHECK(tests::Process({"python3", "-m", "json.tool", folder.file("doctor.json")})
                  .wait()
                  .code == 0);
        const Finished read =
            tests::Process({"python3", folder.file("reader.py"), folder.file("doctor.json")})
                .wait();
        CAPTURE(read.error);
        REQUIRE(read.code == 0);
        CHECK(doctor.code == (read.out == "0\n" ? 0 : 1));
    }
    CHECK(folder.names() == std::vector<std::string>{"doctor.json", "reader.py"});
}

TEST_CASE("the doctor's lines begin with ok, warn or fail, and end with how many",
          "[cli][doctor]") {
    const TemporaryFolder folder;
    const Finished doctor =
        palpate_command({"doctor", "--seconds", "0.1", "--device", "mouse", "--protocol",
                         "shape_friction_demo", "--db", folder.file("d.sqlite")});
    CHECK(doctor.error.empty());
    CHECK_THAT(doctor.out, ContainsSubstring("device ") && ContainsSubstring("jitter ") &&
                               ContainsSubstring(" to look at, "));
    CHECK(doctor.out.find_first_of("owf") == 0);
}

TEST_CASE("wrong words to the doctor get a sentence and exit code 2", "[cli][doctor]") {
    const Finished device = palpate_command({"doctor", "--device", "haptic"});
    CHECK(device.code == 2);
    CHECK_THAT(device.error, ContainsSubstring("haptic"));
    const Finished seconds = palpate_command({"doctor", "--seconds", "never"});
    CHECK(seconds.code == 2);
    const Finished protocol = palpate_command({"doctor", "--protocol", "absent.toml"});
    CHECK(protocol.code == 2);
    CHECK_THAT(protocol.error, ContainsSubstring("absent.toml"));
}

TEST_CASE(
    "while the doctor looks at a board and calibrate reads its marks, no motor gives a torque",
    "[doctor][calibrate][haply][law]") {
    const TemporaryFolder folder;
    tests::FreeBoard board(folder);
    std::set<std::string> given;
    int looks = 0;
    const auto look = [&] {
        given.insert(board.motors());
        ++looks;
    };
    tests::Process doctor({tests::palpate_program(), "doctor", "--device", board.word(),
                           "--seconds", "0.05", "--db", folder.file("d.sqlite")},
                          {"DISPLAY", "WAYLAND_DISPLAY"});
    while (doctor.running()) {
        look();
    }
    CHECK_THAT(doctor.out(), ContainsSubstring("  device "));
    CHECK(looks > 20);

    tests::TypedTo calibrate(folder, "desk",
                             "calibrate --preset 2diy_gen3 --mark 0,70 --mark=-20,70 --device " +
                                 board.word() + " -o '" + folder.file("desk.toml") + "'");
    int brought = 0;
    CHECK(tests::eventually([&] {
        const std::string out = calibrate.program().out();
        look();
        if (tests::times(out, "Bring the handle to") > brought) {
            ++brought;
            board.bring(tests::last_place(out));
            calibrate.type("");
        }
        return !calibrate.program().running();
    }));
    CHECK(brought == 2);
    CHECK(given == std::set<std::string>{"0, 0"});
}
