#include "tests/protocols/published_traces.hpp"
#include "tests/support/program.hpp"
#include "tests/support/sql_first.hpp"

namespace {

const std::string kWatson = test_text("procedures/watson.toml");

}  // namespace

TEST_CASE("palpate procedure replays Watson's run of threshold, slope and lapse") {
    const TemporaryFolder folder;
    write(folder.file("c.toml"), kWatson);
    // The published stimuli are given, since two of them tie with others.
    const PublishedRun published = published_run("lapse");
    std::string responses = "stimulus,response\n";
    for (std::size_t i = 0; i < published.stimuli.size(); ++i) {
        responses += fmt::format("{},{}\n", published.stimuli[i][0], published.answers[i]);
    }
    write(folder.file("r.csv"), responses);
    ran({"procedure", folder.file("c.toml"), folder.file("r.csv"), "-o", folder.file("o.csv")});
    const auto table = csv_rows(slurp(folder.file("o.csv")));
    REQUIRE(table.size() == 129);
    CHECK(table[0] == Words{"trial", "stimulus", "response", "estimate_mean_threshold",
                            "estimate_mode_threshold", "estimate_mean_slope", "estimate_mode_slope",
                            "estimate_mean_lapse", "estimate_mode_lapse", "entropy_bits",
                            "next_stimulus"});
    int other = 0;
    for (std::size_t i = 1; i < 128; ++i) {
        CHECK(table[i][0] == std::to_string(i));
        CHECK(table[i][1] == fmt::format("{}", published.stimuli[i - 1][0]));
        other += table[i][10] == fmt::format("{}", published.stimuli[i][0]) ? 0 : 1;
    }
    CHECK(other == 2);
    CHECK(table[128][4] == "-20");
    CHECK(table[128][6] == "5");
    CHECK(table[128][8] == "0.04");
    CHECK(table[128][10].empty());  // it has ended
}

TEST_CASE(
    "without a stimulus column the recommended stimuli are taken, and written to standard output") {
    const TemporaryFolder folder;
    std::string config(kWatson);
    config.replace(config.find("[2, 3, 4, 5]"), 12, "3.5");
    const std::size_t lapse = config.find("lapse = [");
    config.replace(lapse, config.size() - lapse, "lapse = 0.02\n");
    write(folder.file("c.toml"), config);
    const PublishedRun published = published_run("threshold");
    std::string responses = "response\n";
    for (const char answer : published.answers) {
        responses += std::string(1, answer) + "\n";
    }
    write(folder.file("r.csv"), responses);
    const Finished run = ran({"procedure", folder.file("c.toml"), folder.file("r.csv")});
    const auto table = csv_rows(run.out);
    CHECK(fmt::format("{}", fmt::join(table[0], ",")) ==
          "trial,stimulus,response,estimate_mean,estimate_mode,entropy_bits,next_stimulus");
    for (std::size_t i = 0; i < published.stimuli.size(); ++i) {
        CAPTURE(i);
        CHECK(table.at(i + 1)[1] == fmt::format("{}", published.stimuli[i][0]));
    }
    CHECK(table[32][4] == "-20");
    // What it said is next is what it then took.
    for (std::size_t i = 1; i < 32; ++i) {
        CHECK(table[i][6] == table[i + 1][1]);
    }
    const Finished again =
        palpate_command({"procedure", folder.file("c.toml"), folder.file("r.csv"), "--hashes"});
    const auto hashes = csv_rows(again.out);
    CHECK(hashes[0].back() == "state_sha256");
    CHECK(hashes[1].back().size() == 64);
    CHECK(hashes[1].back() != hashes[2].back());
}

TEST_CASE("palpate procedure refuses bad words and files with place and remedy") {
    const TemporaryFolder folder;
    const std::string config = folder.file("c.toml");
    const std::string responses = folder.file("r.csv");
    write(config, kWatson);
    for (const auto& row : test_rows("procedure_refusals.tsv")) {  // the table, and what is said
        write(responses, row.at(0));
        CAPTURE(row);
        refused({"procedure", config, responses, "-o", folder.file("o.csv")}, row.at(1));
        CHECK(folder.names() == Words{"c.toml", "r.csv"});
    }

    ran({"procedure", folder.file("no.toml"), responses}, 2);
    CHECK_THAT(palpate_command({"procedure", config, folder.file("no.csv")}).error,
               Has("cannot be read"));
    write(config, "format = 1\n[procedure]\nkind = \"best\"\n");
    CHECK_THAT(ran({"procedure", config, responses}, 2).error, Has("c.toml:3:8: kind is \"best\""));
    CHECK_THAT(ran({"procedure", "--keys"}).out, Has("[quest]"));
}

TEST_CASE("a marked answer of one staircase moves none of another's, in summary and in exports") {
    const TemporaryFolder folder;
    const std::string file = folder.file("r.sqlite");
    ran({"simulate", "friction_threshold", "--participants", "1", "--no-traces", "--db", file});
    const auto mean_of = [&](const std::string& staircase) {
        const std::string mean = behind(behind(ran({"summary", file, "--json"}).out,
                                               "\"estimate\": \"" + staircase + "\"", "}"),
                                        "\"mean\": ");
        REQUIRE_FALSE(mean.empty());
        return mean;
    };
    const std::string near = mean_of("from_near");
    const std::string far = mean_of("from_far");
    const std::string marked =
        sql_first(file,
                  "SELECT max(trial_id) FROM analysis_trial WHERE staircase = 'from_far' AND "
                  "run_trial_number < 60");
    ran({"mark", file, marked, "--invalid", "coughed"});
    CHECK(mean_of("from_near") == near);
    CHECK(mean_of("from_far") != far);

    ran({"export", file, "--format", "procedure", "--kind", "simulated", "-o", folder.file("e")});
    int replays = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.file("e"))) {
        if (entry.path().filename() != "RESPONSES.csv") {
            continue;
        }
        const std::string config = (entry.path().parent_path() / "CONFIG.toml").string();
        const auto rows = csv_rows(ran({"procedure", config, entry.path().string()}).out);
        const auto column = std::ranges::find(rows.at(0), "estimate_mean_from_near");
        const std::string last = rows.back().at(static_cast<std::size_t>(column - rows[0].begin()));
        CHECK_THAT(near, Has(last.substr(0, 6)));
        ++replays;
    }
    CHECK(replays == 1);
}
