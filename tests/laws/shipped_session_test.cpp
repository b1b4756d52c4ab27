#include "protocols/library/shipped.hpp"
#include "tests/support/program.hpp"
#include "tests/support/rig_file.hpp"
#include "tests/support/short_text.hpp"
#include "tests/support/sql_first.hpp"
#include "tests/support/studies.hpp"

namespace {

const std::string kForms = PALPATE_SOURCE_DIR "/tests/golden/free_forms.toml";

struct Short {
    const char* name;
    std::vector<std::pair<std::string, std::string>> edits;  ///< to make it short
    std::int64_t trials;
    std::int64_t intervals;
    std::int64_t steps;
};

}  // namespace

TEST_CASE(
    "every shipped protocol runs by itself, stores what was planned, and verify finds nothing") {
    const Short one =
        GENERATE(Short{"curvature_2afc", {{"trials = 60", "trials = 5"}}, 14, 28, 10},
                 Short{"friction_threshold",
                       {{"trials = 40", "trials = 4"}, {"trials = 40", "trials = 4"}},
                       12,
                       24,
                       8},
                 Short{"softness_2afc", {{"trials = 60", "trials = 5"}}, 9, 18, 5},
                 Short{"pilot", {{"repetitions = 2 ", "repetitions = 1 "}}, 12, 12, 0},
                 Short{"stress", {{"repetitions = 50", "repetitions = 1"}}, 6, 6, 0});
    CAPTURE(one.name);
    const TemporaryFolder folder;
    const std::string file = write(folder.file("p.toml"), short_text(one.name, one.edits));
    const std::string db = folder.file("a.sqlite");
    const Finished sequence = ran({"sequence", file, "--participant", "P1", "--csv"});
    CHECK(std::count(sequence.out.begin(), sequence.out.end(), '\n') == one.trials + 1);
    ran({"check", one.name});
    CHECK_THAT(ran(run_words(file, "P1", db, {"--headless"})).out, Has("Finished."));
    {
        data::Database database(db, data::Access::read);
        CHECK(count(database, "plan") == one.trials);
        CHECK(count(database,
                    "response JOIN trial USING (trial_id) WHERE "
                    "invalid_reason IS NULL") == one.trials);
        CHECK(count(database,
                    "presentation JOIN trial USING (trial_id) JOIN response "
                    "USING (trial_id) WHERE invalid_reason IS NULL") == one.intervals);
        CHECK(count(database, "analysis_trial WHERE run_trial_number IS NOT NULL") == one.steps);
        // From its rest on a soft object gives no more than sampling leaks.
        CHECK((one.name != std::string("softness_2afc") ||
               count(database, "trial WHERE worst_episode_j > 0") == 0));
    }
    CHECK_THAT(ran({"verify", db}).out, Has("Nothing differs"));
}

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

TEST_CASE("the default study, whole: every condition equally often, forces lawful on every tick") {
    const RunFile file("shape_friction");
    CHECK(sql_row(file,
                  "SELECT count(*), min(n), max(n) FROM (SELECT count(*) AS n FROM analysis_trial "
                  "WHERE counts AND phase = 'main' GROUP BY planned_object, friction)") ==
          "10,10,10");
    CHECK(sql_row(file,
                  "SELECT sum(phase = 'practice'), sum(phase = 'catch') FROM analysis_trial WHERE "
                  "counts") == "10,4");
    // Ticks outside and inside; those that are not without any force outside, or not a push of at
    // most 10 N inside (a force that is no number is NULL); the most beyond the cone, and the
    // highest mu.
    CHECK(sql_row(file,
                  "SELECT sum(outside) > 10000, sum(NOT outside) > 10000, sum(NOT "
                  "coalesce(iif(outside, rendered_x_n = 0 AND rendered_y_n = 0 AND rendered_z_n = "
                  "0 AND commanded_x_n = 0 AND commanded_y_n = 0 AND commanded_z_n = 0, "
                  "rendered_normal_n >= 0 AND commanded_x_n * commanded_x_n + commanded_y_n * "
                  "commanded_y_n + commanded_z_n * commanded_z_n <= 100 + 1e-9), 0)), "
                  "max(iif(outside, -1, abs(rendered_tangential_n) - iif(friction = 'on', 0.7, 0) "
                  "* rendered_normal_n)) <= 1e-9, max(iif(outside, 0, mu)) <= 0.7 FROM (SELECT *, "
                  "mode = 'free' AS outside FROM sample JOIN analysis_trial USING (trial_id) WHERE "
                  "counts)") == "1,1,0,1,1");
}
