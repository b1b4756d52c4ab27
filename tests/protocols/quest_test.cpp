#include "protocols/procedure/procedure.hpp"
#include "tests/protocols/published_traces.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate::protocols;

TEST_CASE("QUEST runs a published sequence") {
    // Intensities and estimates tabulated in PsychoPy's test of its QuestHandler, whose QUEST is A.
    // Straw's translation of D. Pelli's. Two right, two wrong, and again.
    Quest quest(
        {.guess = 50.0, .sd = 50.0, .range = 100.0, .lowest = 0.0, .highest = 100.0, .trials = 10});
    constexpr std::array kShown{50.0,
                                45.139710407074872,
                                37.291086503930742,
                                58.297413127139947,
                                80.182967131096547,
                                75.295251409003527,
                                71.57627192423783,
                                79.881680484036906,
                                90.712313302815517,
                                88.265808957695796};
    for (std::size_t i = 0; i < kShown.size(); ++i) {
        CAPTURE(i);
        const std::vector<double> x = i == 0 ? std::vector<double>{50.0} : quest.next();
        CHECK(x[0] == Approx(kShown[i]).margin(1e-5));
        quest.update(std::vector<double>{kShown[i]}, i % 4 < 2 ? 1 : 0);
    }
    CHECK(quest.mean() == Approx(86.0772169427).margin(1e-5));
    CHECK(quest.mode() == Approx(80.11).margin(1e-9));
    CHECK(quest.quantile(quest.quantile_order()) == Approx(86.3849031085).margin(1e-5));
    CHECK(quest.finished());
}

TEST_CASE("QUEST finds the threshold of a simulated observer") {
    // Watson & Pelli 1983 start two standard deviations of doubt away; 60 trials leave about .08
    // log10 units.
    const auto rule = static_cast<QuestRule>(GENERATE(0, 1, 2));
    const PsychometricFunction shape{.family = Family::weibull_log10,
                                     .form = LapseForm::guessing,
                                     .slope = 3.5,
                                     .guess = 0.5,
                                     .lapse = 0.01};
    const double offset =
        stimulus_at(shape, 0.82);  // of the .82 point from the function's own threshold
    double sum = 0.0;
    double square = 0.0;
    constexpr int kRuns = 200;
    for (int run = 0; run < kRuns; ++run) {
        Random random(static_cast<std::uint64_t>(run));
        const double threshold = random.in(-1.0, 1.0);
        PsychometricFunction observer = shape;
        observer.threshold = threshold - offset;
        Quest quest({.guess = 0.0, .sd = 2.0, .rule = rule, .trials = 60});
        while (!quest.finished()) {
            const std::vector<double> x = quest.next();
            quest.update(x, random.in(0, 1) < probability(observer, x[0]) ? 1 : 0);
        }
        const double error = quest.mean() - threshold;
        sum += error;
        square += error * error;
    }
    const double spread = std::sqrt(square / kRuns);
    CAPTURE(static_cast<int>(rule), sum / kRuns, spread);
    CHECK(spread < 0.12);
    CHECK(std::fabs(sum / kRuns) < 0.03);
}

TEST_CASE("QUEST's posterior is Bayes on a grid") {
    SEEDED(random, std::uint64_t{20});
    const QuestSpec spec{.guess = random.in(-2, 2),
                         .sd = random.in(0.3, 2),
                         .p_threshold = random.in(0.6, 0.9),
                         .beta = random.in(1, 5),
                         .delta = random.in(0.001, 0.05),
                         .gamma = random.in(0.01, 0.5),
                         .grain = 0.05,
                         .range = 4.0};
    Quest quest(spec);
    const PsychometricFunction f{.family = Family::weibull_log10,
                                 .form = LapseForm::guessing,
                                 .slope = spec.beta,
                                 .guess = spec.gamma,
                                 .lapse = spec.delta};
    // At the threshold the chance is p_threshold.
    const double offset = stimulus_at(f, spec.p_threshold);
    std::vector<double> weights;
    std::vector<double> cells;
    for (int i = -40; i <= 40; ++i) {
        cells.push_back(spec.guess + 0.05 * i);
        const double z = 0.05 * i / spec.sd;
        weights.push_back(std::exp(-0.5 * z * z));
    }
    for (int trial = 0; trial < 30; ++trial) {
        const double x = spec.guess + 0.05 * (random.below(81) - 40);
        const bool right = random.coin();
        quest.update(std::vector<double>{x}, right ? 1 : 0);
        for (std::size_t i = 0; i < cells.size(); ++i) {
            const double p = probability(f, x - cells[i] + offset);
            weights[i] *= right ? p : 1.0 - p;
        }
    }
    double sum = 0.0;
    double mean = 0.0;
    double entropy = 0.0;
    for (const double w : weights) {
        sum += w;
    }
    for (std::size_t i = 0; i < cells.size(); ++i) {
        mean += weights[i] / sum * cells[i];
        entropy -= weights[i] / sum * std::log2(weights[i] / sum);
    }
    CHECK(quest.mean() == Approx(mean).margin(1e-9));
    CHECK(quest.entropy() == Approx(entropy).epsilon(1e-9));
    CHECK(quest.quantile(0.0) <= quest.quantile(0.3));
    CHECK(quest.quantile(0.3) <= quest.quantile(1.0));
}

TEST_CASE("QUEST's quirks are those of its publication") {
    // Order of the quantile for gamma .5 and delta .01, from the formula in double precision by
    // hand: pL = .5, pH = .995.
    const Quest quest({});
    const double low = 0.5;
    const double high = 0.995;
    const auto h = [](double p) {
        return p * std::log(p) + (1.0 - p) * std::log(1.0 - p);
    };
    const double best = 1.0 / (1.0 + std::exp((h(high) - h(low)) / (low - high)));
    CHECK(quest.quantile_order() == Approx((best - low) / (high - low)).epsilon(1e-6));
    // A stimulus far outside is as one at the table's end; the shown one is rounded to the grain.
    Quest far({.grain = 0.1});
    Quest near({.grain = 0.1});
    far.update(std::vector<double>{1e8}, 1);
    near.update(std::vector<double>{5.0}, 1);
    CHECK(far.mean() == Approx(near.mean()).margin(1e-12));
    Quest a({.grain = 0.1});
    Quest b({.grain = 0.1});
    a.update(std::vector<double>{0.24}, 1);
    b.update(std::vector<double>{0.16}, 1);
    CHECK(a.state_hash() == b.state_hash());
    // The recommendation keeps its bounds.
    Quest bounded({.guess = 3.0, .lowest = -1.0, .highest = 1.0});
    CHECK(bounded.next()[0] == 1.0);
}

TEST_CASE("a QUEST that makes no sense is refused with the remedy") {
    CHECK_THROWS_WITH(Quest({.sd = 0.0}), Has("sd is 0: give"));
    CHECK_THROWS_WITH(Quest({.p_threshold = 0.4}), Has("p_threshold is 0.4: give"));
    CHECK_THROWS_WITH(Quest({.grain = 1e-9}), Has("larger grain"));
    CHECK_THROWS_WITH(Quest({.delta = 1.0}), Has("delta is 1: give"));
    CHECK_THROWS_WITH(Quest({.trials = 0}), Has("trials is 0"));
    Quest quest({});
    CHECK_THROWS_WITH(quest.update(std::vector<double>{NAN}, 1), Has("finite"));
    CHECK_THROWS_WITH(quest.update(std::vector<double>{0.0}, 3), Has("give 0 or 1"));
}

namespace {

std::vector<double> range(double from, double to, double step) {
    return evenly(from, to, static_cast<std::size_t>(std::lround((to - from) / step)) + 1);
}

QuestPlusSpec watson(std::vector<double> slopes, std::vector<double> lapses) {
    return {.model = psychometric_model(Family::weibull_db, LapseForm::upper),
            .stimuli = Grid({{"stimulus", range(-40, 0, 1)}}),
            .parameters = Grid({{"threshold", range(-40, 0, 1)},
                                {"slope", std::move(slopes)},
                                {"guess", {0.5}},
                                {"lapse", std::move(lapses)}}),
            .trials = 200};
}

/// Shows what was shown in a published run. @return the mode at its end
std::vector<double> mode_after(QuestPlus quest, const std::string& name) {
    const PublishedRun run = published_run(name);
    for (std::size_t i = 0; i < run.stimuli.size(); ++i) {
        CAPTURE(i);
        REQUIRE(quest.next() == run.stimuli[i]);
        quest.update(run.stimuli[i], run.answers[i] == '1' ? 1 : 0);
    }
    return quest.posterior().mode(quest.table().parameters());
}

}  // namespace

// The program itself runs his threshold, and his threshold, slope and lapse, in which two stimuli
// tie with others (procedure_command_test.cpp).
TEST_CASE("QUEST+ runs Watson's threshold and slope stimulus by stimulus") {
    CHECK(mode_after(QuestPlus(watson({2, 3, 4, 5}, {0.02})), "slope") ==
          std::vector<double>{-20.0, 3, 0.5, 0.02});
}

TEST_CASE("QUEST+ runs Watson's mean, deviation and lapse stimulus by stimulus") {
    const QuestPlus quest(
        {.model = psychometric_model(Family::normal, LapseForm::two_sided, SlopeAs::sd),
         .stimuli = Grid({{"stimulus", range(-10, 10, 1)}}),
         .parameters = Grid({{"threshold", range(-5, 5, 1)},
                             {"sd", range(1, 10, 1)},
                             {"lapse", {0, 0.01, 0.02, 0.03, 0.04}}}),
         .trials = 200});
    CHECK(mode_after(quest, "normal") == std::vector<double>{0.0, 4, 0.01});
}

TEST_CASE("QUEST+ runs Watson's contrast sensitivity in two stimulus dimensions") {
    OutcomeModel csf{
        .stimulus = {"contrast", "frequency"}, .parameters = {"least", "c0", "cf"}, .outcomes = 2};
    csf.chances = [](std::span<const double> x, std::span<const double> s, std::span<double> p) {
        p[1] = probability({.family = Family::weibull_db,
                            .threshold = std::max(s[0], s[1] + s[2] * x[1]),
                            .slope = 3.0,
                            .guess = 0.5,
                            .lapse = 0.01},
                           x[0]);
        p[0] = 1.0 - p[1];
    };
    const QuestPlus quest(
        {.model = csf,
         .stimuli = Grid({{"contrast", range(-50, 0, 2)}, {"frequency", range(0, 40, 2)}}),
         .parameters = Grid({{"least", range(-50, -30, 2)},
                             {"c0", range(-60, -40, 2)},
                             {"cf", range(0.8, 1.6, 0.2)}}),
         .trials = 200});
    const std::vector<double> mode = mode_after(quest, "csf");
    CHECK(mode[0] == -32.0);
    CHECK(mode[1] == -56.0);
    CHECK(mode[2] == Approx(1.4));
}
