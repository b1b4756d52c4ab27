#include "protocols/procedure/procedure.hpp"
#include "tests/protocols/simulated_answers.hpp"
#include "tests/support/catch.hpp"

using namespace palpate::protocols;

namespace {

QuestPlusSpec yes_no() {
    return {.model = psychometric_model(Family::normal, LapseForm::upper, SlopeAs::sd),
            .stimuli = Grid({{"stimulus", evenly(-6, 6, 25)}}),
            .parameters = Grid({{"threshold", evenly(-4, 4, 33)},
                                {"sd", evenly(0.5, 3.5, 7)},
                                {"guess", {0.02}},
                                {"lapse", {0.0, 0.02, 0.04}}}),
            .trials = 120};
}

QuestPlusSpec identification() {
    return {.model = identification_model({-10, -5, 0, 5, 10}),
            .stimuli = Grid({{"stimulus", {-10, -5, 0, 5, 10}}}),
            .parameters =
                Grid({{"noise", evenly(1, 7, 13)}, {"bias", evenly(-3, 3, 13)}, {"lapse", {0.02}}}),
            .trials = 150};
}

/// Errors of the posterior mean of parameter k over seeded runs.
std::vector<double> errors(const QuestPlusSpec& spec, std::size_t k, int runs) {
    const QuestPlus fresh(spec);
    std::vector<double> errors;
    for (int run = 0; run < runs; ++run) {
        Random random(static_cast<std::uint64_t>(run) + 77);
        std::vector<double> truth;
        for (const palpate::protocols::Axis& axis : spec.parameters.axes()) {
            // Inside, so that the grid's ends do not pull.
            const double lo = axis.values.front();
            const double hi = axis.values.back();
            truth.push_back(random.in(lo + 0.25 * (hi - lo), hi - 0.25 * (hi - lo)));
        }
        QuestPlus quest = fresh;
        while (!quest.finished()) {
            const std::vector<double> x = quest.next();
            quest.update(x, answer_of(spec.model, x, truth, random));
        }
        errors.push_back(quest.posterior().mean(spec.parameters)[k] - truth[k]);
    }
    return errors;
}

}  // namespace

TEST_CASE("QUEST+ finds the threshold of a simulated observer without bias") {
    const Spread error = spread_of(errors(yes_no(), 0, 60));
    // The best stimulus gives about .64 / sd^2 of Fisher information a trial on the threshold of a
    // yes/no task (at F = 1/2): with sd 2 and 120 trials no unbiased estimate spreads less than
    // .23.
    CHECK(std::fabs(error.mean) < 3.0 * error.sd / std::sqrt(60.0));
    CHECK(error.sd < 2.0 * 0.23);
}

TEST_CASE("QUEST+ finds noise and bias from five alternatives") {
    const QuestPlusSpec spec = identification();
    const Spread noise = spread_of(errors(spec, 0, 50));
    const Spread bias = spread_of(errors(spec, 1, 50));
    CHECK(std::fabs(noise.mean) < 0.3);
    CHECK(noise.sd < 0.7);
    CHECK(std::fabs(bias.mean) < 3.0 * bias.sd / std::sqrt(50.0));
    CHECK(bias.sd < 0.7);  // noise 4: at least .33 from 150 percepts themselves
}

TEST_CASE("the identification model is counted out by its percepts") {
    const std::vector<double> items{-10, -5, 0, 5, 10};
    const OutcomeModel model = identification_model(items);
    SEEDED(random, std::uint64_t{6});
    const std::vector<double> s{random.in(1, 8), random.in(-3, 3), random.in(0, 0.2)};
    const std::vector<double> x{random.in(-12, 12)};
    std::vector<double> chances(5);
    model.chances(x, s, chances);
    CHECK(std::accumulate(chances.begin(), chances.end(), 0.0) == Approx(1.0).epsilon(1e-14));
    std::array<int, 5> counts{};
    std::mt19937_64 words(seed);
    constexpr int kDraws = 100'000;
    for (int i = 0; i < kDraws; ++i) {
        const double u = random.in(1e-12, 1.0);
        const double percept =
            x[0] + s[1] +
            s[0] * std::sqrt(-2.0 * std::log(u)) * std::cos(6.283185307179586 * random.in(0, 1));
        std::size_t nearest = 0;
        for (std::size_t j = 1; j < 5; ++j) {
            if (std::fabs(percept - items[j]) < std::fabs(percept - items[nearest])) {
                nearest = j;
            }
        }
        if (random.in(0, 1) < s[2]) {
            nearest = random.index(5);
        }
        ++counts[nearest];
    }
    for (std::size_t j = 0; j < 5; ++j) {
        const double deviation = std::sqrt(chances[j] * (1.0 - chances[j]) / kDraws);
        CAPTURE(seed, j);
        CHECK(std::fabs(counts[j] / double(kDraws) - chances[j]) < 5.0 * deviation + 1e-5);
    }
}

TEST_CASE("the order of the responses does not matter to the posterior") {
    SEEDED(random, std::uint64_t{30});
    const QuestPlusSpec spec = seed % 2 == 0 ? yes_no() : identification();
    std::vector<std::pair<std::vector<double>, std::size_t>> trials;
    for (int i = 0; i < 40; ++i) {
        const auto x = random.index(spec.stimuli.size());
        const auto r = random.index(spec.model.outcomes);
        trials.emplace_back(spec.stimuli.point(x), r);
    }
    QuestPlus forward(spec);
    QuestPlus backward = forward;
    for (std::size_t i = 0; i < trials.size(); ++i) {
        forward.update(trials[i].first, trials[i].second);
        const auto& other = trials[trials.size() - 1 - i];
        backward.update(other.first, other.second);
    }
    const auto a = forward.posterior().weights();
    const auto b = backward.posterior().weights();
    for (std::size_t c = 0; c < a.size(); ++c) {
        CAPTURE(seed, c);
        REQUIRE(b[c] == Approx(a[c]).epsilon(1e-11).margin(1e-300));
    }
}

TEST_CASE("a run of any rule that is rebuilt from its responses has the hash of the run") {
    SEEDED(random, std::uint64_t{80});
    const std::array<ProcedureSpec, 4> specs{
        yes_no(), identification(),
        ConstantStimuliSpec{.values = evenly(0, 5, 6), .repetitions = 5},
        std::vector<StaircaseSpec>{
            {.name = "a", .start = 3.0, .trials = 15},
            {.name = "b", .start = 5.0, .down = 3, .reversals = 6, .average = 4},
            {.name = "c", .start = 1.0, .down = 1, .trials = 9}}};
    const ProcedureSpec& spec = specs.at(seed % 4);
    Procedure run(spec, Pcg32(seed, 5));
    Procedure rebuilt(spec, Pcg32(seed, 5));
    const bool draws = seed % 4 > 1;
    CHECK((!draws || run.state_hash() != Procedure(spec, Pcg32(seed + 100, 5)).state_hash()));
    std::set<std::string> hashes{run.state_hash()};
    for (int i = 0; i < 20; ++i) {
        const std::vector<double> shown = run.next();
        const auto answer = random.index(2);
        run.update(shown, answer);
        REQUIRE(hashes.insert(run.state_hash()).second);
        REQUIRE(rebuilt.next() == shown);
        rebuilt.update(shown, answer);
        REQUIRE(rebuilt.state_hash() == run.state_hash());
    }
}

TEST_CASE("the state of a run is the same to the bit with every compiler and C library") {
    // Computed by this program on x86-64 with gcc 12 -O0, gcc 12 -O3 -march=native and clang 14
    // -O2, which agree: the arithmetic uses nothing of libm that is not exact, so any other
    // IEEE-754 machine must too.
    QuestPlus quest(yes_no());
    QuestPlus five(identification());
    Quest threshold({.guess = 0.3});
    for (std::size_t i = 0; i < 40; ++i) {
        quest.update(quest.next(), i * i % 3 == 1 ? 1 : 0);
        five.update(five.next(), i * i % 5);
        threshold.update(threshold.next(), i * i % 3 == 1 ? 1 : 0);
    }
    CHECK(quest.state_hash() == "7a3512fd89d836535070ebf091961d620bf46abd4e520e90c081a461211e4bcf");
    CHECK(five.state_hash() == "39a2222fb2d4304d9d6c82fab87a4d2509dc1f3a673cb7d48c9aab0ba3dbab89");
    CHECK(threshold.state_hash() ==
          "7f730dd12d5471d885e6cb30d5299c535f72c632815e2b3dc2b85dc50da162cd");
}

TEST_CASE("a table is computed once for equal models and grids, and anew for any other") {
    QuestPlusSpec spec{.model = psychometric_model(Family::normal, LapseForm::upper),
                       .stimuli = Grid({{"stimulus", evenly(-3, 3, 31)}}),
                       .parameters = Grid({{"threshold", evenly(-2, 2, 21)},
                                           {"slope", {0.5, 1.0, 2.0}},
                                           {"guess", {0.5}},
                                           {"lapse", {0.01}}})};
    std::size_t asked = 0;
    const auto counted = [&](OutcomeModel model) {
        model.chances = [&asked, chances = model.chances](auto x, auto s, auto p) {
            ++asked;
            chances(x, s, p);
        };
        return model;
    };
    const auto cost = [&] {
        const std::size_t before = asked;
        const QuestPlus quest(spec);
        CHECK(quest.next() == QuestPlus(spec).next());
        return asked - before;
    };
    spec.model = counted(spec.model);
    const std::size_t cells = spec.parameters.size() * spec.stimuli.size();
    CHECK(cost() == cells);
    CHECK(cost() == 0);
    spec.trials = 3;  // the table does not depend on it
    CHECK(cost() == 0);
    spec.stimuli = Grid({{"stimulus", evenly(-3, 3, 32)}});
    CHECK(cost() == cells / 31 * 32);
    spec.model = counted(psychometric_model(Family::logistic, LapseForm::upper));
    CHECK(cost() == cells / 31 * 32);
    spec.model = counted(psychometric_model(Family::logistic, LapseForm::guessing));
    CHECK(cost() == cells / 31 * 32);
    spec.model.same.clear();  // nothing says what it is
    CHECK(cost() == 2 * (cells / 31 * 32));

    std::vector<double> told;
    announce_large_tables([&](double megabytes) { told.push_back(megabytes); });
    CHECK(cost() > 0);
    CHECK(told.empty());  // a small one
    spec.model = psychometric_model(Family::logistic, LapseForm::guessing);
    spec.stimuli = Grid({{"stimulus", evenly(-3, 3, 40'000)}});
    CHECK(cost() == 0);  // not counted
    announce_large_tables({});
    REQUIRE(told.size() == 1);
    CHECK(told[0] == Approx(8e-6 * 3 * 40'000 * 63));
}

TEST_CASE("QUEST+ ends by trials or by entropy") {
    QuestPlusSpec spec = yes_no();
    spec.trials = 7;
    QuestPlus quest(spec);
    for (int i = 0; i < 7; ++i) {
        CHECK_FALSE(quest.finished());
        quest.update(quest.next(), 1);
    }
    CHECK(quest.finished());
    spec.trials = 500;
    spec.entropy_bits = 5.0;
    QuestPlus sharp(spec);
    Random random(1);
    while (!sharp.finished()) {
        const std::vector<double> x = sharp.next();
        sharp.update(x,
                     answer_of(spec.model, x, std::vector<double>{1.0, 1.0, 0.02, 0.02}, random));
    }
    CHECK(sharp.entropy() < 5.0);
    CHECK(sharp.trials() < 500);
}

TEST_CASE("a prior pulls as a hundred equal trials would") {
    QuestPlusSpec spec = yes_no();
    const QuestPlus uniform(spec);
    CHECK(uniform.entropy() == Approx(std::log2(33.0 * 7.0 * 3.0)).epsilon(1e-12));
    spec.prior = {std::vector<double>(33, 0.0), {}, {}, {2.0, 1.0, 1.0}};
    spec.prior[0][8] = 3.0;
    const QuestPlus sure(spec);
    CHECK(sure.posterior().mean(spec.parameters)[0] == Approx(-2.0).epsilon(1e-12));
    CHECK(sure.posterior().mean(spec.parameters)[3] == Approx(0.015).epsilon(1e-12));
    CHECK(sure.estimates()[0].mode == -2.0);
    CHECK(sure.estimates().size() == 3);  // the guess rate is fixed
}

TEST_CASE("what QUEST+ cannot do is refused with the remedy") {
    QuestPlusSpec spec = yes_no();
    QuestPlus quest(spec);
    CHECK_THROWS_WITH(quest.update(std::vector<double>{0.1}, 1),
                      Has("stimulus is 0.1, which is none of its 25 values"));
    CHECK_THROWS_WITH(quest.update(std::vector<double>{0.0}, 2), Has("give 0 to 1"));
    CHECK_THROWS_WITH(quest.update(std::vector<double>{0.0, 1.0}, 1), Has("give 1"));
    CHECK_NOTHROW(quest.update(std::vector<double>{0.5 + 1e-10}, 1));

    spec.nuisance = {"slope"};
    CHECK_THROWS_WITH(QuestPlus(spec), Has("no parameter of the model"));
    spec.nuisance = {"threshold", "sd", "guess", "lapse"};
    CHECK_THROWS_WITH(QuestPlus(spec), Has("nuisance names every parameter"));
    spec = yes_no();
    spec.parameters = Grid({{"threshold", {0.0}}});
    CHECK_THROWS_WITH(QuestPlus(spec), Has("give threshold, sd, guess, lapse"));
    spec = yes_no();
    spec.parameters = Grid({{"threshold", evenly(-4, 4, 10001)},
                            {"sd", evenly(0.5, 3, 101)},
                            {"guess", {0.02}},
                            {"lapse", {0.02}}});
    CHECK_THROWS_WITH(QuestPlus(spec), Has("MB of tables"));
    CHECK_THROWS_WITH(Grid({{"a", evenly(0, 1, 5000)}, {"b", evenly(0, 1, 5000)}}),
                      Has("more than 10000000 cells"));
    CHECK_THROWS_WITH(Grid({{"a", {1.0, 1.0}}}), Has("each above the one before"));
    CHECK_THROWS_WITH(identification_model({1.0}), Has("at least two"));
}

TEST_CASE("a response that no parameter allows is refused and changes nothing") {
    QuestPlusSpec spec = yes_no();
    spec.parameters =
        Grid({{"threshold", {0.0, 1.0}}, {"sd", {0.001}}, {"guess", {0.0}}, {"lapse", {0.0}}});
    QuestPlus quest(spec);
    const std::string before = quest.state_hash();
    CHECK_THROWS_WITH(quest.update(std::vector<double>{-6.0}, 1),
                      Has("impossible under every parameter"));
    CHECK(quest.state_hash() == before);
}

TEST_CASE("psi is QUEST+ on a grid of log10 slopes") {
    const auto spec_with = [](SlopeAs as, const std::vector<double>& slopes) {
        const auto word = std::string(kSlopeWords.at(static_cast<std::size_t>(as)));
        return QuestPlusSpec{.model = psychometric_model(Family::logistic, LapseForm::upper, as),
                             .stimuli = Grid({{"stimulus", evenly(-3, 3, 13)}}),
                             .parameters = Grid({{"threshold", evenly(-2, 2, 17)},
                                                 {word, slopes},
                                                 {"guess", {0.5}},
                                                 {"lapse", {0.02}}})};
    };
    const std::vector<double> log10_slopes = evenly(-0.5, 1.0, 7);
    std::vector<double> slopes;
    for (const double s : log10_slopes) {
        slopes.push_back(std::pow(10.0, s));
    }
    const QuestPlusSpec plain = spec_with(SlopeAs::slope, slopes);
    Procedure a(spec_with(SlopeAs::log10_slope, log10_slopes), Pcg32(1, 1));
    Procedure b(plain, Pcg32(1, 1));
    Random random(5);
    for (int i = 0; i < 40; ++i) {
        CAPTURE(i);
        const std::vector<double> x = a.next();
        REQUIRE(b.next() == x);
        const std::size_t r =
            answer_of(plain.model, x, std::vector<double>{0.4, 2.0, 0.5, 0.02}, random);
        a.update(x, r);
        b.update(x, r);
        REQUIRE(a.entropy().value() == Approx(b.entropy().value()).epsilon(1e-10));
    }
    // Estimates: the mean of the logarithms, not the logarithm of the mean.
    CHECK(a.estimates()[1].name == "log10_slope");
    CHECK(std::pow(10.0, a.estimates()[1].mean.value()) < b.estimates()[1].mean.value());
}

TEST_CASE("a JND is said to end at the grid's end where its deviation does") {
    Random random(3);
    int cut = 0;
    for (int run = 0; run < 40; ++run) {
        QuestPlus quest(
            {.model = psychometric_model(Family::normal, LapseForm::two_sided, SlopeAs::sd),
             .stimuli = Grid({{"stimulus", evenly(-8.0, 8.0, 17)}}),
             .parameters = Grid({{"threshold", evenly(-4.0, 4.0, 23)},
                                 {"sd", evenly(1.1, 7.9, 9)},
                                 {"lapse", {0.02}}}),
             .trials = 200});
        const double sd = random.in(0.5, 12.0);
        for (int trial = 0; trial < 60; ++trial) {
            const std::vector<double> shown = quest.next();
            const double share = 0.5 * std::erfc(-shown[0] / (sd * std::sqrt(2.0)));
            quest.update(shown, random.in(0.0, 1.0) < share ? 1 : 0);
        }
        const Estimate of_sd = quest.estimates()[1];
        CAPTURE(run, sd, *of_sd.low, *of_sd.high);
        CHECK(quest.jnd()->cut == of_sd.cut);  // it is 0.67 deviations, whatever the threshold
        cut += of_sd.cut ? 1 : 0;
    }
    CAPTURE(cut);
    CHECK(cut >= 5);
    CHECK(cut <= 35);
}
