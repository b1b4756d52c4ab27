#include "engine/math/elementary.hpp"
#include "protocols/file/calibration_file.hpp"
#include "tests/support/program.hpp"
#include "tests/support/rig_file.hpp"

namespace {

/// `palpate calibrate` with the words, somebody at the keyboard who presses Enter so many times.
Finished calibrate(const std::string& words, int enters = 100) {
    return shell(fmt::format("yes '' | head -n {} | \"$0\" calibrate {}", enters, words));
}

/// The simulated encoders' hidden error, rad.
constexpr double kHidden[] = {0.2345, -0.1234};

}  // namespace

TEST_CASE(
    "calibrate finds the hidden zeros of a simulated machine, and writes what a session reads") {
    const TemporaryFolder folder;
    const std::string preset = GENERATE("haplet", "2diy_gen2", "2diy_gen3", "mk2");
    const std::string marks = GENERATE("", "--mark 0,20", "--mark=-30,0 --mark 30,0 --mark 0,35");
    CAPTURE(preset, marks);
    const std::string file = folder.file("desk.toml");
    const Finished run =
        ended(calibrate("--device sim --preset " + preset + " " + marks + " -o " + file));
    const engine::Calibration before = protocols::load_calibration(preset);
    const engine::Calibration after = protocols::load_calibration(file);
    for (std::size_t i = 0; i < 2; ++i) {
        const engine::Axis& axis = before.pantograph.axes[i];
        const double error = after.pantograph.axes[i].zero - axis.zero - kHidden[i];
        // Half a count of the encoder.
        CHECK(std::fabs(std::remainder(error, 2.0 * engine::kPi)) <
              1.1 * engine::kPi / axis.counts_per_turn);
        CHECK(after.pantograph.axes[i].counts_per_turn == axis.counts_per_turn);
    }
    CHECK_THAT(run.out, Has("missed by 0.0", "Calibration " +
                                                 protocols::calibration_id(after).substr(0, 12) +
                                                 " written to " + file));
    // Calibrated again from its own file, it is the same machine.
    const std::string again = folder.file("again.toml");
    REQUIRE(calibrate("--preset " + file + " " + marks + " -o " + again).code == 0);
}

TEST_CASE("calibrate finds counts per turn when asked, with three marks") {
    const TemporaryFile file("desk.toml");
    ended(calibrate("--scale --mark=-30,0 --mark 30,0 --mark 0,35 -o " + file));
    const auto axes = protocols::load_calibration(file).pantograph.axes;
    CHECK(std::fabs(axes[0].counts_per_turn / 65536.0 - 1.0) < 1e-3);
    CHECK(std::fabs(axes[1].counts_per_turn / 65536.0 - 1.0) < 1e-3);
}

TEST_CASE("calibrate says that marks at one place prove nothing, however many") {
    const TemporaryFolder folder;
    const auto said = [&](const std::string& marks) {
        return ended(calibrate(marks + " -o " + folder.file("desk.toml"))).out;
    };
    for (const char* together : {"--mark 0,20", "--mark 0,20 --mark 0,20 --mark 1,21"}) {
        CHECK_THAT(said(together), Has("Marks at one place are always met"));
    }
    CHECK_THAT(said("--mark 0,20 --mark 0,20 --mark 0,31"), !Has("always met"));
}

TEST_CASE("calibrate refuses what cannot be, says why, and leaves no file") {
    const TemporaryFolder folder;
    const std::string file = folder.file("desk.toml");
    check_end(calibrate("--scale --mark 0,0 --mark 10,0 --mark 20,0 -o " + file), 1,
              Has("lie in line"));
    check_end(calibrate("--mark 0,0 --mark 10,0 -o " + file, 1), 3, Has("nothing was written"));
    CHECK(folder.names().empty());
    CHECK(calibrate("-o " + folder.file("no/such/folder.toml")).code != 0);
}

TEST_CASE("calibrate leaves a commissioning record as it is, and takes no damping from one") {
    const TemporaryFolder folder;
    const std::string rig = commissioned_rig(folder, "haply:/dev/one", "mk2");
    const std::string sealed = slurp(rig);
    for (const std::string& before : {sealed, "# desk 2\n" + sealed}) {  // the second has no seal
        write(rig, before);
        for (const std::string& preset : {std::string("mk2"), "'" + rig + "'"}) {
            CAPTURE(preset, before);
            check_end(
                calibrate("--preset " + preset + " -o '" + rig + "'"), 2,
                Has("rig.toml is the commissioning record of haply:/dev/one: give another file"));
            CHECK(slurp(rig) == before);
        }
    }
    write(rig, sealed);
    const std::string other = folder.file("other.toml");
    const Finished run = ended(calibrate("--preset '" + rig + "' -o '" + other + "'"));
    CHECK_THAT(run.out, Has("left out damping_n_s_per_m, which was measured on haply:/dev/one"));
    CHECK_FALSE(protocols::load_calibration(other).pantograph.damping);
}

TEST_CASE("a session whose calibration cannot be is refused before a file is made") {
    const TemporaryFolder folder;
    for (const char* kind : {"pilot", "real"}) {
        const Finished run =
            palpate_command(run_words("shape_friction_demo", "P1", folder.file("d.sqlite"),
                                      {"--kind", kind, "--device", "sim", "--calibration", "mk9"}));
        CAPTURE(kind);
        check_end(run, 2, Has("there is no such calibration"));
        CHECK(folder.names().empty());
    }
}

TEST_CASE("a calibration that no desk-top machine has is refused at its place") {
    const TemporaryFolder folder;
    const std::string file = folder.file("c.toml");
    std::string text = slurp(PALPATE_SOURCE_DIR "/protocols/library/pantographs.toml");
    text.erase(0, text.find("# 2DIY, second generation"));
    text.erase(text.find("[[pantograph]]", text.find("[[pantograph]]") + 1));
    const std::string beyond = "torque_limit_mn_m = 1000000";
    text = replaced(text, "torque_limit_mn_m = 123", beyond);
    write(file, "format = 1\n" + text);
    const Finished end = ran(run_words("shape_friction_demo", "P1", folder.file("d.sqlite"),
                                       {"--device", "sim", "--calibration", file}),
                             2);
    CHECK_THAT(end.error, Has(file + ":", ": torque_limit_mn_m is 1000000: give ", "2000"));

    const auto checked = [&](const std::string& from, const std::string& to) {
        write(file, "format = 1\n" + replaced(text, from, to));
        const std::string said = ran({"check", "pilot", "--calibration", file}, 2).error;
        CHECK_THAT(said, Has(file + ":"));
        return said;
    };
    CHECK_THAT(checked(beyond, "torque_limit_mn_m = 124"),
               Has("is 124 mN m, and a Haply board gives 123 at most"));
    CHECK_THAT(checked(beyond, "torque_limit_mn_m = 0.123"),
               Has("for ever (mN m) of axis 1 is 60: give a number above 0, at most 0.123"));
    text = replaced(text, beyond, "torque_limit_mn_m = 123");
    const std::string counts = "counts_per_turn = " + behind(text, "counts_per_turn = ");
    CHECK_THAT(checked(counts, "counts_per_turn = 1e-9"), Has(": counts_per_turn is 1e-09: give "));
}
