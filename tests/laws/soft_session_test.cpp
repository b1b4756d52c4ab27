#include "tests/support/program.hpp"
#include "tests/support/sql_first.hpp"

namespace {

std::string soft_study() {
    std::string text = test_text("laws_study.toml") +
                       "[apparatus]\nrate_hz = 1000\nvertex_slew_mm_per_s = 0\n"
                       "[[friction]]\nname = \"off\"\nlaw = \"frictionless\"\n"
                       "[[friction]]\nname = \"gos\"\nlaw = \"gos\"\nmu_s = 0.7\nmu_d = 0.5\n";
    const std::string hard = "curvature_per_m = 8\n";
    return text.replace(text.find(hard), hard.size(), hard + "compliance_mm_per_n = 3\n");
}

}  // namespace

TEST_CASE("an episode is one coming into contact of soft objects too, and no free tick is cut") {
    const TemporaryFolder folder;
    const std::string db =
        run_by({"P1"}, write(folder.file("soft.toml"), soft_study()), folder.file("soft.sqlite"));
    const auto trials = csv_body(sql_csv(
        db,
        "WITH s AS (SELECT trial_id, mode, flags, lag(mode, 1, 'free') OVER (PARTITION BY "
        "trial_id ORDER BY tick) AS was FROM sample JOIN presentation USING (trial_id) WHERE "
        "tick < ticks) "
        "SELECT felt_object, sum(mode <> 'free' AND was = 'free'), contact_episodes, "
        "sum(mode = 'free' AND flags & 32), worst_episode_j FROM s JOIN trial USING "
        "(trial_id) JOIN presentation USING (trial_id) GROUP BY trial_id"));
    REQUIRE(trials.size() == 4);
    std::size_t again = 0;
    for (const Words& trial : trials) {
        CAPTURE(trial[0]);
        CHECK(trial[1] == trial[2]);
        CHECK(trial[3] == "0");
        CHECK(std::stod(trial[4]) <= 1e-12);
        again += trial[0] == "convex" && trial[2] != "1" ? 1U : 0U;
    }
    CHECK(again > 0);  // the soft one is touched more than once
    CHECK_THAT(ran({"verify", db}).out, Has("ticks replayed, nothing differs"));
    sql_edit(db, "UPDATE trial SET contact_episodes = contact_episodes - 1 WHERE trial_id = 1");
    CHECK_THAT(ran({"verify", db}, 1).out, Has("contact_episodes"));
}
