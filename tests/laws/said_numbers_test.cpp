#include <regex>

#include "tests/support/json_of.hpp"

// Where answers do not determine a number, fit and stats say so, and why.

TEST_CASE("of separated answers all maxima are said, and no mean is made of one of them") {
    const TemporaryFolder folder;
    write(folder.file("sep.csv"), "stimulus,n,k\n1,20,0\n2,20,0\n3,20,20\n4,20,20\n");
    const Json apart = fitted({folder.file("sep.csv"), "--lapse", "0"})["curves"][0]["threshold"];
    CHECK(apart["estimate"].is_null());
    CHECK(apart["why"] == "not determined: 2 to 3");
    CHECK(apart["profile_95"] == Json{2.0, 3.0});
    const std::string text = palpate_command({"fit", folder.file("sep.csv")}).out;
    CHECK_THAT(text, Has("not determined: 2 to 3") && !Has("2.5"));
    // On a level with an answer of the other kind a steep curve tends to that level.
    const std::string on_a_level = "stimulus,n,k\n1,10,0\n2,10,1\n3,10,10\n";
    const Json edge = fitted(
        {write(folder.file("edge.csv"), on_a_level), "--lapse", "0"})["curves"][0]["threshold"];
    CHECK(edge["estimate"] == 2.0);
    CHECK(edge["profile_95"][0] == 2.0);
    CHECK(edge["profile_95"][1].get<double>() < 3.0);
    // One threshold for both is as good as two: x has its at 2, y anywhere from 2 to 3.
    std::string two = "stimulus,n,k,participant,condition\n";
    for (const char* who : {"A", "B"}) {
        for (const char* row : {"1,20,0,{0},x", "2,20,10,{0},x", "3,20,20,{0},x", "1,20,0,{0},y",
                                "2,20,{1},{0},y", "3,20,20,{0},y"}) {
            two += fmt::format(fmt::runtime(row), who, *who == 'A' ? 0 : 10) + '\n';
        }
    }
    const Json both = fitted({write(folder.file("two.csv"), two)});
    CHECK(both["differences"][0]["p"].get<double>() > 0.999);
    CHECK(both["differences"][0]["difference"].is_null());
    CHECK(both["differences"][0]["why"] == "not determined: that of a condition is not");
    for (const Json& one : both["people"]) {
        if (one["what"] == "threshold, y") {
            CHECK(one["people"] == 1);
            CHECK(one["mean"] == Approx(2.0).margin(1e-6));
            CHECK(one["left_out"][0] == "A (not determined: 2 to 3)");
        }
    }
}

TEST_CASE("digits tell an estimate from its interval, and single answers have no goodness of fit") {
    const TemporaryFolder folder;
    std::string near = "stimulus,n,k\n";
    std::string far = near;
    std::string single = near;
    constexpr std::array kRight{1, 3, 9, 16, 19, 20};
    for (int i = 0; i < 6; ++i) {
        near += fmt::format("{},20,{}\n", i, kRight.at(static_cast<std::size_t>(i)));
        far += fmt::format("{},20,{}\n", 10000 + i, kRight.at(static_cast<std::size_t>(i)));
    }
    for (int i = 0; i < 60; ++i) {
        single += fmt::format("{},1,{}\n", 0.1 * i, i * i * 7 % 60 < i ? 1 : 0);
    }
    write(folder.file("near.csv"), near);
    write(folder.file("far.csv"), far);
    write(folder.file("single.csv"), single);
    const auto threshold = [&](const char* name) {
        const std::string text =
            palpate_command({"fit", folder.file(name), "--bootstrap", "0"}).out;
        std::istringstream line(text.substr(text.find("\n  threshold ") + 13));
        std::array<double, 4> printed{};
        std::string to;
        line >> printed[0] >> printed[1] >> printed[2] >> to >> printed[3];
        return printed;
    };
    const auto printed_near = threshold("near.csv");
    const auto printed_far = threshold("far.csv");
    for (const std::size_t i : {0U, 2U, 3U}) {
        CAPTURE(printed_near, printed_far);
        CHECK(printed_far.at(i) - 10000.0 ==
              Approx(printed_near.at(i)).margin(0.051 * printed_near[1]));
    }
    const Json curve = fitted({folder.file("single.csv")})["curves"][0];
    CHECK(curve["deviance_p"].is_null());
    CHECK_THAT(curve["deviance_why"].get<std::string>(), Has("single answers"));
    CHECK(fitted({folder.file("near.csv")})["curves"][0]["deviance_why"].is_null());
}

TEST_CASE(
    "where the share does not grow no free rate has a number, unless another curve shares it") {
    const TemporaryFolder folder;
    const auto flat = [&](int k) {
        write(folder.file("flat.csv"),
              fmt::format("stimulus,n,k\n1,20,{0}\n2,20,{0}\n3,20,{0}\n", k));
        return fitted({folder.file("flat.csv"), "--guess", "free", "--lapse", "free", "--bootstrap",
                       "0"})["curves"][0];
    };
    for (const int k : {0, 12, 20}) {
        const Json curve = flat(k);
        for (const char* rate : {"guess", "lapse"}) {
            CAPTURE(k, rate);
            CHECK(curve[rate]["estimate"].is_null());
            CHECK(curve[rate]["why"] == "none: the share does not grow");
        }
    }
    const Json given = fitted({folder.file("flat.csv"), "--guess", "0.5", "--bootstrap", "0"});
    CHECK(given["curves"][0]["guess"]["estimate"] == 0.5);
    CHECK(given["curves"][0]["lapse"]["estimate"] == 0.02);

    std::string two = "stimulus,n,k,participant,condition\n";
    for (const auto& [stimulus, k] :
         {std::pair{1, 1}, std::pair{2, 8}, std::pair{3, 15}, std::pair{4, 19}, std::pair{5, 18}}) {
        two += fmt::format("{0},20,{1},A,rises\n{0},20,20,A,flat\n", stimulus, k);
    }
    const Json both = fitted({write(folder.file("two.csv"), two), "--guess", "free", "--lapse",
                              "shared", "--bootstrap", "0"});
    for (const Json& curve : both["curves"]) {
        CAPTURE(curve.dump());
        CHECK(curve["lapse"]["estimate"].is_number());
        CHECK(curve["guess"]["estimate"].is_null() == (curve["condition"] == "flat"));
        CHECK(curve["log_likelihood_of"] == "all conditions of the person");
        CHECK(curve["log_likelihood"].get<double>() ==
              Approx(both["curves"][0]["log_likelihood"].get<double>()));
    }
    CHECK(given["curves"][0]["log_likelihood_of"] == "this curve");
}

TEST_CASE("a weibull's prior of its threshold is a median and an sd of ln, and --help says so") {
    CHECK_THAT(std::regex_replace(ran({"fit", "--help"}).out, std::regex("\\s+"), " "),
               Has("threshold=MEAN,SD (weibull: MEDIAN,SD of ln)"));
    const TemporaryFolder folder;
    const auto threshold = [&](double unit, const std::string& prior) {
        std::string text = "stimulus,n,k\n";
        for (const auto& [stimulus, k] :
             {std::pair{1, 3}, std::pair{2, 5}, std::pair{3, 6}, std::pair{4, 9}}) {
            text += fmt::format("{},10,{}\n", unit * stimulus, k);
        }
        write(folder.file("d.csv"), text);
        return fitted({folder.file("d.csv"), "--function", "weibull", "--prior",
                       "threshold=" + prior, "--bootstrap",
                       "0"})["curves"][0]["threshold"]["estimate"]
            .get<double>();
    };
    // The unit of the stimulus does not change what an sd of ln says.
    CHECK(threshold(10.0, "8,0.1") == Approx(10.0 * threshold(1.0, "0.8,0.1")).epsilon(1e-6));
}

TEST_CASE("a response that no shape has is refused by its line, or kept by word") {
    const TemporaryFile file("t.csv");
    std::string text = "subject,trial,shape,friction,response\n";
    for (int i = 1; i <= 40; ++i) {
        const char* shape = i % 2 == 0 ? "flat" : "round";
        text += fmt::format("S{},{},{},{},{}\n", i % 4, i, shape, i % 8 < 4 ? "off" : "on",
                            i == 17      ? "zzz"
                            : i % 5 == 0 ? "flat"
                                         : shape);
    }
    write(file, text);
    const auto refused = palpate_command({"stats", file});
    CHECK(refused.code != 0);
    CHECK_THAT(refused.error, Has("t.csv:18", "zzz", "flat, round"));
    const auto kept = palpate_command({"stats", file, "--other-answers"});
    CAPTURE(kept.error);
    CHECK_THAT(kept.out, Has("one of 3 shapes"));
}

TEST_CASE("a mixed model of a condition that is all right has no effect but a ratio") {
    const TemporaryFile file("t.csv");
    std::string text = "subject,trial,shape,friction,response\n";
    for (int i = 0; i < 160; ++i) {
        const char* shape = i % 2 == 0 ? "flat" : "round";
        const bool on = i / 8 % 2 == 1;
        text += fmt::format("S{},{},{},{},{}\n", i % 8, i, shape, on ? "on" : "off",
                            on || i % 3 != 0 ? shape : "flat");
    }
    write(file, text);
    const Words words{"stats", file, "--simulations", "0", "--permutations", "0"};
    const Json model = json_of(words)["applied"]["mixed_model"]["on"]["laplace"];
    CHECK(model["effect"].is_null());
    CHECK(model["effect_se"].is_null());
    CHECK(model["sd_effect"].is_null());  // every spread about what has no end is as good
    CHECK(model["correlation"].is_null());
    CHECK(model["sd_intercept"].is_number());
    CHECK_THAT(model["why"].get<std::string>(), Has("one kind alone"));
    CHECK(model["intercept"].is_number());
    CHECK(model["no_effect"]["chi_square"].get<double>() > 4.0);
    CHECK(model["no_effect"]["p"].get<double>() < 0.05);
    CHECK_THAT(ran(words).out, Has("unbounded: a condition has answers of one kind alone",
                                   "the likelihood ratio holds"));
}
