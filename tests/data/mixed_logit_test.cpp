#include "data/inference/mixed_logit.hpp"
#include "data/statistics/paired.hpp"
#include "tests/support/catch.hpp"

using namespace palpate::data;

namespace {

using People = std::vector<TwoCounts>;

double share_of(double logit) {
    return 1.0 / (1.0 + std::exp(-logit));
}

/// People whose logits and effects differ normally.
People drawn_people(std::mt19937_64& random,
                    std::size_t people,
                    int trials,
                    double effect,
                    double sd_intercept,
                    double sd_slope) {
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform;
    People all(people);
    for (TwoCounts& one : all) {
        const double logit = 0.6 + sd_intercept * normal(random);
        const double own = effect + sd_slope * normal(random);
        for (std::size_t c = 0; c < 2; ++c) {
            one.n[c] = trials;
            for (int i = 0; i < trials; ++i) {
                one.k[c] += uniform(random) < share_of(logit + (c == 1 ? own : 0.0)) ? 1.0 : 0.0;
            }
        }
    }
    return all;
}

/// -2 log-likelihood by a dense grid over both normal numbers: knows no maximum and no curvature.
double by_grid(const People& people, double b0, double b1, const std::array<double, 3>& l) {
    constexpr double kStep = 0.1;
    constexpr int kReach = 85;
    double sum = 0.0;
    for (const TwoCounts& one : people) {
        double chance = 0.0;
        for (int i = -kReach; i <= kReach; ++i) {
            for (int j = -kReach; j <= kReach; ++j) {
                const double u = kStep * i;
                const double v = kStep * j;
                const double p = share_of(b0 + l[0] * u);
                const double q = share_of(b0 + b1 + (l[0] + l[1]) * u + l[2] * v);
                chance += std::exp(-0.5 * (u * u + v * v)) * std::pow(p, one.k[0]) *
                          std::pow(1.0 - p, one.n[0] - one.k[0]) * std::pow(q, one.k[1]) *
                          std::pow(1.0 - q, one.n[1] - one.k[1]);
            }
        }
        sum += std::log(chance * kStep * kStep / (2.0 * std::acos(-1.0)));
    }
    return -2.0 * sum;
}

}  // namespace

TEST_CASE("n nodes of Gauss and Hermite integrate every power below 2 n exactly", "[inference]") {
    for (int n = 1; n <= 40; ++n) {
        const Nodes nodes = gauss_hermite(n);
        for (int power = 0; power < std::min(2 * n, 30); ++power) {
            double sum = 0.0;
            double size = 0.0;
            for (std::size_t i = 0; i < nodes.at.size(); ++i) {
                sum += nodes.weight[i] * std::pow(nodes.at[i], power);
                size += nodes.weight[i] * std::pow(std::fabs(nodes.at[i]), power);
            }
            const double wanted = power % 2 == 1 ? 0.0 : std::tgamma(0.5 * (power + 1));
            CAPTURE(n, power);
            REQUIRE(std::fabs(sum - wanted) <= 1e-10 * std::max(size, wanted));
        }
    }
}

TEST_CASE("the quadrature's likelihood is that of a dense grid, and Laplace's is near it",
          "[inference]") {
    SEED(6U);
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    const People people = drawn_people(random, 3, 20, -0.5, 0.8, 0.5);
    const double b0 = uniform(random);
    const double b1 = uniform(random);
    const std::array<double, 3> l{0.9 + 0.5 * uniform(random), 0.5 * uniform(random),
                                  0.6 + 0.5 * uniform(random)};
    const double wanted = by_grid(people, b0, b1, l);
    CHECK(std::fabs(mixed_deviance(people, b0, b1, l, gauss_hermite(25)) - wanted) < 1e-7);
    CHECK(std::fabs(mixed_deviance(people, b0, b1, l, gauss_hermite(15)) - wanted) < 1e-4);
    CHECK(std::fabs(mixed_deviance(people, b0, b1, l, gauss_hermite(1)) - wanted) < 0.3);
}

TEST_CASE("where people do not differ the likelihood is that of coins", "[inference]") {
    const auto seed = GENERATE(seeds(20U));
    std::mt19937_64 random(seed);
    const People people = drawn_people(random, 5, 30, 0.3, 0.5, 0.5);
    double wanted = 0.0;
    for (const TwoCounts& one : people) {
        for (std::size_t c = 0; c < 2; ++c) {
            const double p = share_of(0.2 + (c == 1 ? -0.7 : 0.0));
            wanted -= 2.0 * (one.k[c] * std::log(p) + (one.n[c] - one.k[c]) * std::log(1.0 - p));
        }
    }
    for (const int nodes : {1, 9}) {
        CHECK(mixed_deviance(people, 0.2, -0.7, {}, gauss_hermite(nodes)) ==
              Approx(wanted).epsilon(1e-13));
    }
}

TEST_CASE("a fit is the highest point around, and turning the conditions round turns its effect",
          "[inference]") {
    SEED(8U);
    std::mt19937_64 random(100 + seed);
    People people = drawn_people(random, 10, 40, -0.5, 0.7, 0.4);
    const MixedFit fit = fit_mixed(people, {});
    const Nodes laplace = gauss_hermite(1);
    CHECK(fit.converged);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 200; ++i) {
        const double far = 0.02 * (1 + i % 10);
        const double other = mixed_deviance(
            people, fit.intercept + far * normal(random), fit.effect + far * normal(random),
            {fit.l[0] + far * normal(random), fit.l[1] + far * normal(random),
             fit.l[2] + far * normal(random)},
            laplace);
        REQUIRE(-0.5 * other <= fit.log_likelihood + 1e-9);
    }
    for (TwoCounts& one : people) {
        std::swap(one.n[0], one.n[1]);
        std::swap(one.k[0], one.k[1]);
    }
    const MixedFit turned = fit_mixed(people, {});
    CHECK(turned.log_likelihood == Approx(fit.log_likelihood).epsilon(1e-10));
    CHECK(std::fabs(turned.effect + fit.effect) < 1e-5);
    CHECK(std::fabs(turned.intercept - fit.intercept - fit.effect) < 1e-5);
    CHECK(std::fabs(turned.sd_slope - fit.sd_slope) < 1e-4);
}

TEST_CASE("people who are all alike give a singular fit, and it says so", "[inference]") {
    const People alike(8, {.n = {40, 40}, .k = {30, 24}});
    const MixedFit fit = fit_mixed(alike, {});
    CHECK(fit.singular);
    CHECK(fit.intercept == Approx(std::log(3.0)).epsilon(1e-6));
    CHECK(fit.intercept + fit.effect == Approx(std::log(1.5)).epsilon(1e-6));
    CHECK(fit.sd_intercept < 1e-4);
    CHECK_FALSE(fit.correlation);
    CHECK_FALSE(fit.unbounded);
    const People sure(8, {.n = {40, 40}, .k = {30, 40}});
    CHECK(fit_mixed(sure, {}).unbounded);
    CHECK(slope_variance_p(2.0) ==
          Approx(0.5 * std::erfc(1.0) + 0.5 * std::exp(-1.0)).epsilon(1e-12));
}

TEST_CASE("the simulated p is the same again, and that of chi-square for many people",
          "[inference]") {
    std::mt19937_64 random(7);
    const People people = drawn_people(random, 20, 40, -0.2, 0.5, 0.3);
    const MixedFit full = fit_mixed(people, {});
    const MixedFit null = fit_mixed(people, {.effect = false});
    const double ratio = likelihood_ratio(full, null);
    const SimulatedNull one = simulate_null(people, null, ratio, 60, 3, 8);
    CHECK(simulate_null(people, null, ratio, 60, 3, 8).p == one.p);
    CHECK(one.p == Approx(chi_square_p(ratio, 1)).margin(0.2));
    CHECK(simulate_null(people, null, 1e9, 20, 3, 8).p == 1.0 / 21.0);
    CHECK(simulate_null(people, null, 0.0, 20, 3, 8).p == 1.0);
}

// PALPATE_NULL_STUDIES=10000 draws so many studies a spread; what then comes is in docs/data.md.
TEST_CASE("of studies without an effect every test within person finds one in about 5 %",
          "[inference]") {
    const char* asked = std::getenv("PALPATE_NULL_STUDIES");
    const int studies = asked != nullptr ? std::atoi(asked) : 100;
    const double spread = GENERATE(0.0, 0.4, 0.8);
    std::mt19937_64 random(11);
    int t = 0;
    int flip = 0;
    int rank = 0;
    int ratio = 0;
    int simulated = 0;
    constexpr int kSimulated = 400;
    for (int study = 0; study < studies; ++study) {
        const People people = drawn_people(random, 12, 50, 0.0, 0.6, spread);
        std::vector<double> differences;
        for (const TwoCounts& one : people) {
            differences.push_back(one.k[1] / one.n[1] - one.k[0] / one.n[0]);
        }
        t += paired_t(differences)->p < 0.05 ? 1 : 0;
        flip += sign_flip(differences).p < 0.05 ? 1 : 0;
        rank += signed_rank(differences).p < 0.05 ? 1 : 0;
        const MixedFit null = fit_mixed(people, {.effect = false, .errors = false});
        const MixedFit full = fit_mixed(people, {.errors = false}, &null);
        const double found = likelihood_ratio(full, null);
        ratio += chi_square_p(found, 1) < 0.05 ? 1 : 0;
        if (asked != nullptr && study < kSimulated) {
            simulated +=
                simulate_null(people, null, found, 199, 1, 1000U * static_cast<unsigned>(study))
                            .p <= 0.05
                    ? 1
                    : 0;
        }
    }
    const double error = std::sqrt(0.05 * 0.95 / studies);
    CAPTURE(spread, studies, t, flip, rank, ratio);
    if (asked != nullptr) {
        WARN("spread " << spread << ": t " << t << ", sign-flip " << flip << ", Wilcoxon " << rank
                       << ", likelihood ratio " << ratio << " of " << studies << "; simulated "
                       << simulated << " of " << kSimulated);
    }
    for (const int found : {t, flip, rank}) {
        CHECK(std::fabs(static_cast<double>(found) / studies - 0.05) < 0.005 + 3.0 * error);
    }
    // The ratio's chi-square is one for many people: with 12 it finds more.
    CHECK(static_cast<double>(ratio) / studies < 0.08 + 3.0 * error);
}
