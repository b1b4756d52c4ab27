#include "tests/support/json_of.hpp"

namespace {

/// Made-up people of any lab: three shapes, two frictions, a break every 15 trials; one person is
/// left out, and some trials are. Friction makes everybody worse, more or less.
std::string made_up(std::size_t people, int trials, bool excluded) {
    const Words shapes{"concave", "straight", "convex"};
    std::mt19937_64 random(17);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform;
    std::string text =
        "subject,trial,shape,friction,response,rt_s,confidence,explore_s,since_break,excluded\n";
    for (std::size_t person = 0; person < people; ++person) {
        const double logit = 0.8 + 0.6 * normal(random);
        const double effect = -0.8 + 0.7 * normal(random);
        for (int i = 0; i < trials; ++i) {
            const bool on = i % 2 == 1;
            const std::size_t felt = (static_cast<std::size_t>(i) / 2) % 3;
            const bool right =
                uniform(random) < 1.0 / (1.0 + std::exp(-(logit + (on ? effect : 0.0) + 0.01 * i)));
            const std::size_t named = right ? felt : (felt + 1 + random() % 2) % 3;
            const int sure = 1 + static_cast<int>(random() % 3) + (right ? 1 : 0);
            const std::string why = !excluded                  ? ""
                                  : person == 1                ? "catch trials"
                                  : person == 2 && i % 20 == 7 ? "marked"
                                                               : "";
            text += fmt::format(
                "P{:02},{},{},{},{},{:.4f},{},{},{},{}\n", person, i + 1, shapes[felt],
                on ? "on" : "off", shapes[named],
                std::exp(0.3 + 0.3 * normal(random) - 0.002 * i + (on ? 0.1 : 0.0)), sure,
                person == 3 && i % 9 == 0 ? "" : fmt::format("{:.3f}", 8.0 + 2.0 * uniform(random)),
                i % 15, why);
        }
    }
    return text;
}

/// Whether a surface is curved, said by three people.
std::string yes_and_no() {
    std::string text = "subject,trial,shape,friction,response,confidence\n";
    std::mt19937 random(5);
    for (const char* person : {"A", "B", "C"}) {
        for (int i = 0; i < 40; ++i) {
            const bool curved = i % 4 < 2;
            const bool yes = random() % 10 < (curved ? 7U : 3U);
            text += fmt::format("{},{},{},{},{},{:.2f}\n", person, i, curved ? "curved" : "flat",
                                i % 2 == 0 ? "dry" : "oiled", yes ? "yes" : "no",
                                0.5 + 0.01 * static_cast<double>(random() % 50));
        }
    }
    return text;
}

/// Three people who are always right, and slower with friction, nearly alike.
std::string all_right() {
    std::string text = "subject,trial,shape,friction,response,rt_s\n";
    for (int i = 0; i < 24; ++i) {
        const char* shape = i % 2 == 0 ? "flat" : "round";
        const bool on = i / 2 % 2 == 1;
        text += fmt::format("S{0},{1},{2},{3},{2},{4}\n", i / 8, i, shape, on ? "on" : "off",
                            on ? 2.0 + 1e-3 * (i / 8) : 1.0);
    }
    return text;
}

Finished stats(const Words& words) {
    return palpate_command(joined({"stats"}, words));
}

Json numbers_of(const Words& words) {
    return json_of(joined({"stats"}, words));
}

void no_stats(const Words& words, const std::string& why) {
    refused(joined({"stats"}, words), why);
}

/// A name of a person holds what parts the script's numbers.
std::map<std::string, int> compare(const std::string& printed, const Json& ours) {
    return compare_with_r(printed, ours, {{"P\\t04\\n", "P\t04\n"}});
}

}  // namespace

TEST_CASE("palpate stats says what its own scripts of R say, exclusions applied and not") {
    const Finished known =
        Process({"Rscript", "-e", "cat(nzchar(system.file(package = 'lme4')))"}).wait();
    if (known.code != 0) {
        WARN("R is not installed: skipped");
        return;
    }
    const TemporaryFolder folder;
    std::string text = made_up(6, 40, true);
    // A name may hold what parts the script's numbers.
    text = all_replaced(text, "P04,", "\"P\t04\n\",");
    write(folder.file("d.csv"), text);
    write(folder.file("yes.csv"), yes_and_no());
    write(folder.file("right.csv"), all_right());
    const Words how{"--simulations", "0", "--permutations", "0"};
    const auto with = [&](const Words& words) {
        return numbers_of(joined(words, how));
    };
    const Json ours = with({folder.file("d.csv"), "--emit-r", folder.file("again.R")});
    const Json yes = with({folder.file("yes.csv"), "--signal", "curved", "--baseline", "oiled",
                           "--emit-r", folder.file("again_yes.R")});
    const Json right = with({folder.file("right.csv"), "--emit-r", folder.file("again_right.R")});
    // One R for all: to load lme4 takes longer than all else.
    ended(shell(
        "Rscript -e \"for (s in c('again', 'again_yes', 'again_right')) { sink(paste0(s, '.out')); "
        "source(paste0(s, '.R')); sink() }\"",
        folder.path()));
    auto kinds = compare(slurp(folder.file("again.out")), ours);
    CHECK(kinds["of base R"] > 500);
    CHECK(kinds["of the grid"] == 14);
    CHECK(kinds["bayes_factor_10"] >= 20);
    auto of_yes = compare(slurp(folder.file("again_yes.out")), yes);
    CHECK(compare(slurp(folder.file("again_right.out")), right)["bayes_factor_10"] == 2);
    CHECK(of_yes["criterion"] == 6);
    CHECK(of_yes["d_prime"] == 6);
    CHECK(of_yes["brier"] == 3);
    CHECK(of_yes["overconfidence"] == 3);
    if (known.out == "TRUE") {
        CHECK(kinds["of lme4"] >= 18);
    } else {
        WARN("R's lme4 is not installed: the mixed model by Laplace was skipped");
    }

    CHECK(yes["frictions"] == Json({"oiled", "dry"}));
    CHECK(yes["not_applied"].is_null());
    CHECK(ours["applied"]["answers"] == 6 * 40 - 40 - 2);
    CHECK(ours["not_applied"]["answers"] == 6 * 40);
    CHECK_FALSE(ours["applied"]["people"].contains("P01"));
    CHECK(ours["not_applied"]["people"].contains("P01"));
    CHECK(ours["excluded"][0] ==
          Json({{"subject", "P01"}, {"why", "catch trials"}, {"trials", 40}}));
    CHECK(ours["excluded"][1]["trials"] == 2);
    // The script that somebody may have changed, and its trials, are never written over.
    no_stats({folder.file("d.csv"), "--emit-r", folder.file("again.R")}, "again.csv");
    // The trials beside it are the same table.
    Json again = with({folder.file("again.csv")});
    again["source"] = ours["source"];
    CHECK(again == ours);
    const Finished bare = stats({folder.file("yes.csv"), "--simulations", "0"});
    CHECK_THAT(bare.out, Has("share of yes", "none is right or wrong: --signal SHAPE") &&
                             HasNone("log-linear", "d'"));
}

TEST_CASE("palpate stats prints what its JSON holds, the same every time") {
    const TemporaryFile file("d.csv");
    write(file, made_up(6, 40, false));
    const Words words{file, "--simulations", "60"};
    const Finished text = stats(words);
    REQUIRE(text.code == 0);
    CHECK(stats(words).out == text.out);
    const Finished one_core =
        Process({"taskset", "-c", "0", palpate_program(), "stats", words[0], words[1], words[2]})
            .wait();
    CHECK(one_core.out == text.out);
    const Json all = numbers_of(words);
    CHECK_THAT(text.out, Has("Nothing is excluded"));
    const Json& part = all["applied"];
    for (const auto& [name, person] : part["people"].items()) {
        for (const auto& [friction, cell] : person["friction"].items()) {
            CHECK_THAT(text.out,
                       Has(fmt::format("{:>2}    {:>2}  {:.3f} to {:.3f}  ", cell["k"].get<int>(),
                                       cell["n"].get<int>(), cell["wilson_95"][0].get<double>(),
                                       cell["wilson_95"][1].get<double>())));
        }
    }
    for (const auto& [key, measure] : part["measures"].items()) {
        const Json& effect = measure["effects"]["on"];
        CAPTURE(key);
        CHECK_THAT(text.out, Has(fmt::format("{:.3f}", effect["mean"].get<double>()),
                                 fmt::format("  {:.3f}   5  ", effect["t"].get<double>())));
        CHECK(effect["interval_95"][0] < effect["mean"]);
    }
    const Json& mixed = part["mixed_model"]["on"];
    CHECK_THAT(text.out,
               Has(fmt::format("{:.4f}", mixed["laplace"]["effect"].get<double>()),
                   fmt::format("{:.4f}", mixed["laplace"]["effect_se"].get<double>()),
                   fmt::format("{:.4f}", mixed["quadrature"]["log_likelihood"].get<double>()),
                   "half chi-square of 1 df, half of 2"));
    CHECK(mixed["laplace"]["no_effect"]["simulated_p"].get<double>() > 0.0);
    const Json other = numbers_of({file, "--simulations", "60", "--seed", "2"});
    CHECK(other["applied"]["measures"] == part["measures"]);
    CHECK(other["applied"]["people"] != part["people"]);
}

TEST_CASE("palpate stats of a few people says what cannot be known from them") {
    const TemporaryFolder folder;
    CHECK_THAT(ran({"stats", write(folder.file("one.csv"), made_up(1, 30, false))}).out,
               Has("one person: nothing follows for others") && !Has("Mixed model"));
    CHECK_THAT(stats({write(folder.file("shape.csv"),
                            "subject,trial,shape,friction,response\nA,1,a,off,a\n")})
                   .out,
               Has("Answers name the one shape that was felt", "--alternatives") &&
                   !Has("chance is") && !Has("d'"));
    std::string alike = "subject,trial,shape,friction,response\n";
    for (const char* person : {"A", "B", "C"}) {
        for (int i = 0; i < 20; ++i) {
            alike += fmt::format("{},{},a,{},{}\n", person, i, i % 2 == 0 ? "off" : "on",
                                 i % 2 == 0 || i < 10 ? "a" : "b");
        }
    }
    write(folder.file("alike.csv"), alike);
    std::string sure = "subject,trial,shape,friction,response,confidence\n";
    for (int i = 0; i < 8; ++i) {
        sure += fmt::format("A,{},a,{},a,1e9\n", i, i % 2 == 0 ? "off" : "on");
    }
    CHECK_THAT(stats({write(folder.file("sure.csv"), sure)}).out, Has("1000000000.000"));
    std::string even = "subject,trial,shape,friction,response,rt_s\n";
    for (int i = 0; i < 12 * 30; ++i) {
        even += fmt::format("P{:02},{},{},{},{},1.3\n", i / 30, i % 30 + 1, i % 3 == 0 ? "a" : "b",
                            i % 7 < 3 ? "off" : "on", i % 3 == 0 ? "a" : "b");
    }
    const Words words{write(folder.file("even.csv"), even), "--simulations", "0", "--permutations",
                      "0"};
    const Json all = numbers_of(words);
    const Json& bits = all["applied"]["people"]["P00"]["friction"]["off"]["bits"];
    CHECK(bits["null_p"].is_null());
    // 14 answers, all right: Miller and Madow's 0.86 + 1 / (28 ln 2) is more than there is.
    CHECK(bits["miller_madow"].get<double>() <= bits["interval_95"][1].get<double>());
    for (const Json& none : {all["applied"]["measures"]["share"]["effects"]["on"],
                             all["applied"]["measures"]["log_rt"]["effects"]["on"],
                             all["applied"]["within_person"]["share_per_trial"],
                             all["applied"]["within_person"]["log_rt_per_trial"]}) {
        CHECK(none["sign_flip_p"] == 1.0);
        CHECK(none["wilcoxon_p"] == 1.0);
        CHECK(none["wilcoxon_ranked"] == 0);
    }
    CHECK_THAT(stats(words).out, !Has("null"));
    const Finished same =
        stats({folder.file("alike.csv"), "--simulations", "0", "--other-answers"});
    CHECK(same.code == 0);
    CHECK_THAT(same.out, Has("all the same: no t", "effect have no end", "the fit is singular",
                             "hardly known from fewer than 6"));
    // 8 and 7 of 10, then 6 and 5: in doubles 0.8 - 0.6 is not 0.7 - 0.5.
    std::string less = "subject,trial,shape,friction,response\n";
    for (int i = 0; i < 40; ++i) {
        const int right = (i / 20 == 0 ? 8 : 7) - (i / 10 % 2 == 0 ? 0 : 2);
        const char* shape = i % 2 == 0 ? "a" : "b";
        const char* wrong = i % 2 == 0 ? "b" : "a";
        less += fmt::format("P{},{},{},{},{}\n", i / 20, i, shape, i / 10 % 2 == 0 ? "off" : "on",
                            i % 10 < right ? shape : wrong);
    }
    const Json effect =
        numbers_of({write(folder.file("less.csv"), less), "--simulations", "0", "--permutations",
                    "0"})["applied"]["measures"]["share"]["effects"]["on"];
    CHECK(effect["mean"].get<double>() == Approx(-0.2));
    for (const char* number : {"t", "t_p", "interval_95", "bayes_factor_10"}) {
        CHECK(effect[number].is_null());
    }
}

TEST_CASE("palpate stats refuses what it cannot take, at its place, with value and remedy") {
    const TemporaryFolder folder;
    const std::string csv = folder.file("d.csv");
    for (const auto& row : test_rows("stats_refusals.tsv")) {  // the table, words, and what is said
        CAPTURE(row);
        write(csv, row.at(0));
        no_stats(words_of(csv, row.at(1)), row.at(2));
    }
    no_stats({folder.file("none.csv")}, "none.csv");
    write(csv, "subject,trial,shape,friction,response\nA,1,a,on,a\nA,2,b,off,a\n");
    no_stats({csv, "--emit-r", folder.file("x.csv")}, "give a script's name, as analysis.R");
}

TEST_CASE("palpate stats of a database says what its trials say, of one kind, and names nobody") {
    const TemporaryFolder folder;
    std::string protocol = edited(four_trials(), {{"repetitions = 1", "repetitions = 4"},
                                                  {"break_every = 0", "break_every = 5"}});
    write(folder.file("p.toml"), protocol +
                                     "\n[response]\nconfidence = true\n\n[exclusion]\n"
                                     "share_correct_min = 0.7\n");
    const std::string file =
        run_by({"Ada", "Bob", "Cem"}, folder.file("p.toml"), folder.file("a.sqlite"));
    no_stats({file},
             "has no answer of identification or yes-no without a rule in real sessions: --kind "
             "chooses");
    no_stats({file, "--kind", "all"}, "--kind");
    no_stats({file, "--kind", "simulated", "--other-answers"}, "--other-answers is for a CSV");
    const Words words{file, "--kind", "simulated", "--simulations", "0"};
    const Finished text = stats(words);
    REQUIRE(text.code == 0);
    CHECK_THAT(text.out, Has("participant and device are SIMULATED", "sub-") && !Has("Ada") &&
                             Has("Confidence: share correct at each level"));
    const Words scripted = joined(words, {"--emit-r", folder.file("again.R")});
    Json ours = numbers_of(scripted);
    CHECK_THAT(slurp(folder.file("again.csv")), !Has("Ada"));
    CHECK(ours["kind"] == "simulated");
    CHECK(ours["alternatives"] == 2);

    // Counts, by SQL; with and without those whom the protocol's rule leaves out.
    const Json named = numbers_of(joined(words, {"--keep-codes"}));
    const Json& part = named["not_applied"].is_null() ? named["applied"] : named["not_applied"];
    const std::string counts =
        sql_csv(file,
                "SELECT participant_code, friction, count(*) AS n, sum(correct) AS k, "
                "avg(ln(reaction_s)) AS rt FROM analysis_trial WHERE counts AND phase = "
                "'main' GROUP BY 1, "
                "2");
    std::size_t poor = 0;
    std::map<std::string, int> right;
    int compared = 0;
    for (const auto& row : csv_records(counts)) {
        const Json& cell =
            part["people"][row.at("participant_code")]["friction"][row.at("friction")];
        CHECK(cell["n"] == std::stoi(row.at("n")));
        CHECK(cell["k"] == std::stoi(row.at("k")));
        CHECK(cell["log_rt"].get<double>() == Approx(std::stod(row.at("rt"))));
        right[row.at("participant_code")] += std::stoi(row.at("k"));
        ++compared;
    }
    CHECK(compared == 6);
    for (const auto& [person, k] : right) {
        poor += k < 0.7 * 16 ? 1U : 0U;
    }
    CHECK(named["excluded"].size() == poor);
    CHECK(named["not_applied"].is_null() == (poor == 0));

    // The trials beside the script are the same table.
    Json again = numbers_of({folder.file("again.csv"), "--simulations", "0"});
    for (const char* of_file : {"source", "study", "kind", "primary_test", "left_out"}) {
        again[of_file] = ours[of_file];
    }
    for (const char* which : {"applied", "not_applied"}) {  // a CSV has no primary test
        if (!again[which].is_null()) {
            again[which]["primary"] = ours[which]["primary"];
        }
    }
    CHECK(again == ours);
}
