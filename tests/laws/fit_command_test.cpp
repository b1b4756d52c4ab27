#include "tests/support/adaptive.hpp"
#include "tests/support/json_of.hpp"

namespace {

const std::string kTwoConditions = test_text("two_conditions.csv");

std::vector<double> numbers_of(const std::string& text) {
    std::istringstream stream(text);
    std::vector<double> all;
    for (double one = 0.0; stream >> one;) {
        all.push_back(one);
    }
    return all;
}

/// Answers to five items, -10 to 10, a digit each, by friction: the text of their trials.
/// @param unit  all items and answers times this
std::string identifications(
    const std::vector<std::pair<const char*, std::array<const char*, 5>>>& all, int unit = 1) {
    std::string text = "subject,trial,shape,friction,response\n";
    int trial = 0;
    for (const auto& [friction, answers] : all) {
        for (int item = 0; item < 5; ++item) {
            for (const char answer : std::string_view(answers.at(static_cast<std::size_t>(item)))) {
                text += fmt::format("A,{},{},{},{}\n", trial++, unit * (5 * item - 10), friction,
                                    unit * 5 * (answer - '2'));
            }
        }
    }
    return text;
}

void not_fitted(const Words& words, const std::string& why) {
    refused(joined({"fit"}, words), why);
}

}  // namespace

TEST_CASE("palpate fit says of thresholds, slopes, intervals and deviances what R's glm says") {
    if (!has_r()) {
        return;
    }
    // glm's fit of each link, the profile of the threshold by a glm through it, and the test of
    // equal slopes.
    const std::string table = PALPATE_SOURCE_DIR "/tests/texts/two_conditions.csv";
    const Finished r = ended(Process({"Rscript", script("glm_fit.R"), table}).wait());
    const std::vector<double> wanted = numbers_of(r.out);
    REQUIRE(wanted.size() == 3 * 17);
    std::size_t at = 0;
    for (const char* function : {"normal", "logistic", "gumbel"}) {
        CAPTURE(function);
        const Json all =
            fitted({table, "--function", function, "--lapse", "0", "--bootstrap", "0"});
        for (const Json& curve : all["curves"]) {
            const Json& threshold = curve["threshold"];
            for (const Json& got :
                 {threshold["estimate"], curve["slope"]["estimate"], curve["jnd"]["estimate"],
                  threshold["se"], curve["slope"]["se"], curve["deviance"],
                  threshold["profile_95"][0], threshold["profile_95"][1]}) {
                CAPTURE(at);
                CHECK(got.get<double>() == Approx(wanted[at++]).epsilon(2e-7));
            }
            CHECK(curve["optimisers_agree"].get<bool>());
        }
        CHECK(all["differences"][1]["p"].get<double>() == Approx(wanted[at++]).epsilon(1e-6));
    }
}

// Values: psignifit 3 (github.com/mih/Psignifit-3.x, tests/interface_test.py,
// TestMapestimate.test_old_doctest), two alternatives, logistic of (x - a) / b, lapses flat in 0 to
// 0.1. Its search stops where the deviance is 2e-8 above the least.
TEST_CASE("palpate fit says of psignifit's example what psignifit says") {
    const TemporaryFile file("d.csv");
    write(file, "stimulus,n,k\n0,50,34\n2,50,32\n4,50,40\n6,50,48\n8,50,50\n10,50,48\n");
    const Json all = fitted(
        {file, "--function", "logistic", "--guess", "0.5", "--lapse", "free", "--bootstrap", "0"});
    const Json& curve = all["curves"][0];
    CHECK(curve["threshold"]["estimate"].get<double>() == Approx(2.7518062397).epsilon(3e-6));
    CHECK(1.0 / curve["slope"]["estimate"].get<double>() == Approx(1.4571774452).epsilon(5e-5));
    CHECK(curve["lapse"]["estimate"].get<double>() == Approx(0.0155565836).epsilon(2e-4));
    CHECK(curve["deviance"].get<double>() == Approx(8.07133136423).epsilon(3e-9));
    CHECK(curve["deviance"].get<double>() <= 8.07133136423);
}

TEST_CASE("the p beside a weibull's JND is of equal JNDs, not of equal slopes") {
    // The same answers to stimuli 1.3 times as large: slopes are equal, JNDs are not. R 4.2.2,
    // optim of both curves and of both with one JND.
    std::string text = "condition,stimulus,n,k\n";
    for (const auto& [stimulus, k] : std::vector<std::pair<double, int>>{
             {0.5, 3}, {0.7, 8}, {0.9, 16}, {1.1, 24}, {1.4, 33}, {1.8, 38}}) {
        text += fmt::format("a,{},40,{}\nb,{},40,{}\n", stimulus, k, 1.3 * stimulus, k);
    }
    const TemporaryFile file("d.csv");
    write(file, text);
    for (const auto& [lapse, p] : {std::pair{"0.02", 0.135533}, std::pair{"shared", 0.161506}}) {
        const Json all =
            fitted({file, "--function", "weibull", "--lapse", lapse, "--bootstrap", "0"});
        CHECK(all["differences"][1]["quantity"] == "jnd");
        CHECK(all["differences"][1]["p"].get<double>() == Approx(p).epsilon(1e-4));
    }
}

TEST_CASE("palpate fit prints what its JSON holds, the same every time, and draws it") {
    const TemporaryFolder folder;
    write(folder.file("d.csv"), kTwoConditions);
    const Words words{"fit",         folder.file("d.csv"),
                      "--function",  "weibull",
                      "--guess",     "0.02",
                      "--bootstrap", "200",
                      "--svg",       folder.file("d.svg"),
                      "--at",        "3/4"};
    const Finished text = ran(words);
    CHECK(palpate_command(words).out == text.out);
    const Json all = fitted({words.begin() + 1, words.end()});
    CHECK(all["curves"].size() == 2);
    for (const Json& curve : all["curves"]) {
        CHECK_THAT(text.out, Has("P1, " + curve["condition"].get<std::string>() +
                                 ": 7 levels, 280 answers; deviance "));
        for (const char* quantity :
             {"threshold", "stimulus_at", "jnd", "weber_fraction", "slope"}) {
            const Json& estimate = curve[quantity];
            for (const Json& one :
                 {estimate["estimate"], estimate["profile_95"][0], estimate["profile_95"][1],
                  estimate["bootstrap_95"][0], estimate["bootstrap_95"][1]}) {
                CAPTURE(quantity);
                CHECK_THAT(text.out, Has(fmt::format("{:.4g}", one.get<double>())));
            }
            CHECK(estimate["profile_95"][0] < estimate["estimate"]);
            CHECK(estimate["estimate"] < estimate["profile_95"][1]);
        }
        CHECK(curve["weber_fraction"]["estimate"].get<double>() ==
              Approx(curve["jnd"]["estimate"].get<double>() /
                     curve["threshold"]["estimate"].get<double>()));
    }
    const double difference = all["curves"][1]["threshold"]["estimate"].get<double>() -
                              all["curves"][0]["threshold"]["estimate"].get<double>();
    CHECK(all["differences"][0]["difference"].get<double>() == Approx(difference));
    CHECK(difference > 0.0);
    CHECK(all["differences"][0]["p"].get<double>() < 0.05);
    CHECK_THAT(text.out, Has("on - off    threshold", "agree on 2 of 2 curves"));
    CHECK_THAT(slurp(folder.file("d.svg")), Has("<svg", "P1"));
    CHECK(palpate_command({"fit", folder.file("d.csv"), "--bootstrap", "200", "--seed", "2"}).out !=
          palpate_command({"fit", folder.file("d.csv"), "--bootstrap", "200"}).out);
}

TEST_CASE("palpate fit shows its priors, and what the answers do not bound") {
    const TemporaryFolder folder;
    write(folder.file("steep.csv"), "stimulus,n,k\n1,10,0\n2,10,0\n3,10,10\n");
    const Finished steep = ran({"fit", folder.file("steep.csv"), "--lapse", "0"});
    CHECK_THAT(steep.out, Has("slope b", "unbounded: ", "at most one level lies on the rise",
                              "maximum likelihood, no priors"));
    const Finished bounded =
        palpate_command({"fit", folder.file("steep.csv"), "--lapse", "free", "--prior",
                         "lapse=2,50", "--prior", "slope=2,0.7", "--bootstrap", "50"});
    CHECK_THAT(bounded.out, Has("MAP with priors slope b ~ lognormal: median, sd of "
                                "ln (2, 0.7), lapse ~ beta(2, 50)") &&
                                !Has("unbounded"));
    CHECK_THAT(
        ran({"fit", write(folder.file("falls.csv"), "stimulus,n,k\n1,10,9\n2,10,5\n3,10,1\n")}).out,
        Has("the share of 1 does not grow with the stimulus", "unbounded: "));
}

TEST_CASE("palpate fit refuses what it cannot take, at its place, with value and remedy") {
    const TemporaryFolder folder;
    const std::string csv = folder.file("d.csv");
    for (const auto& row : test_rows("fit_refusals.tsv")) {  // the table, words, and what is said
        CAPTURE(row);
        write(csv, row.at(0));
        not_fitted(words_of(csv, row.at(1)), row.at(2));
    }
    not_fitted({folder.file("none.csv")}, "none.csv");
}

TEST_CASE("a table is fitted, and tested, from a pipe too") {
    const auto piped = [](const std::string& table, const std::string& words) {
        return Json::parse(
            ended(shell("printf '" + table + "' | \"$0\" " + words + " --json")).out);
    };
    CHECK(piped("stimulus,n,k\\n1,10,2\\n2,10,8\\n",
                "fit /dev/stdin --bootstrap 0")["curves"][0]["answers"] == 20);
    CHECK(piped("stimulus,n,k\\n1,10,2\\n2,10,8\\n", "fit /dev/stdin --bootstrap 0")["source"] ==
          "/dev/stdin");
    CHECK(piped("subject,trial,shape,friction,response\\nA,1,a,on,a\\n",
                "stats /dev/stdin --simulations 0")["applied"]["answers"] == 1);
}

TEST_CASE("palpate fit of a database fits the same answers as that of their counts") {
    const TemporaryFolder folder;
    write(folder.file("p.toml"), adaptive_text(kQuestPlusRule));
    const std::string file = run_by({"P1", "P2"}, folder.file("p.toml"), folder.file("a.sqlite"));
    not_fitted({file}, "has no answer to fit in real sessions: --kind chooses others");
    const std::string counts = sql_csv(
        file,
        "SELECT participant_code AS participant, run_name AS condition, stimulus, count(*) AS n, "
        "sum(comparison_chosen) AS k FROM analysis_trial WHERE counts AND phase = 'main' GROUP BY "
        "1, 2, 3");
    write(folder.file("d.csv"), counts);
    const Words how{"--prior", "slope=0.5,1", "--bootstrap", "40"};
    const Words of_file = joined({file, "--kind", "simulated", "--keep-codes"}, how);
    Json ours = fitted(of_file);
    // A table knows no order of runs.
    const Json theirs =
        fitted(joined({folder.file("d.csv"), "--guess", "lapse", "--baseline", "equal"}, how));
    REQUIRE(ours["curves"].size() == 4);
    for (Json& curve : ours["curves"]) {
        // Of the rule: threshold, sd, lapse, and the JND.
        CHECK(curve["posterior"].size() == 4);
        CHECK(curve["posterior"][0]["low_95"] <= curve["posterior"][0]["mean"]);
        curve.erase("posterior");
    }
    CHECK(ours["curves"] == theirs["curves"]);
    CHECK(ours["differences"] == theirs["differences"]);
    CHECK(ours["people"] == theirs["people"]);

    ran({"participant", file, "P2", "--consent", "no"});
    const Json of_one = fitted(of_file);
    REQUIRE(of_one["curves"].size() == 2);
    for (const Json& curve : of_one["curves"]) {
        CHECK(curve["participant"] == "P1");
    }
}

TEST_CASE("who is excluded is not said to have answered badly, and what counts is False, 0 or NA") {
    const TemporaryFile file("d.csv");
    const auto table = [&](const char* counts) {
        std::string text = "subject,trial,shape,friction,response,excluded\n";
        for (int i = 0; i < 8; ++i) {
            const int shape = i % 2 * 5;
            const char* const friction = i < 4 ? "off" : "on";
            text += fmt::format("A,{0},{1},{2},{3},{4}\nB,{0},{1},{2},{1},tired\n", i, shape,
                                friction, i % 3 == 2 ? 5 - shape : shape, counts);
        }
        write(file, text);
        return fitted({file});
    };
    const Json of = table("");
    CHECK(of["not_fitted"] == Json({"B: no answer counts"}));
    REQUIRE(of["people"].size() == 1);
    const Json& one = of["people"][0];
    CHECK(one["optimisers_agree"].get<bool>() ==
          (std::fabs(one["log_likelihood_climbed"].get<double>() -
                     one["log_likelihood_nelder_mead"].get<double>()) < 1e-6));
    for (const char* counts : {"0", "False", "NA"}) {
        CHECK(table(counts)["people"] == of["people"]);
    }
    ran({"stats", file, "--json", "--simulations", "0"});
}

TEST_CASE(
    "palpate fit of identifications parts how well from how named, of a database as of its "
    "trials") {
    const TemporaryFolder folder;
    const std::string file = run_by({"P1", "P2"}, "shape_friction_demo", folder.file("a.sqlite"));
    const Json ours = fitted({file, "--kind", "simulated", "--keep-codes"});
    REQUIRE(ours["people"].size() == 2);
    REQUIRE(ours["items"].size() == 5);
    CHECK(ours["values"] == Json({-10.0, -5.0, 0.0, 5.0, 10.0}));
    // The same trials as a CSV, the counts by SQL: nothing of ours in between.
    const std::string trials = sql_csv(
        file,
        "SELECT participant_code AS subject, row_number() OVER () AS trial, planned_object AS "
        "shape, friction, chosen_object AS response FROM analysis_trial WHERE counts AND phase = "
        "'main'");
    write(folder.file("t.csv"), trials);
    Words words{folder.file("t.csv")};
    for (std::size_t i = 0; i < 5; ++i) {
        words.emplace_back("--item");
        words.push_back(fmt::format("{}={}", ours["items"][i].get<std::string>(),
                                    ours["values"][i].get<double>()));
    }
    const Json theirs = fitted(words);
    for (std::size_t i = 0; i < 2; ++i) {
        CHECK(ours["people"][i]["conditions"] == theirs["people"][i]["conditions"]);
        CHECK(ours["people"][i]["criteria"] == theirs["people"][i]["criteria"]);
        CHECK(ours["people"][i]["optimisers_agree"] == theirs["people"][i]["optimisers_agree"]);
        CHECK(ours["people"][i]["log_likelihood_nelder_mead"].get<double>() ==
              Approx(ours["people"][i]["log_likelihood"].get<double>()).epsilon(1e-9));
        CHECK(ours["people"][i]["participant"] == theirs["people"][i]["participant"]);
    }
    CHECK_THAT(ran({"fit", file, "--kind", "simulated"}).out, !Has("P1"));
    not_fitted({file, "--kind", "simulated", "--guess", "0.2"},
               "holds identifications: --function, --guess");
    not_fitted({file, "--kind", "simulated", "--function", "weibull"}, "holds identifications");
    not_fitted({folder.file("t.csv")}, "has no value to be ordered by: give --item");
    not_fitted({folder.file("t.csv"), "--item", "flat"}, "--item is \"flat\": give NAME=VALUE");
    const std::string first = ours["items"][0];
    not_fitted({file, "--kind", "simulated", "--item", "nosuch=1"},
               "there is no item \"nosuch\": its items are");
    not_fitted({file, "--kind", "simulated", "--item", first + "=1", "--item", first + "=2"},
               "--item " + first + " is there twice");
    ran({"fit", file, "--kind", "simulated", "--item", first + "=-12"});
}

TEST_CASE("palpate fit of identifications says the same in any unit of the items") {
    // Somebody of a simulated study, whose likelihood has hills: of sigmas 0.907 and 0.05 a simplex
    // from 12 starts found it 1.13 below the maximum, so that a first sigma of 0 is not refuted.
    const TemporaryFile file("d.csv");
    const auto in_unit = [&](int unit) {
        write(file,
              identifications(
                  {{"off", {"0000000001", "0111111111", "1112222222", "2222333333", "3444444444"}},
                   {"on", {"0000000000", "0000111111", "1222222222", "2222333333", "3333344444"}}},
                  unit));
        return fitted({file})["people"][0]["conditions"];
    };
    const Json metres = in_unit(1);
    const Json millimetres = in_unit(1000);
    for (const std::size_t f : {0U, 1U}) {
        CHECK(millimetres[f]["sigma_95"][0] == 0.0);
        CHECK(millimetres[f]["sigma_95"][1].get<double>() ==
              Approx(1000.0 * metres[f]["sigma_95"][1].get<double>()));
    }
    CHECK(millimetres[1]["ratio_95"] == Json({0.0, nullptr}));
    CHECK(millimetres[1]["ratio_p"].get<double>() == Approx(metres[1]["ratio_p"].get<double>()));
    not_fitted({file, "--item=-10000=-1e308", "--item=10000=1e308"}, "values that differ less");
}

TEST_CASE("the changes of a person are those of the sigmas beside them, however many conditions") {
    // Of "mid" R's profile (optim, 12 starts) loses 1.12 of log-likelihood at a ratio of 0.001 and
    // 1.13 at a sigma of 0.02, less than 1.92: neither refutes 0.
    const auto fit_of = [](std::size_t frictions) {
        std::vector<std::pair<const char*, std::array<const char*, 5>>> all{
            {"off", {"011", "1124", "1222", "2233", "4444"}},
            {"mid", {"0001", "1112", "1122", "2333", "3334"}},
            {"on", {"0012", "0113", "1223", "2344", "2344"}}};
        all.resize(frictions);
        const TemporaryFile file("d.csv");
        write(file, identifications(all));
        return fitted({file, "--baseline", "off"})["people"][0]["conditions"];
    };
    const Json two = fit_of(2);
    CHECK(two[1]["sigma_95"][0] == 0.0);
    CHECK(two[1]["ratio_95"][0] == 0.0);
    const Json three = fit_of(3);
    const double off = three[0]["sigma"];
    for (const std::size_t f : {1U, 2U}) {
        CHECK(three[f]["ratio"].get<double>() ==
              Approx(three[f]["sigma"].get<double>() / off).epsilon(1e-3));
        const Json& ends = three[f]["ratio_95"];
        const bool outside =
            ends[0].get<double>() > 1.0 || (ends[1].is_number() && ends[1].get<double>() < 1.0);
        CHECK((three[f]["ratio_p"].get<double>() < 0.05) == outside);
    }
}

TEST_CASE("biases of items that no confusion links have no ratio, and are said to have none") {
    const TemporaryFolder folder;
    std::string rows = "subject,trial,shape,friction,response\n";
    int trial = 0;
    for (const char* answer : {"0,off,0", "0,off,1", "1,off,0", "1,off,1", "2,off,2", "0,on,0",
                               "0,on,1", "1,on,1", "1,on,2", "2,on,2", "1,on,0", "2,on,1"}) {
        rows += fmt::format("A,{},{}\n", ++trial, answer);
    }
    write(folder.file("d.csv"), rows);
    const Json conditions = fitted({folder.file("d.csv")})["people"][0]["conditions"];
    CHECK(conditions[0]["bias_groups"].dump() == R"([["0","1"],["2"]])");
    CHECK(conditions[1]["bias_groups"].dump() == R"([["0","1","2"]])");
    CHECK_THAT(ran({"fit", folder.file("d.csv")}).out,
               Has("off, biases have a ratio within each of these alone, which no confusion links: "
                   "0, 1 | 2\n") &&
                   !Has("on, biases have a ratio"));
}
