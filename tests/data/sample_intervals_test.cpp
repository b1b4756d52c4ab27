#include "tests/support/sample_rows.hpp"
#include "tests/support/short_text.hpp"
#include "tests/support/studies.hpp"

namespace {

/// With every interval short, too.
std::string brief_text(std::string_view name,
                       std::vector<std::pair<std::string, std::string>> edits) {
    edits.emplace_back("[timing]\nexplore_min_s = 2\n",
                       "[invalid]\ncontact_min_s = 0\npath_min_mm = 0\n\n"
                       "[timing]\nexplore_min_s = 0.5\n");
    edits.emplace_back("explore_prompt_s = 10", "explore_prompt_s = 0.8");
    edits.emplace_back("explore_timeout_s = 15", "explore_timeout_s = 1");
    return short_text(name, edits);
}

}  // namespace

TEST_CASE("in a study of two intervals every value of both is the reader's tick to the bit",
          "[sample][law]") {
    const std::string study = GENERATE("curvature_2afc", "friction_threshold", "softness_2afc");
    std::vector<std::pair<std::string, std::string>> edits{
        {"practice_trials = 4", "practice_trials = 1"}};
    if (study == "friction_threshold") {
        edits.insert(edits.end(), 2, {"trials = 40", "trials = 4"});
    } else {
        edits.emplace_back("trials = 60", study == "softness_2afc" ? "trials = 8" : "trials = 4");
    }
    const std::string text = brief_text(study, edits);
    const TemporaryFolder folder;
    std::ofstream(folder.file("p.toml")) << text;
    const std::string file = folder.file("a.sqlite");
    ran(run_words(folder.file("p.toml"), "P1", file, {"--headless"}));
    data::Database database(file, data::Access::read);
    REQUIRE(data::add_extension(database.handle()) == 0);
    // What the rule chose is what the intervals differ by, and nothing that the protocol has.
    CHECK(sql_rows(database,
                   study == "curvature_2afc"  ? "SELECT DISTINCT curvature_per_m FROM presentation"
                   : study == "softness_2afc" ? "SELECT DISTINCT stimulus FROM presentation"
                                              : "SELECT DISTINCT mu_s FROM presentation")
              .size() > 3);
    std::size_t ticks = 0;
    const auto trials = sql_rows(database, "SELECT trial_id FROM trial ORDER BY trial_id");
    REQUIRE(trials.size() == 9);
    for (const SampleRow& one : trials) {
        const std::int64_t trial = std::stoll(one[0]);
        std::vector<SampleRow> both;
        for (const std::int64_t interval : {1, 2}) {
            CAPTURE(trial, interval);
            const auto expected = expected_rows(database, trial, interval);
            REQUIRE(expected.size() > 100);
            require_same(
                sql_rows(database,
                         fmt::format("SELECT * FROM sample WHERE trial_id = {} AND interval = {}",
                                     trial, interval)),
                expected);
            both.insert(both.end(), expected.begin(), expected.end());
        }
        CAPTURE(trial);
        require_same(
            sql_rows(database, fmt::format("SELECT * FROM sample WHERE trial_id = {}", trial)),
            both);
        ticks += both.size();
    }
    CHECK(sql_rows(database, "SELECT count(*) FROM sample")[0][0] == std::to_string(ticks));
}
