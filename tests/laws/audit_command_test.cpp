#include "data/inference/audit.hpp"
#include "tests/support/json_of.hpp"
#include "tests/support/page_reader.hpp"
#include "tests/support/random.hpp"
#include "tests/support/sql_first.hpp"

using namespace palpate::data;

TEST_CASE("the interval of an equivalence is that of R's t.test at 90 %") {
    // R 4.2, data sleep: t.test(extra ~ group, paired = TRUE, conf.level = 0.9) gives 0.8669947 to
    // 2.2930053.
    const std::vector<double> sleep{1.2, 2.4, 1.3, 1.3, 0.0, 1.0, 1.8, 0.8, 4.6, 1.4};
    const auto found = equivalence(sleep, 2.2);
    REQUIRE(found);
    CHECK(found->mean == Approx(1.58));
    CHECK(found->low == Approx(0.8669947).epsilon(1e-7));
    CHECK(found->high == Approx(2.2930053).epsilon(1e-7));
    CHECK((found->verdict == Sameness::differs));
    CHECK((equivalence(sleep, 2.3)->verdict == Sameness::within));  // not 0, and within
    const std::vector<double> few{-1.0, 2.0};
    CHECK((equivalence(few, 0.5)->verdict == Sameness::open));
    CHECK((equivalence(std::vector{0.0, 0.0, 0.0}, 0.5)->verdict == Sameness::same));
    CHECK((equivalence(std::vector{0.7, 0.7}, 0.5)->verdict == Sameness::differs));
    CHECK_FALSE(equivalence(std::vector{0.7}, 0.5));
}

TEST_CASE("a difference as large as the bound is called the same in 5 % of samples") {
    Random random(7);
    constexpr int kSamples = 4000;
    const double bound = random.coin() ? 1.0 : -1.0;
    int same = 0;
    for (int i = 0; i < kSamples; ++i) {
        std::vector<double> people(12);
        for (double& one : people) {  // sums of 12 even numbers are near enough to normal
            one = bound;
            for (int k = 0; k < 12; ++k) {
                one += 0.5 * (random.in(0.0, 1.0) - 0.5);
            }
        }
        same += equivalence(people, 1.0)->bounded() ? 1 : 0;
    }
    const double share = static_cast<double>(same) / kSamples;
    CHECK(share > 0.05 - 0.014);  // 4 standard errors
    CHECK(share < 0.05 + 0.014);
}

TEST_CASE("an audit of simulated people finds the rig the same, and a start pose that was not") {
    const RunFile file(kFourTrials, {"P1", "P2", "P3"});
    const auto audit = [&] {
        return palpate_command({"audit", file, "--kind", "simulated"});
    };
    const Finished first = ended(audit());
    CHECK_THAT(first.out, Has("on - off"));
    for (const char* of : {"start, to the right", "start, away", "late ticks", "saturated ticks",
                           "stale ticks", "trials with a gap"}) {
        CHECK_THAT(behind(first.out, of), Has("the same"));
    }
    sql_edit(file, "UPDATE presentation SET start_x_m = start_x_m + 0.004 WHERE friction = 'on'");
    const std::string moved = behind(audit().out, "start, to the right");
    CAPTURE(moved);
    CHECK_THAT(moved, Has("DIFFERS", " 0.0040 "));

    // Who has no answer with a friction is in no difference with it, and is named.
    CHECK_THAT(first.out, !Has("no answer with"));
    sql_edit(file,
             "UPDATE trial SET invalid_reason = 'bell' WHERE trial_id IN (SELECT trial_id FROM "
             "analysis_trial WHERE participant_code = 'P2' AND friction = 'on')");
    const std::string second = sql_row(
        file,
        "SELECT printf('sub-%010d', subject) AS s FROM participant WHERE participant_code = 'P2'");
    CHECK_THAT(audit().out,
               Has("no answer with friction on, so no difference with it: " + second + "\n"));
    CHECK_THAT(behind(audit().out, "late ticks"), Has("  2  "));
    CHECK_THAT(page_of(file, {"--kind", "simulated"}),
               Has("There is no answer with friction on, so no "
                   "difference with it: " +
                   second + "."));
    const auto made = json_of({"audit", file, "--kind", "simulated"});
    CHECK(made.at("no_answer_with").dump() ==
          R"([{"friction":"on","people":[")" + second + R"("]}])");

    CHECK_THAT(ran({"audit", file}, 2).error, Has("nothing in answered trials of real sessions:",
                                                  "--kind chooses other sessions"));
    CHECK_THAT(ran({"audit", file, "--study", "four_trials"}, 2).error,
               Has("nothing in answered trials of real sessions of the study four_trials: "));
}

TEST_CASE("no number is made of the answers of who does not consent") {
    const TemporaryFolder folder;
    const std::string with = run_by({"A", "B", "C"}, kFourTrials, folder.file("a.sqlite"));
    const std::string without = run_by({"A", "B"}, kFourTrials, folder.file("b.sqlite"));
    const auto said = [](const std::string& command, const std::string& file) {
        CAPTURE(command);
        const Finished done = ran({command, file, "--kind", "simulated"});
        return done.out.substr(done.out.find("comparison"));
    };
    CHECK(said("audit", with) != said("audit", without));
    ran({"participant", with, "C", "--consent", "no"});
    CHECK(said("audit", with) == said("audit", without));
    CHECK_THAT(palpate_command({"stats", with, "--kind", "simulated"}).out,
               Has("All answers: 2 people, 8 answers"));
    CHECK_THAT(page_of(with, {"--kind", "simulated"}),
               Has("left out: 1 does not consent", "2 people"));
}
