#include "tests/support/free_board.hpp"
#include "tests/support/program.hpp"
#include "tests/support/sql_first.hpp"

// Three axes from the box to their first session, by the shipped program, seen from outside.

namespace {

constexpr const char* kExample = PALPATE_SOURCE_DIR "/examples/gantry.toml";
constexpr const char* kAtHome = "0,0,40";

std::string board_words(const std::string& preset) {
    return "--open --preset '" + preset + "'";
}

/// The example with another word for a key.
std::string wired(const TemporaryFolder& folder, const std::string& key) {
    write(folder.file("wired.toml"),
          replaced(slurp(kExample), key + " = \"forward\"", key + " = \"backward\""));
    return folder.file("wired.toml");
}

std::string proving(const FreeBoard& board, const std::string& file) {
    return fmt::format("commission --device {} --calibration '{}' --moved-g 120,120,120 -o '{}'",
                       board.word(), kExample, file);
}

/// What the program says of a board that is wired so, and does to it.
/// @param home  where the handle rests at first, each time that a busy machine has it begin anew
std::string found(const TemporaryFolder& folder, FreeBoard& board, const char* home = kAtHome) {
    const std::string file = folder.file("rig.toml");
    const Finished end = operated(folder, board, proving(board, file), home);
    check_end(end, 1, Has("The motors are off and nothing was written"));
    CHECK_FALSE(std::filesystem::exists(file));
    CHECK(board.motors() == "0, 0, 0");
    return end.error;
}

}  // namespace

TEST_CASE("whatever is wrong with a board of three axes is found, named and left without a force",
          "[open]") {
    // The key of the example that has another word, what is typed to the board, and what is said.
    const auto& [key, typed, said] = GENERATE(table<std::string, Words, Words>({
        {"motor_z",
         {},
         {"motor z is reversed: turn its two wires round, or write motor_z = \"backward\""}},
        {"encoder_y", {}, {"encoder y is reversed: write encoder_y = \"backward\""}},
        {"",
         {"friction 0.05", "weight 0.03", "swap 1 2"},
         {"motor x moves axis y: swap the motors' cables",
          "motor y moves axis x: swap the motors' cables"}},
        {"",
         {"friction 0.05", "weight 0.03", "motor 2 0"},
         {"nothing counts when motor y pushes by 1 N: is it connected"}},
        {"", {"hold"}, {"no motor moves the handle by 1 N: does somebody hold it"}},
        {"",
         {"15,0,40"},
         {"encoder x counts 0.63 times",
          "All this if the handle rested at home and then at each mark: was it there"}},
        {"", {"unplug 3"}, {"encoder z did not count on the way to (0, 0, 0) mm: is its cable in"}},
    }));
    CAPTURE(key, typed);
    const TemporaryFolder folder;
    FreeBoard board(folder, board_words(key.empty() ? kExample : wired(folder, key)));
    for (const std::string& line : typed) {
        line == "hold" ? board.hold() : board.bring(line);
    }
    const bool elsewhere = typed == Words{"15,0,40"};  // where it rests at first
    const std::string error = found(folder, board, elsewhere ? "15,0,40" : kAtHome);
    for (const std::string& sentence : said) {
        CHECK_THAT(error, Has(sentence));
    }
}

TEST_CASE("commissioning of three axes that is stopped or killed leaves no force and no file",
          "[open][safety]") {
    const TemporaryFolder folder;
    EACH(signal, SIGINT, SIGTERM, SIGKILL);
    FreeBoard board(folder, board_words(kExample));
    board.bring("friction 0.6");  // pushed in vain for a while
    const std::string file = folder.file("rig.toml");
    bool pushed = false;
    for (int attempt = 0; attempt < 8 && !pushed; ++attempt) {
        board.bring(kAtHome);
        TypedTo program(folder, fmt::format("proof{}", attempt), proving(board, file));
        std::size_t brought = 0;
        CHECK(eventually([&] {
            const std::string out = program.program().out();
            if (count_of(out, "Type yes:") > 0 && brought == 0) {
                brought = 1;
                program.type("yes");
            }
            if (count_of(out, "Bring the handle to") >= brought && brought > 0 && brought < 4) {
                board.bring(last_place(out.substr(out.rfind("Bring the handle to"))));
                program.type("");
                ++brought;
            }
            pushed = brought == 4 && board.motors() != "0, 0, 0";
            return pushed || !program.program().running();
        }));
        program.program().signal(signal);
        const Finished end = program.program().wait();
        CAPTURE(end.error);
        if (pushed && signal != SIGKILL && !starved(end.error)) {
            check_end(end, 3, Has("stopped; the motors are off and nothing was written"));
        }
    }
    CHECK(pushed);
    CHECK(eventually([&] { return board.motors() == "0, 0, 0"; }));
    for (int i = 0; i < 10; ++i) {
        CHECK(board.motors() == "0, 0, 0");
        pause(0.01);
    }
    CHECK_FALSE(std::filesystem::exists(file));
}

TEST_CASE("three axes are commissioned by an operator, and then a real session is felt on them",
          "[open][window]") {
    const TemporaryFolder folder;
    auto right = std::make_unique<FreeBoard>(folder, board_words(kExample));
    FreeBoard& board = *right;
    board.bring("friction 0.3");  // 0.5 N move it, and 1 N tell its numbers
    board.bring("weight 0.15");
    write(folder.file("p.toml"),
          replaced(slurp(PALPATE_SOURCE_DIR "/protocols/library/patch_friction.toml"),
                   "start_mm = [0, 0]",
                   "start_mm = [0, 0]\nstart_radius_mm = 0"));  // it sinks from there
    const std::string db = folder.file("d.sqlite");
    const auto session = [&](const std::string& calibration) {
        return fmt::format(
            "run '{}' --participant P1 --db '{}' --windowed --device {} "
            "--calibration '{}' --kind real",
            folder.file("p.toml"), db, board.word(), calibration);
    };
    const auto refused = [&](const std::string& calibration) {
        const Finished end = operated(folder, board, session(calibration), kAtHome);
        CHECK(end.code == 2);
        CHECK_FALSE(std::filesystem::exists(db));
        return end.error;
    };
    CHECK_THAT(refused(kExample), Has("no real session: nobody proved how --device",
                                      "--moved-g X_G,Y_G,Z_G -o rig.toml"));
    const std::string file = folder.file("rig.toml");
    ended(operated(folder, board, proving(board, file), kAtHome));
    CHECK(board.motors() == "0, 0, 0");
    protocols::RigFile rig = protocols::load_rig(file);
    REQUIRE(rig.record);
    CHECK(protocols::to_toml(rig.calibration, *rig.record) == slurp(file));
    CHECK(rig.calibration.gantry->damping == rig.record->damping);
    for (const engine::AxisDynamics& axis : rig.record->axes) {
        CHECK(axis.mass == Approx(0.12).epsilon(0.25));
        CHECK(axis.damping == Approx(3.0).epsilon(0.25));
        CHECK(axis.friction == Approx(0.3).margin(0.05));
    }
    CHECK(rig.record->axes[2].pull == Approx(0.15).margin(0.03));

    std::ofstream(folder.file("changed.toml")) << [&] {
        protocols::RigFile other = rig;
        other.calibration.gantry->axes[2].radius *= 1.01;
        return protocols::to_toml(other.calibration, *other.record);
    }();
    CHECK_THAT(refused(folder.file("changed.toml")),
               Has("was changed after the rig was commissioned"));

    OpenedSession run(folder, board, session(file), kAtHome);
    run.wait_for("welcome");
    board.bring(kAtHome);
    board.bring("explore");
    bool felt = false;
    for (int i = 0; i < 1800 && !felt && run.program().running(); ++i) {
        if (run.title() == "palpate: explore") {
            felt = board.motors() != "0, 0, 0";
        } else {
            press_on(run.hand);  // also from a trouble of a busy machine
        }
        pause(0.05);
    }
    CHECK(felt);
    CHECK(run.end().code == 3);
    CHECK(board.motors() == "0, 0, 0");
    const Words proofs = lines_in(sql_lines(
        db,
        "SELECT key, value, session_kind FROM event JOIN session USING (session_id) WHERE "
        "event_kind = 'provenance' ORDER BY event_id"));
    REQUIRE(proofs.size() >= 2);
    CHECK_THAT(proofs[0], StartsWith("start pose|") && Has("second mark met to "));
    CHECK_THAT(proofs[1], StartsWith("rig check|") && EndsWith("|real"));
    CHECK(count_of(proofs[1], " % at ") == 6);
    ran({"verify", db});

    // Plugs of two axes that are exchanged, motors and encoders alike: the pulses cannot tell.
    const std::string words = session(file);
    unplug(folder, right);
    std::string plugs = slurp(kExample);
    std::swap(plugs[plugs.find("channel_x = ") + 12], plugs[plugs.find("channel_y = ") + 12]);
    write(folder.file("plugs.toml"), plugs);
    FreeBoard wrong(folder, board_words(folder.file("plugs.toml")));
    wrong.bring("friction 0.3");
    const Finished believed = operated(folder, wrong, words, kAtHome);
    CHECK(believed.code != 0);
    CHECK_THAT(believed.error, Has("the handle is at the second mark", "its plugs were exchanged"));
}
