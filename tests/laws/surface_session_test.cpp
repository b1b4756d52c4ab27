#include "tests/support/program.hpp"
#include "tests/support/short_text.hpp"
#include "tests/support/sql_first.hpp"

namespace {

/// The shipped study with one repetition and without practice: eight trials. @param edit one more
/// edit
std::string study(const TemporaryFolder& folder,
                  const std::pair<std::string, std::string>& edit = {}) {
    return write(
        folder.file("patches.toml"),
        short_text("patch_friction", {{"repetitions = 5", "repetitions = 1"},
                                      {"practice_repetitions = 1", "practice_repetitions = 0"},
                                      edit}));
}

Words run(const std::string& protocol, const std::string& db, const std::string& device) {
    return run_words(protocol, "P1", db, {"--headless", "--device", device});
}

/// One session, recorded once for all.
struct Recorded {
    TemporaryFolder folder;
    std::string protocol = study(folder);
    std::string file = folder.file("a.sqlite");

    Recorded() {
        REQUIRE_THAT(ran(run(protocol, file, "sim")).out,
                     Has("8 answered, 0 of them do not count, 0 faulted"));
    }
};

const Recorded& recorded() {
    static const Recorded session;
    return session;
}

}  // namespace

TEST_CASE("a session on surfaces is stored whole, and verify finds nothing in it") {
    const Recorded& session = recorded();
    CHECK_THAT(ran({"verify", session.file}).out, Has("Nothing differs"));
    CHECK(sql_row(session.file, "SELECT device FROM session") == "simulated gantry");
}

TEST_CASE("what sample says of surfaces is what their geometry and laws ask for") {
    check_truths(recorded().file, "surface_truths.tsv");
}

TEST_CASE("an export of surfaces has every coordinate") {
    const Recorded& session = recorded();
    const std::string out = session.folder.file("csv");
    ran({"export", session.file, "-o", out, "--kind", "simulated", "--traces"});
    CHECK_THAT(slurp(out + "/columns.csv"),
               Has("hip_z_m", "go_z_m", "cp_z_m", "rendered_z_n", "commanded_z_n"));
}

TEST_CASE("a report of surfaces names both curvatures of each patch") {
    const Recorded& session = recorded();
    const std::string page = session.folder.file("report.html");
    ran({"report", session.file, "--kind", "simulated", "--simulations", "19", "--bootstrap", "19",
         "-o", page});
    CHECK_THAT(slurp(page), Has("saddle (-8 and 8 1/m)"));
}

TEST_CASE("another friction than what was felt is found") {
    const Recorded& session = recorded();
    const std::string copy = copied(session.file, session.folder.file("changed.sqlite"));
    sql_edit(copy,
             "UPDATE presentation SET mu_d = 0.5 WHERE trial_id = (SELECT min(trial_id) FROM "
             "presentation WHERE friction = 'on')");
    CHECK_THAT(ran({"verify", copy}, 1).out, Has("presentation.mu_d"));
}

TEST_CASE("surfaces are refused on machines in a plane, and with what only planes have, by name") {
    const TemporaryFolder folder;
    const std::string protocol = study(folder);
    for (const char* device : {"haply-emulator", "haply:/dev/null", "mouse"}) {
        CAPTURE(device);
        CHECK_THAT(ran(run(protocol, folder.file("a.sqlite"), device), 2).error,
                   Has("patch_friction", "give --device sim"));
        CHECK(!std::filesystem::exists(folder.file("a.sqlite")));
    }
    const auto said = [](const std::string& from, const std::string& to) {
        const TemporaryFolder own;
        const Finished checked = ran({"check", study(own, {from, to})}, 2);
        return checked.error + checked.out;
    };
    CHECK_THAT(said("[surface] ", "[outline]\na_mm = [-40, 0]\n[surface] "),
               Has("[outline] is given beside [surface]"));
    CHECK_THAT(said("curvature_per_m = 0\n", "curvature_per_m = 30\n"),
               Has("a curvature of 30 1/m is too strong for a patch of 60 mm"));
    CHECK_THAT(said("curvature_per_m = 0\n", "curvature_per_m = 0\nsize = 2\n"),
               Has("the object flat has segments, a place or a compliance"));
    CHECK_THAT(said("law = \"gos\"\nmu_s = 0.6\nmu_d = 0.4\ntau_slip_ms = 20\ntau_heal_ms = 100",
                    "law = \"viscous\"\nmu_d = 0.4\nviscous_n_s_per_m = 1"),
               Has("which surfaces do not have"));
}
