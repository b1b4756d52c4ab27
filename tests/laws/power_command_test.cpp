#include "tests/support/json_of.hpp"

namespace {

/// Four trials, ten times, with a primary test of its own.
std::string study_in(const TemporaryFolder& folder, const std::string& test) {
    std::string text = replaced(slurp(kFourTrials), "repetitions = 1", "repetitions = 4");
    write(folder.file("study.toml"), text + "\n[analysis]\nprimary = \"" + test + "\"\n");
    write(folder.file("quick.toml"),
          "format = 1\n[observer]\nnoise_per_m = 8\n[hand]\nspeed_factor = 2.5\n");
    return folder.file("study.toml");
}

}  // namespace

TEST_CASE(
    "palpate power counts the protocol's own primary test, the same by any number of threads") {
    const TemporaryFolder folder;
    const std::string study = study_in(folder, "sign_flip");
    const auto power = [&](const std::string& threads) {
        return palpate_command({"power", study, "--effect", "-2", "--observer",
                                folder.file("quick.toml"), "--participants", "6,10", "--studies",
                                "200", "--hands", "2", "--threads", threads, "--svg",
                                folder.file("power.svg")});
    };
    const Finished one = ended(power("1"));
    CHECK_THAT(one.out,
               Has("on against off, 8 trials", "exact sign-flip test", "2000 without an effect",
                   "judged from 32 trials that the hands of 2 people felt", "Power of 0.8 takes",
                   "For the pre-registration:", "-2 logit (sd 0.3 over people) with a power of"));
    CHECK_THAT(slurp(folder.file("power.svg")), Has("type I error"));
    CHECK(power("3").out == one.out);
    const Json all =
        json_of({"power", study, "--effect", "-2", "--observer", folder.file("quick.toml"),
                 "--participants", "6,10", "--studies", "200", "--hands", "2"});
    REQUIRE(all["points"].size() == 2);
    for (const auto& point : all["points"]) {
        CHECK_THAT(
            one.out,
            Has(fmt::format("  {:>6}  {:.3f}  {:.3f} to {:.3f}  ", point["participants"].get<int>(),
                            point["power"].get<double>(), point["power_95"][0].get<double>(),
                            point["power_95"][1].get<double>())));
    }
    CHECK(all["test"] == "sign_flip");
    CHECK_THAT(
        ran({"power", study, "--effect", "observer", "--observer", folder.file("quick.toml"),
             "--participants", "6", "--studies", "20", "--hands", "1", "--test", "signed_rank"})
            .out,
        Has("Wilcoxon signed-rank"));
}

TEST_CASE("two people are enough where their power is") {
    const TemporaryFolder folder;
    write(folder.file("p.toml"),
          edited(slurp(kFourTrials), {{"repetitions = 1", "repetitions = 60"}, {"= 2.62", "= 2"}}));
    write(folder.file("sure.toml"),
          "format = 1\n[observer]\nnoise_per_m = 2\n[hand]\nspeed_factor = 2.5\n");
    const Finished power =
        ran({"power", folder.file("p.toml"), "--observer", folder.file("sure.toml"), "--effect",
             "-9", "--effect-sd", "0", "--participants", "2,3", "--studies", "60", "--null-studies",
             "20", "--hands", "1"});
    CHECK_THAT(power.out, Has("       2  0.8", "Power of 0.8 takes 2 people"));
}

TEST_CASE("palpate power says where there is no effect, and never an error of 0") {
    const TemporaryFolder folder;
    const std::string study = study_in(folder, "paired_t");
    CHECK_THAT(ran({"power", study, "--effect", "0", "--observer", folder.file("quick.toml"),
                    "--participants", "3,4", "--studies", "20", "--hands", "1"})
                   .out,
               Has("There is no effect to be found (0 logit", "type I error.") && !Has("takes") &&
                   !Has("times as large") && !Has("For the pre-registration"));
    // Four people, the least p of signed ranks is 1/8: never significant. Wilson: 1.96^2 / (n +
    // 1.96^2).
    const auto never =
        ran({"power", study, "--effect", "-2", "--test", "signed_rank", "--observer",
             folder.file("quick.toml"), "--participants", "4", "--studies", "20", "--hands", "1"});
    CHECK_THAT(never.out, Has("0.000 to 0.161", "0.0000 to 0.0188"));
}

TEST_CASE("palpate stats names the protocol's primary test first") {
    const TemporaryFolder folder;
    const std::string study = study_in(folder, "sign_flip");
    const std::string file = folder.file("d.sqlite");
    ran({"simulate", study, "--participants", "3", "--observer", folder.file("quick.toml"),
         "--no-traces", "--db", file});
    const Words stats{"stats", file, "--kind", "simulated", "--simulations", "0"};
    CHECK_THAT(behind(ran(stats).out, "Primary test, as the protocol says: exact sign-flip test",
                      "Person by person"),
               Has("on - off "));
    CHECK(json_of(stats)["primary_test"] == "sign_flip");
}
