#include "protocols/procedure/quest_plus.hpp"
#include "tests/protocols/simulated_answers.hpp"
#include "tests/support/catch.hpp"

using namespace palpate::protocols;

namespace {

/// The definition, written out: the posterior of every outcome, its entropy with libm's logarithm,
/// and the mean of these. `kept`: the axes whose marginal posterior counts.
std::vector<double> by_definition(const OutcomeModel& model,
                                  const Grid& stimuli,
                                  const Grid& parameters,
                                  std::span<const double> weights,
                                  const std::vector<std::size_t>& kept) {
    std::vector<double> expected;
    for (std::size_t x = 0; x < stimuli.size(); ++x) {
        double mean = 0.0;
        for (std::size_t r = 0; r < model.outcomes; ++r) {
            std::map<std::vector<double>, double> posterior;
            double chance = 0.0;
            for (std::size_t c = 0; c < parameters.size(); ++c) {
                const std::vector<double> s = parameters.point(c);
                std::vector<double> chances(model.outcomes);
                model.chances(stimuli.point(x), s, chances);
                std::vector<double> seen;
                for (const std::size_t k : kept) {
                    seen.push_back(s[k]);
                }
                posterior[seen] += weights[c] * chances[r];
                chance += weights[c] * chances[r];
            }
            double entropy = 0.0;
            for (const auto& [seen, joint] : posterior) {
                if (joint > 0.0) {
                    entropy -= joint / chance * std::log2(joint / chance);
                }
            }
            mean += chance * entropy;
        }
        expected.push_back(mean);
    }
    return expected;
}

/// A problem of a random kind and size.
QuestPlusSpec some_problem(Random& random) {
    QuestPlusSpec spec;
    const auto axis = [&](const std::string& name, double from, double to, int max) {
        return palpate::protocols::Axis{
            name, evenly(from, to, static_cast<std::size_t>(1 + random.below(max)))};
    };
    const auto form = static_cast<LapseForm>(random.below(3));
    const auto family = static_cast<Family>(1 + random.below(5));
    switch (random.below(3)) {
        case 0: {
            spec.model = psychometric_model(family, form);
            spec.stimuli = Grid({axis("stimulus", -3, 3, 9)});
            std::vector<palpate::protocols::Axis> axes{axis("threshold", -2, 2, 7),
                                                       axis("slope", 0.5, 3, 4)};
            if (form != LapseForm::two_sided) {
                axes.push_back(axis("guess", 0.1, 0.5, 3));
            }
            axes.push_back(axis("lapse", 0.0, 0.1, 3));
            spec.parameters = Grid(axes);
            break;
        }
        case 1: {
            spec.model = covariate_model(family, LapseForm::two_sided, SlopeAs::sd);
            spec.stimuli = Grid({axis("stimulus", -3, 3, 5), axis("covariate", 0, 1, 3)});
            spec.parameters = Grid({axis("threshold", -2, 2, 5), axis("tilt", -1, 1, 3),
                                    axis("sd", 0.5, 3, 3), axis("lapse", 0.01, 0.1, 2)});
            break;
        }
        default:
            spec.model = identification_model(evenly(-10, 10, 5));
            spec.stimuli = Grid({axis("stimulus", -10, 10, 8)});
            spec.parameters =
                Grid({axis("noise", 1, 8, 5), axis("bias", -3, 3, 5), axis("lapse", 0, 0.1, 3)});
    }
    return spec;
}

void check_same_entropies(const std::vector<double>& got, const std::vector<double>& wanted) {
    for (std::size_t x = 0; x < wanted.size(); ++x) {
        REQUIRE(got.at(x) == Approx(wanted[x]).epsilon(1e-12).margin(1e-12));
    }
}

std::vector<double> some_weights(std::size_t n, Random& random) {
    std::vector<double> weights(n);
    for (double& w : weights) {
        w = random.below(5) == 0 ? 0.0 : random.decade(-12, 0);
    }
    weights.front() += 1e-3;
    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    for (double& w : weights) {
        w /= sum;
    }
    return weights;
}

}  // namespace

TEST_CASE("expected entropy is what its definition says") {
    SEEDED(random, std::uint64_t{150});
    const QuestPlusSpec spec = some_problem(random);
    const LikelihoodTable table(spec.model, spec.stimuli, spec.parameters);
    const std::vector<double> weights = some_weights(spec.parameters.size(), random);
    std::vector<std::size_t> all(spec.parameters.dimensions());
    std::iota(all.begin(), all.end(), std::size_t{0});
    check_same_entropies(expected_entropies(table, weights),
                         by_definition(spec.model, spec.stimuli, spec.parameters, weights, all));
}

TEST_CASE("expected marginal entropy is what its definition says") {
    SEEDED(random, std::uint64_t{100}, 1000);
    QuestPlusSpec spec = some_problem(random);
    std::vector<std::size_t> kept{0};
    for (std::size_t k = 1; k < spec.parameters.dimensions(); ++k) {
        if (random.coin()) {
            spec.nuisance.push_back(spec.parameters.axis(k).name);
        } else {
            kept.push_back(k);
        }
    }
    const QuestPlus quest(spec);
    CAPTURE(seed, spec.nuisance);
    check_same_entropies(quest.expected(), by_definition(spec.model, spec.stimuli, spec.parameters,
                                                         quest.posterior().weights(), kept));
}

TEST_CASE("no stimulus is expected to raise the entropy") {
    SEEDED(random, std::uint64_t{150}, 2000);
    const QuestPlusSpec spec = some_problem(random);
    QuestPlus quest(spec);
    const std::vector<double> truth = spec.parameters.point(random.index(spec.parameters.size()));
    for (int trial = 0; trial < 10; ++trial) {
        CAPTURE(seed, trial);
        const std::vector<double> expected = quest.expected();
        for (const double entropy : expected) {
            REQUIRE(entropy <= quest.entropy() + 1e-12);
            REQUIRE(entropy >= -1e-12);
        }
        const std::vector<double> x = quest.next();
        // What is shown is within the tie of the least.
        REQUIRE(expected[spec.stimuli.cell_at(x)] <=
                *std::min_element(expected.begin(), expected.end()) +
                    1e-12 * std::max(1.0, quest.entropy()));
        quest.update(x, answer_of(spec.model, x, truth, random));
        const auto weights = quest.posterior().weights();
        REQUIRE(std::accumulate(weights.begin(), weights.end(), 0.0) == Approx(1.0).epsilon(1e-12));
    }
}

TEST_CASE("of stimuli that are equally good the first is shown") {
    CHECK(first_of_least(std::vector<double>{3.0, 2.0, 2.0, 2.5}) == 1);
    CHECK(first_of_least(std::vector<double>{2.0 + 1e-12, 2.0 - 0.5e-12, 3.0}) == 0);
    CHECK(first_of_least(std::vector<double>{2.0 + 1e-11, 2.0, 3.0}) == 1);
    // A problem that is its own mirror image: x and -x tell equally much, and the left one is
    // shown, whatever rounding makes of them.
    for (int n = 2; n < 40; ++n) {
        const auto points = static_cast<std::size_t>(2 * n);
        const QuestPlus quest({.model = psychometric_model(Family::logistic, LapseForm::two_sided),
                               .stimuli = Grid({{"stimulus", evenly(-5, 5, points)}}),
                               .parameters = Grid({{"threshold", evenly(-4, 4, points)},
                                                   {"slope", evenly(0.3, 2.0, 5)},
                                                   {"lapse", {0.01, 0.05}}})});
        CAPTURE(n);
        CHECK(quest.next()[0] < 0.0);
    }
}
