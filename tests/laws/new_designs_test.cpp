#include "tests/support/program.hpp"
#include "tests/support/rig_file.hpp"
#include "tests/support/sql_first.hpp"

namespace {

const std::string kForms = PALPATE_SOURCE_DIR "/tests/golden/free_forms.toml";

}  // namespace

TEST_CASE("free forms in friction blocks are felt, distinguished, kept, and verified to the bit") {
    const RunFile file(kForms);
    CHECK_THAT(ran({"verify", file}).out, Has("Nothing differs"));
    // The observer has a noise of 0.2 mm and no lapses, the forms differ by millimetres.
    check_truths(file, "free_form_truths.tsv");
    CHECK_THAT(palpate_command({"summary", file}).out, Has("[exclusion] leave out none of 1"));
}

TEST_CASE("whoever is counted, the order of friction blocks is verified as it was") {
    const TemporaryFolder folder;
    const std::string file = folder.file("d.sqlite");
    const std::string study = folder.file("p.toml");
    std::filesystem::copy_file(kForms, study);
    std::ofstream(study, std::ios::app)  // short trials: their order is what counts
        << "[timing]\nexplore_min_s = 0.1\nexplore_prompt_s = 0.2\nexplore_timeout_s = 0.3\n";
    for (const char* code : {"P1", "P2", "P3", "P4", "P5", "P6"}) {
        run_by({code}, study, file);
        // As if people had felt it: only they count for the next one's order.
        sql_edit(file, "UPDATE session SET session_kind = 'real'");
    }
    CHECK(sql_first(
              file,
              "SELECT group_concat(n) FROM (SELECT count(*) AS n FROM plan WHERE phase = 'main' "
              "AND block = 0 GROUP BY friction)") == "12,12");
    const Finished verified = palpate_command({"verify", file});
    CAPTURE(verified.out);
    CHECK_THAT(verified.out, !Has("plan_sha256"));
}

TEST_CASE("another outline under the same name is found by its hash") {
    const RunFile file(kForms);
    sql_edit(file, "UPDATE session_provenance SET value = 'ffff' WHERE key = 'object sha256 dome'");
    CHECK_THAT(ran({"verify", file}, 1).out, Has("dome"));
}

TEST_CASE("sequence and check show friction blocks and free forms") {
    const TemporaryFile sheet("o.svg");
    CHECK_THAT(ran({"check", kForms, "--svg", sheet, "--long"}).out,
               Has("16 main in 4 blocks", "(one a block)", "frictions of the blocks: "));
    CHECK_THAT(slurp(sheet), Has("free form, 80", "dome"));
    CHECK_THAT(ran({"sequence", kForms, "--participant", "P1"}).out,
               Has("friction blocks: row", "of 2 of the"));
    CHECK_THAT(palpate_command({"sequence", kForms, "--participant", "P1", "--csv"}).out,
               Has(",dome,,o"));
    CHECK_THAT(palpate_command({"new", "--keys"}).out,
               Has("[[object.segment]]", "five_shapes", "friction_blocks", "catch_correct_min"));
}

TEST_CASE("a left-hander is not run in a right-handers' study, and nothing is recorded") {
    const TemporaryFolder folder;
    const std::string file = folder.file("d.sqlite");
    ran({"participant", file, "L1", "--new", "--handedness=-60"});
    const Words run = run_words("shape_friction", "L1", file,
                                {"--device", "haply:/nonexistent", "--calibration",
                                 commissioned_rig(folder, "haply:/nonexistent")});
    check_end(unseen(run), 2, Has("asks for handedness \"right\"", "a score of -60", "pilot"));
    CHECK(sql_first(file, "SELECT count(*) FROM session") == "0");
}
