#include "engine/device/drivers/haply_wire.hpp"
#include "tests/support/free_board.hpp"
#include "tests/support/program.hpp"

TEST_CASE(
    "the doctor's JSON is valid and whole, and its exit code is 1 exactly when a check failed") {
    const TemporaryFolder folder;
    // Every check of the list is there once, with a status, a detail where all is well and a
    // remedy where not; prints how many have failed.
    const std::string reader = script("read_doctor.py");
    for (const std::string& db : {folder.file("d.sqlite"), folder.file("absent/d.sqlite")}) {
        CAPTURE(db);
        const Finished doctor =
            palpate_command({"doctor", "--json", "--seconds", "0.1", "--db", db});
        CAPTURE(doctor.out, doctor.error);
        const std::string json = write(folder.file("doctor.json"), doctor.out);
        CHECK(Process({"python3", "-m", "json.tool", json}).wait().code == 0);
        const Finished read = ended(Process({"python3", reader, json}).wait());
        CHECK(doctor.code == (read.out == "0\n" ? 0 : 1));
    }
    CHECK(folder.names() == Words{"doctor.json"});
}

TEST_CASE("the doctor's lines begin with ok, warn or fail, and end with how many") {
    const TemporaryFile file("d.sqlite");
    const Finished doctor = palpate_command({"doctor", "--seconds", "0.1", "--device", "mouse",
                                             "--protocol", "shape_friction_demo", "--db", file});
    CHECK(doctor.error.empty());
    CHECK_THAT(doctor.out, Has("device ", "jitter ", " to look at, "));
    CHECK(doctor.out.find_first_of("owf") == 0);
}

TEST_CASE("without a display the doctor fails a device that run refuses for it, and no other") {
    const TemporaryFile file("d.sqlite");
    const auto [device, environment, status, code] =
        GENERATE(table<std::string, std::string, std::string, int>(
            {{"mouse", "SDL_VIDEODRIVER", "fail", 2},
             {"mouse", "SDL_VIDEODRIVER=dummy", "warn", 3},  // a window that nobody sees
             {"sim", "SDL_VIDEODRIVER", "warn", 3}}));
    CAPTURE(device, environment);
    const Words none{"DISPLAY", "WAYLAND_DISPLAY", environment};
    Process doctor(
        {palpate_program(), "doctor", "--seconds", "0.05", "--device", device, "--db", file}, none);
    CHECK_THAT(doctor.wait().out, Has(status + "  display "));
    Process run({palpate_program(), "run", "shape_friction_demo", "--participant", "P1", "--device",
                 device, "--db", file, "--speed", "1"},
                none);
    CHECK(eventually(
        [&] { return !run.running() || run.out().find("If it ends early") != std::string::npos; }));
    run.signal(SIGTERM);
    const Finished end = run.wait();
    CHECK(end.code == code);
    CHECK((code == 3 || end.error.find("needs a display and a window") != std::string::npos));
}

TEST_CASE("the doctor fails a place for the data that run refuses") {
    const TemporaryFolder folder;
    std::ofstream(folder.file("notes.txt")) << "rested after trial 40\n";
    for (const std::string& db : {folder.file("notes.txt"), folder.path().string()}) {
        const Finished doctor = palpate_command({"doctor", "--seconds", "0.05", "--db", db});
        const Finished run = palpate_command(
            {"run", "shape_friction_demo", "--participant", "P1", "--headless", "--db", db});
        CHECK(doctor.code == 1);
        CHECK(run.code == 2);
        CHECK_THAT(doctor.out, Has("fail  disk "));
        CHECK_THAT(run.error, Has(db));
    }
    CHECK(folder.names() == Words{"notes.txt"});
}

TEST_CASE(
    "while the doctor looks at a board and calibrate reads its marks, no motor gives a torque",
    "[haply]") {
    const TemporaryFolder folder;
    FreeBoard board(folder);
    std::set<std::string> given;
    int looks = 0;
    const auto look = [&] {
        given.insert(board.motors());
        ++looks;
    };
    Process doctor({palpate_program(), "doctor", "--device", board.word(), "--seconds", "0.05",
                    "--db", folder.file("d.sqlite")},
                   kNoDisplay);
    while (doctor.running()) {
        look();
    }
    CHECK_THAT(doctor.out(), Has("  device "));
    CHECK(looks > 20);

    TypedTo calibrate(folder, "desk",
                      "calibrate --preset 2diy_gen3 --mark 0,70 --mark=-20,70 --device " +
                          board.word() + " -o '" + folder.file("desk.toml") + "'");
    std::size_t brought = 0;
    CHECK(eventually([&] {
        const std::string out = calibrate.program().out();
        look();
        if (count_of(out, "Bring the handle to") > brought) {
            ++brought;
            board.bring(last_place(out));
            calibrate.type("");
            // A hand that does not wait: this mark is asked for again.
            for (int k = 0; brought == 1 && k < 20; ++k) {
                board.bring(k % 2 == 0 ? "0,60" : "0,65");
                brought += count_of(calibrate.program().out(), "Bring the handle to") - 1;
            }
            brought = count_of(out, "Bring the handle to");
        }
        return !calibrate.program().running();
    }));
    CHECK_THAT(calibrate.program().wait().error,
               Has("while it was read at (0, 70) mm: hold it still"));
    CHECK(brought == 3);
    CHECK(std::filesystem::exists(folder.file("desk.toml")));
    CHECK(given == std::set<std::string>{"0, 0"});

    // A program that died has left a torque: it goes first, whoever opens the board, and then a
    // reset, which would leave it.
    board.bring("hold");
    const std::string file = folder.file("d.sqlite");
    for (const Words& opens :
         {Words{"doctor", "--seconds", "0.05", "--db", file},
          {"run", "pilot", "--participant", "P1", "--kind", "pilot", "--db", file},
          {"calibrate", "--preset", "2diy_gen3", "--mark", "0,70", "--mark=-20,70", "-o",
           folder.file("marks.toml")}}) {
        CAPTURE(opens);
        const auto left = engine::torque_packet(5, {0.1, 0.1});
        REQUIRE(left);
        write(folder.file("board"),
              {reinterpret_cast<const char*>(left->view().data()), left->view().size()});
        REQUIRE(eventually([&] { return board.motors() != "0, 0"; }));
        Process program(joined(command_of(opens), {"--device", board.word()}),
                        {"SDL_VIDEODRIVER=dummy"});
        CHECK(eventually([&] { return board.motors() == "0, 0"; }));
        CHECK(eventually([&] {
            const std::string out = program.out();
            return !program.running() || out.find("Bring the handle") != std::string::npos ||
                   out.find("If it ends early") != std::string::npos;
        }));
        program.signal(SIGTERM);
        static_cast<void>(program.wait());
    }
    CHECK_THAT(board.said(), Has("0 of ") && !Has("0 of 0 "));
}
