#include "tests/support/free_board.hpp"
#include "tests/support/program.hpp"
#include "tests/support/udp_port.hpp"

// A rig from the box to its first session, by the shipped program: a board on a pseudo-terminal
// whose handle nobody holds, an operator who types, and what is left in files and on the wire.

namespace {

std::string commissioning(const FreeBoard& board, const std::string& file) {
    return "commission --device " + board.word() + " -o '" + file + "'";
}

}  // namespace

TEST_CASE("commission writes a calibration with the damping it found, its record and their hash") {
    const TemporaryFile file("rig.toml");
    CHECK_THAT(ran({"commission", "-o", file}).out,
               Has("usable stiffness at 1 kHz", "dry friction"));
    const protocols::RigFile rig = protocols::load_rig(file);
    REQUIRE(rig.record);
    CHECK(rig.record->device == "sim");
    CHECK(rig.record->calibration == protocols::calibration_id(rig.calibration));
    CHECK(rig.calibration.pantograph.damping == rig.record->damping);
    CHECK(protocols::to_toml(rig.calibration, *rig.record) == slurp(file));
    const engine::PlantModel true_plant;
    CHECK(rig.record->dynamics.handle_mass == Approx(true_plant.handle_mass).epsilon(0.05));
    CHECK(rig.record->dynamics.damping.x == Approx(true_plant.damping.x).epsilon(0.05));

    // It is another rig's no more by accident.
    const Finished another = ran({"commission", "--device", "haply-emulator", "-o", file}, 2);
    CHECK_THAT(another.error, Has("is the record of sim, and this is haply-emulator: "
                                  "give another file to write"));
    CHECK(protocols::load_rig(file).record->device == "sim");

    write(file, replaced(slurp(file), "handle_g = ", "handle_g = 1"));
    const Finished changed = ran({"check", "pilot", "--calibration", file}, 2);
    CHECK_THAT(changed.error, Has("changed after the rig was commissioned"));

    ran({"commission", "--device", "mouse", "-o", file}, 2);
    CHECK_THAT(ran({"commission", "--handle-g", "120", "-o", file}, 1).error,
               Has("motor 1 is too strong", "weigh the handle and give --handle-g"));
}

TEST_CASE(
    "a real session on a rig without a fitting record is refused with what to do, before a file") {
    const TemporaryFolder folder;
    const auto run = [&](const std::string& device, const std::string& calibration) {
        const Words words =
            run_words(study_of_rig(folder), "P1", folder.file("d.sqlite"), {"--device", device});
        const Words with = calibration.empty() ? Words{} : Words{"--calibration", calibration};
        return ended(unseen(joined(words, with)), 2).error;
    };
    const std::string rig = commissioned_rig(folder, "haply:/dev/one");
    CHECK_THAT(run("haply:/dev/one", ""),
               Has("no real session: nobody proved",
                   "palpate commission --device haply:/dev/one -o rig.toml"));
    CHECK_THAT(run("haply:/dev/two", rig), Has("was commissioned for --device haply:/dev/one"));
    protocols::RigFile file = protocols::load_rig(rig);
    file.calibration.pantograph.origin.x += 0.001;
    write(rig, protocols::to_toml(file.calibration, *file.record));
    CHECK_THAT(run("haply:/dev/one", rig), Has("the calibration in", "was changed after"));
    file.record->calibration = protocols::calibration_id(file.calibration);
    file.record->program = "0.0.1";
    write(rig, protocols::to_toml(file.calibration, *file.record));
    CHECK_THAT(run("haply:/dev/one", rig), Has("was commissioned by palpate 0.0.1"));
    CHECK_FALSE(std::filesystem::exists(folder.file("d.sqlite")));
}

TEST_CASE("of a record of another device nothing is believed, and the command that is named works",
          "[haply]") {
    const TemporaryFolder folder;
    FreeBoard board(folder);
    const std::string study = folder.file("stiff.toml");
    write(study, replaced(slurp(study_of_rig(folder)), "stiffness_n_per_m = 200",
                          "stiffness_n_per_m = 2000"));
    const std::string rig = commissioned_rig(folder, board.word());
    const auto said = [&](const std::string& command, const std::string& calibration) {
        const Words of = command == "check"
                           ? Words{study}
                           : Words{"--protocol", study, "--seconds", "0.05", "--json"};
        const Words with = calibration.empty() ? Words{} : Words{"--calibration", calibration};
        return unseen(joined({command, "--device", board.word()}, joined(with, of)));
    };
    const auto before = std::filesystem::current_path();
    std::filesystem::current_path(folder.path());
    const std::string measured = "the device damps 1.";
    const Finished own = said("check", rig);
    CHECK_THAT(own.out, Has("it cannot be run", measured) && !Has("no real session"));
    CHECK_THAT(said("doctor", rig).out, Has("rig.toml is the record of this device", measured));
    for (const std::string& calibration :
         {commissioned_rig(folder, "haply:/dev/one"), std::string()}) {
        const std::string why = calibration.empty()
                                  ? "nobody proved how --device "
                                  : "was commissioned for --device haply:/dev/one";
        CAPTURE(why);
        const Finished check = ended(said("check", calibration));
        CHECK_THAT(check.out, Has("it can be run as a pilot", "no real session: ", why,
                                  "how much the device damps is not known") &&
                                  !Has(measured));
        CHECK_THAT(said("doctor", calibration).out,
                   Has("no real session can be run on it", why, "by what nobody measured") &&
                       !Has(measured));
        const std::string end = " -o rig_2.toml";
        const std::string words =
            "commission " + behind(check.out, "palpate commission ", end) + end;
        TypedTo named(folder, calibration.empty() ? "none" : "another", words);
        CAPTURE(words);
        CHECK(named.says("Type yes:"));
        named.program().signal(SIGTERM);
        static_cast<void>(named.program().wait());
    }
    std::filesystem::current_path(before);
}

TEST_CASE("a free handle on a board is commissioned over its port by an operator who brings it",
          "[haply]") {
    const TemporaryFolder folder;
    FreeBoard board(folder, "--handle-g 120 --handle-damping 0.5 --handle-friction 0.03");
    const std::string commission = "commission --handle-g 120 --device " + board.word() + " -o '" +
                                   folder.file("new.toml") + "'";
    protocols::RigFile rig;
    const auto found = [&] {
        board.bring("0,89.3");
        const Finished end = operated(folder, board, commission);
        UNSCOPED_INFO(end.out << end.error);
        if (end.code != 0) {
            return false;
        }
        rig = protocols::load_rig(folder.file("new.toml"));
        return rig.record && rig.record->dynamics.handle_mass == Approx(0.12).epsilon(0.25) &&
               rig.record->dynamics.handle_damping == Approx(0.5).epsilon(0.25) &&
               rig.record->dynamics.handle_friction == Approx(0.03).epsilon(0.25);
    };
    // An ordinary program of an ordinary clock: where it gets no turn, a pulse lasts longer than
    // was asked for.
    REQUIRE((found() || found() || found() || found() || found()));
    CHECK(rig.record->round_trip > 0.0);
    CHECK(rig.record->stiffness > 200.0);
}

TEST_CASE("the example of a device behind UDP is commissioned as a board is, and needs its record",
          "[open]") {
    const TemporaryFolder folder;
    const std::string calibration = PALPATE_SOURCE_DIR "/examples/udp_device.toml";
    FreeBoard device(folder, free_port());
    const std::string commission =
        fmt::format("commission --device {} --calibration '{}' --handle-g 100 -o '{}'",
                    device.word(), calibration, folder.file("rig.toml"));
    Finished end = operated(folder, device, commission, "0,0");
    // An ordinary program of an ordinary clock: where it gets no turn, a pulse lasts longer than
    // was asked for, what is seen of it is the way back, or the device falls silent.
    const auto had_no_turn = [&] {
        return (Has("is not explained by") || Has("is reversed") || Has("fell silent"))
            .match(end.error);
    };
    for (int again = 0; again < 8 && had_no_turn(); ++again) {
        device.bring("0,0");
        end = operated(folder, device, commission, "0,0");
    }
    ended(end);
    const protocols::RigFile rig = protocols::load_rig(folder.file("rig.toml"));
    REQUIRE(rig.record);
    CHECK(rig.record->dynamics.handle_mass == Approx(0.1).epsilon(0.15));
    CHECK(rig.record->board == 1);  // as the example says
    const Finished moved = operated(
        folder, device,
        ran_words(folder, device.word()) + " --calibration '" + calibration + "' --handle-free",
        "0,0");
    check_end(moved, 2, Has("nobody proved how --device board:udp:"));
}

TEST_CASE("a handle that somebody holds is not commissioned, and leaves no file", "[haply]") {
    const TemporaryFolder folder;
    FreeBoard board(folder);
    board.hold();
    const Finished end = operated(folder, board, commissioning(board, folder.file("new.toml")));
    check_end(end, 1, Has("does nobody hold it"));
    CHECK(board.motors() == "0, 0");
    CHECK_FALSE(std::filesystem::exists(folder.file("new.toml")));
}

TEST_CASE("a board with a motor reversed is refused by commission, and by the opening of a session",
          "[haply]") {
    const TemporaryFolder folder;
    engine::Calibration reversed = protocols::load_calibration("2diy_gen3");
    reversed.haply->motor_clockwise[0] = true;
    write(folder.file("reversed.toml"), protocols::to_toml(reversed));
    FreeBoard board(folder, "--preset '" + folder.file("reversed.toml") + "'");
    const Finished end = operated(folder, board, commissioning(board, folder.file("new.toml")));
    check_end(end, 1, Has("motor 1 is reversed: correct the wiring", "nothing was written"));
    CHECK_FALSE(std::filesystem::exists(folder.file("new.toml")));

    board.bring("0,89.3");  // home, as somebody says beforehand
    const std::string rig = commissioned_rig(folder, board.word());
    const Finished refused =
        operated(folder, board,
                 ran_words(folder, board.word()) + " --calibration '" + rig + "' --handle-free");
    check_end(refused, 1, Has("the handle", "No session was begun"));
}

TEST_CASE("a handle that rests 4 to 12 mm off home is found at the second mark, before any session",
          "[haply]") {
    const TemporaryFolder folder;
    EACH(at, as<std::string>{}, "0,93.3", "-10,89.3", "0,77.3");
    FreeBoard board(folder, "--at=" + at);
    const std::string rig = commissioned_rig(folder, board.word());
    const Finished end = operated(
        folder, board, ran_words(folder, board.word()) + " --calibration '" + rig + "'", at);
    check_end(end, 1,
              Has("it did not rest at home") || Has("the handle was not at home") ||
                  Has("of what it should"));
    CHECK_FALSE(std::filesystem::exists(folder.file("d.sqlite")));
}

TEST_CASE("a handle that was not brought to a mark is refused there, with no torque so far",
          "[haply]") {
    const TemporaryFolder folder;
    FreeBoard board(folder);
    TypedTo program(folder, "desk", commissioning(board, folder.file("rig.toml")));
    const auto asked = [&](const char* what) {
        return program.program().says(what);
    };
    REQUIRE(asked("Type yes:"));
    program.type("yes");
    REQUIRE(asked("Bring the handle to"));
    program.type("");  // it stands at home
    const Finished end = program.program().wait();
    check_end(end, 1,
              Has("the handle stands where it stood before") ||
                  Has("stopped answering"));  // a busy machine
    CHECK(count_of(end.out, "Bring the handle to") == 1);
    CHECK(board.motors() == "0, 0");
    CHECK_FALSE(std::filesystem::exists(folder.file("rig.toml")));
}

TEST_CASE(
    "a stiffness or a delay that the device's damping does not bear is refused, before a file",
    "[haply]") {
    const TemporaryFolder folder;
    engine::Calibration damped = protocols::load_calibration("2diy_gen3");
    damped.pantograph.damping = 0.8;  // at 200 N/m and 1 kHz: 3.5 ticks; with one tick: 533 N/m
    write(folder.file("damped.toml"), protocols::to_toml(damped));
    const bool slow = GENERATE(false, true);
    FreeBoard board(folder, slow ? "--delay-ms 6" : "");
    write(folder.file("asked.toml"),
          replaced(slurp(study_of_rig(folder)), "stiffness_n_per_m = 200",
                   slow ? "stiffness_n_per_m = 200" : "stiffness_n_per_m = 2000"));
    const Finished end =
        operated(folder, board,
                 "run '" + folder.file("asked.toml") + "' --participant P1 --db '" +
                     folder.file("d.sqlite") + "' --windowed --kind pilot --device " +
                     board.word() + " --calibration '" + folder.file("damped.toml") + "'");
    CAPTURE(slow);
    check_end(end, 2,
              Has("the device damps 0.8 N s/m", "of delay needs ", "lower stiffness_n_per_m to "));
    CHECK((end.error.find(" ticks of delay") != std::string::npos) >= slow);
    CHECK_FALSE(std::filesystem::exists(folder.file("d.sqlite")));
}

TEST_CASE("commission says where home is and asks until somebody says yes, with no torque before",
          "[haply]") {
    const TemporaryFolder folder;
    FreeBoard board(folder);
    TypedTo program(folder, "desk", commissioning(board, folder.file("rig.toml")));
    const auto asked = [&](std::size_t n) {
        return eventually([&] { return count_of(program.program().out(), "Type yes:") == n; });
    };
    REQUIRE(asked(1));
    CHECK_THAT(program.program().out(),
               Has("It has to rest at home, (0, 89.", "Nobody may hold the handle"));
    std::size_t questions = 1;
    for (const char* answer : {"", "no", "yes please"}) {
        CAPTURE(answer);
        program.type(answer);
        CHECK(asked(++questions));
        CHECK(program.program().running());
        CHECK(board.motors() == "0, 0");
    }
    CHECK_THAT(program.program().out(), !Has("the handle is free\n"));
    program.type("yes");
    CHECK(eventually([&] {
        return program.program().out().find("the handle is free\n") != std::string::npos ||
               starved(program.program().error());
    }));
    CHECK(count_of(program.program().out(), "Type yes:") == questions);

    // A board that is opened anew where the handle stands takes that for home, and not unseen.
    if (!program.says("Bring the handle to")) {
        return;  // a busy machine
    }
    board.bring(last_place(program.program().out()));
    board.signal(SIGSTOP);
    program.type("");
    pause(0.3);
    board.signal(SIGCONT);
    CHECK_THAT(program.program().wait().error, Has("was opened anew while the handle was at (") ||
                                                   Has("did not rest") || Has("stopped answering"));
}
