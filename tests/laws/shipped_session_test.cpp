#include "protocols/library/shipped.hpp"
#include "tests/support/program.hpp"
#include "tests/support/short_text.hpp"
#include "tests/support/studies.hpp"

namespace {

struct Short {
    const char* name;
    std::vector<std::pair<std::string, std::string>> edits;  ///< to make it short
    std::int64_t trials;
    std::int64_t intervals;
    std::int64_t steps;
};

/// A shipped protocol with the edits made, in a file of its own.
std::string written(const TemporaryFolder& folder, const Short& one) {
    const std::string file = folder.file("p.toml");
    std::ofstream(file) << short_text(one.name, one.edits);
    return file;
}

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
    const std::string file = written(folder, one);
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
