#include "tests/support/mixed_study.hpp"
#include "tests/support/program.hpp"
#include "tests/support/sql_first.hpp"

TEST_CASE(
    "Python computes every column of the views and the ten usual questions again, and notices a "
    "changed value",
    "[long]") {
    const TemporaryFolder folder;
    const std::string file = mixed_study(folder);
    const auto ticks = palpate_command(
        {"sql", file, "--csv", "-c", "SELECT * FROM sample ORDER BY trial_id, interval, tick"});
    REQUIRE(ticks.code == 0);
    std::ofstream(folder.file("sample.csv")) << ticks.out;
    if (!installed("python3 with sqlite3", {"python3", "-c", "import sqlite3, csv"})) {
        return;
    }
    const auto recompute = [&](const std::string& of) {
        return Process({"python3", PALPATE_SOURCE_DIR "/tests/support/recompute.py", of,
                        folder.file("sample.csv"), PALPATE_SOURCE_DIR "/docs/data.md"})
            .wait();
    };
    const Finished same = recompute(file);
    CAPTURE(same.out, same.error);
    CHECK(same.code == 0);
    CHECK_THAT(same.out, Has("values, 0 differences"));
    sql_edit(file,
             "UPDATE trial SET strokes = strokes + 1, mean_speed_m_per_s = mean_speed_m_per_s * "
             "1.0001 WHERE trial_id = 2; UPDATE presentation SET reversals = reversals + 1, "
             "path_length_m = path_length_m * 1.0001 WHERE trial_id = 2; DROP VIEW confusion; "
             "CREATE VIEW confusion AS SELECT study_name, session_kind, friction, planned_object, "
             "chosen_object, count(*) + 1 AS n FROM analysis_trial WHERE counts AND phase = 'main' "
             "GROUP BY 1, 2, 3, 4, 5");
    const Finished changed = recompute(file);
    CHECK(changed.code == 1);
    CHECK_THAT(changed.out, Has(": strokes is ", ": mean_speed_m_per_s is ", ": reversals is ",
                                ": path_length_m is ", "confusion"));
}
