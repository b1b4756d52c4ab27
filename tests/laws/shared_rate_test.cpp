#include "tests/support/json_of.hpp"

namespace {

/// Hits of 40 at 1 to 8, drawn from normal curves of thresholds 3.5, 4.2 and 3, slopes 1.2, 0.9 and
/// 1.5, and a lapse rate of 0.05.
const std::string kPeople = test_text("shared_lapse.csv");

/// The same of thresholds 4.5 and 5.2 and a guess rate of 0.2, without lapses.
const std::string kGuessing = test_text("shared_guess.csv");

}  // namespace

TEST_CASE(
    "one rate of all conditions, of lapses or guesses, is that of R's joint likelihood, its "
    "intervals and p too") {
    EACH(guess, false, true);
    const std::string rate = guess ? "guess" : "lapse";
    const std::size_t conditions = guess ? 2 : 3;
    const Words asked =
        guess ? Words{"--guess", "shared", "--lapse", "0"} : Words{"--lapse", "shared"};
    const TemporaryFile csv("d.csv");
    write(csv, guess ? kGuessing : kPeople);
    const auto with = [&](const Words& words) {
        return joined(words, asked);
    };
    const Json all = fitted(with({csv, "--bootstrap", "40"}));
    CHECK(all[rate] == "free, one for all conditions of a person");
    CHECK_THAT(palpate_command(with({"fit", csv, "--bootstrap", "0"})).out,
               Has(rate + " free, one for all conditions of a person",
                   fmt::format("agree on {0} of {0} curves", 2 * conditions)));
    for (std::size_t person = 0; person < 2; ++person) {
        for (std::size_t c = 0; c < conditions; ++c) {  // of all conditions the same
            const Json& curve = all["curves"][conditions * person + c];
            CHECK(curve[rate]["estimate"].get<double>() ==
                  Approx(all["curves"][conditions * person][rate]["estimate"].get<double>())
                      .epsilon(1e-4));
            CHECK(curve[rate]["bootstrap_95"] ==
                  all["curves"][conditions * person][rate]["bootstrap_95"]);
        }
    }
    // The joint likelihood by optim: rate, thresholds, slopes; ends of the profiles of the rate and
    // the first threshold; the likelihood ratio's p of equal thresholds and slopes of the first two.
    const Finished r = Process({"Rscript", script("joint_fit.R"), csv, rate}).wait();
    if (r.code != 0) {
        REQUIRE_FALSE(has_r());
        return;
    }
    std::istringstream numbers(r.out);
    const auto next = [&] {
        double one = 0.0;
        REQUIRE(numbers >> one);
        return one;
    };
    const Json& first = all["curves"][0];
    CHECK(first[rate]["estimate"].get<double>() == Approx(next()).epsilon(2e-4));
    for (const char* what : {"threshold", "slope"}) {
        for (std::size_t c = 0; c < conditions; ++c) {
            CHECK(all["curves"][c][what]["estimate"].get<double>() == Approx(next()).epsilon(2e-4));
        }
    }
    for (const char* what : {rate.c_str(), "threshold"}) {
        for (const std::size_t end : {0U, 1U}) {
            CHECK(first[what]["profile_95"][end].get<double>() == Approx(next()).epsilon(1e-3));
        }
    }
    CHECK(all["differences"][0]["p"].get<double>() == Approx(next()).epsilon(1e-3));
    CHECK(all["differences"][1]["p"].get<double>() == Approx(next()).epsilon(1e-3));
}

TEST_CASE(
    "intervals of a shared lapse rate hold the truth of simulated people, and it is off by "
    "nothing") {
    constexpr double kLapse = 0.05;
    constexpr int kMany = 40;
    constexpr int kFew = 8;
    std::mt19937_64 random(11);
    std::string all = "stimulus,n,k,participant,condition\n";
    std::string few;
    for (int person = 0; person < kMany; ++person) {
        few = person == kFew ? all : few;
        for (const auto& [condition, threshold] : {std::pair{"a", 3.4}, std::pair{"b", 4.1}}) {
            for (int stimulus = 1; stimulus <= 8; ++stimulus) {
                std::binomial_distribution<int> hits(
                    40, (1.0 - kLapse) * 0.5 * std::erfc((threshold - stimulus) / std::sqrt(2.0)));
                all += fmt::format("{},40,{},P{},{}\n", stimulus, hits(random), person, condition);
            }
        }
    }
    const TemporaryFile file("d.csv");
    write(file, all);
    const Json of_all = fitted({file, "--lapse", "shared", "--bootstrap", "0"});
    int held = 0;
    double sum = 0.0;
    double squares = 0.0;
    for (int person = 0; person < kMany; ++person) {
        const Json& rate = of_all["curves"][2 * static_cast<std::size_t>(person)]["lapse"];
        const double estimate = rate["estimate"];
        held += rate["profile_95"][0].get<double>() <= kLapse &&
                        kLapse <= rate["profile_95"][1].get<double>()
                  ? 1
                  : 0;
        sum += estimate;
        squares += estimate * estimate;
    }
    const double mean = sum / kMany;
    const double sd = std::sqrt(squares / kMany - mean * mean);
    CAPTURE(held, mean, sd);
    CHECK(std::fabs(held / static_cast<double>(kMany) - 0.95) <
          3.5 * std::sqrt(0.95 * 0.05 / kMany));
    CHECK(std::fabs(mean - kLapse) < 0.1 * sd + 3.5 * sd / std::sqrt(kMany));
    // With a rate of each curve's own the two conditions differ, and each is known less well.
    write(file, few);
    const Json own = fitted({file, "--lapse", "free", "--bootstrap", "0"});
    double of_own = 0.0;
    double of_shared = 0.0;
    for (std::size_t i = 0; i < 2 * std::size_t{kFew}; ++i) {
        const auto width = [&](const Json& from) {
            const Json& ends = from["curves"][i]["lapse"]["profile_95"];
            return ends[1].get<double>() - ends[0].get<double>();
        };
        of_own += width(own);
        of_shared += width(of_all);
    }
    CHECK(of_shared < 0.85 * of_own);
}

TEST_CASE("a rate that is shared with no other condition is free") {
    const TemporaryFile csv("d.csv");
    write(csv, kPeople.substr(0, kPeople.find("P0,b") - std::string("1,40,0,").size()));
    Json shared = fitted({csv, "--lapse", "shared", "--bootstrap", "60", "--guess", "lapse"});
    Json free = fitted({csv, "--lapse", "free", "--bootstrap", "60", "--guess", "lapse"});
    for (const char* what : {"estimate", "profile_95"}) {
        for (const char* quantity : {"lapse", "threshold", "jnd"}) {
            CHECK(shared["curves"][0][quantity][what] == free["curves"][0][quantity][what]);
        }
    }
    const Json& ends = free["curves"][0]["threshold"]["bootstrap_95"];
    CHECK(shared["curves"][0]["threshold"]["bootstrap_95"][0].get<double>() ==
          Approx(ends[0].get<double>()).epsilon(1e-4));
}
