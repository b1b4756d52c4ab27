#include "protocols/procedure/procedure.hpp"
#include "tests/protocols/published_traces.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate::protocols;

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

/// Follows a published run. Where the published stimulus is as good as ours to 1e-12 bit, it is
/// shown in place of ours, and counted.
template <class Stimuli>
std::size_t follow(QuestPlus& quest, const Stimuli& stimuli, std::string_view answers) {
    REQUIRE(answers.size() == stimuli.size());
    std::size_t ties = 0;
    for (std::size_t i = 0; i < stimuli.size(); ++i) {
        const std::vector<double> published{static_cast<double>(stimuli[i])};
        const std::vector<double> ours = quest.next();
        CAPTURE(i, published, ours);
        if (ours != published) {
            const std::vector<double> expected = quest.expected();
            const Grid& grid = quest.table().stimuli();
            REQUIRE(std::fabs(expected[grid.cell_at(published)] - expected[grid.cell_at(ours)]) <=
                    1e-12 * std::max(1.0, quest.entropy()));
            ++ties;
        }
        quest.update(published, answers[i] == '1' ? 1 : 0);
    }
    return ties;
}

std::vector<double> mode_of(const QuestPlus& quest) {
    return quest.posterior().mode(quest.table().parameters());
}

}  // namespace

TEST_CASE("QUEST+ runs Watson's contrast threshold stimulus by stimulus", "[quest_plus][golden]") {
    QuestPlus quest(watson({3.5}, {0.02}));
    CHECK(follow(quest, kThresholdStimuli, kThresholdAnswers) == 0);
    CHECK(mode_of(quest) == std::vector<double>{-20.0, 3.5, 0.5, 0.02});
}

TEST_CASE("QUEST+ runs Watson's threshold and slope stimulus by stimulus", "[quest_plus][golden]") {
    QuestPlus quest(watson({2, 3, 4, 5}, {0.02}));
    CHECK(follow(quest, kSlopeStimuli, kSlopeAnswers) == 0);
    CHECK(mode_of(quest) == std::vector<double>{-20.0, 3, 0.5, 0.02});
}

TEST_CASE("QUEST+ runs Watson's threshold, slope and lapse stimulus by stimulus",
          "[quest_plus][golden]") {
    QuestPlus quest(watson({2, 3, 4, 5}, {0, 0.01, 0.02, 0.03, 0.04}));
    // Trials 94 and 95 show 0 dB: -3 dB is as good, every function having reached its top there.
    CHECK(follow(quest, kLapseStimuli, kLapseAnswers) == 2);
    CHECK(mode_of(quest) == std::vector<double>{-20.0, 5, 0.5, 0.04});
}

TEST_CASE("QUEST+ runs Watson's mean, deviation and lapse stimulus by stimulus",
          "[quest_plus][golden]") {
    QuestPlus quest({.model = psychometric_model(Family::normal, LapseForm::two_sided, SlopeAs::sd),
                     .stimuli = Grid({{"stimulus", range(-10, 10, 1)}}),
                     .parameters = Grid({{"threshold", range(-5, 5, 1)},
                                         {"sd", range(1, 10, 1)},
                                         {"lapse", {0, 0.01, 0.02, 0.03, 0.04}}}),
                     .trials = 200});
    CHECK(follow(quest, kNormalStimuli, kNormalAnswers) == 0);
    CHECK(mode_of(quest) == std::vector<double>{0.0, 4, 0.01});
}

TEST_CASE("QUEST+ runs Watson's contrast sensitivity in two stimulus dimensions",
          "[quest_plus][golden]") {
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
    QuestPlus quest(
        {.model = csf,
         .stimuli = Grid({{"contrast", range(-50, 0, 2)}, {"frequency", range(0, 40, 2)}}),
         .parameters = Grid({{"least", range(-50, -30, 2)},
                             {"c0", range(-60, -40, 2)},
                             {"cf", range(0.8, 1.6, 0.2)}}),
         .trials = 200});
    for (std::size_t i = 0; i < kCsfContrasts.size(); ++i) {
        CAPTURE(i);
        const std::vector<double> x = quest.next();
        REQUIRE(x == std::vector<double>{double(kCsfContrasts[i]), double(kCsfFrequencies[i])});
        quest.update(x, kCsfAnswers[i] == '1' ? 1 : 0);
    }
    const std::vector<double> mode = mode_of(quest);
    CHECK(mode[0] == -32.0);
    CHECK(mode[1] == -56.0);
    CHECK(mode[2] == Approx(1.4));
}
