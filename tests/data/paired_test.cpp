#include <boost/math/distributions/non_central_t.hpp>

#include "data/statistics/information.hpp"
#include "data/statistics/paired.hpp"
#include "tests/support/catch.hpp"

using namespace palpate::data;

namespace {

/// Extra hours of sleep of ten people, drug 1 less drug 2 (A. R. Cushny, A. R. Peebles, 1905): R's
/// data set `sleep`.
const std::vector<double> kSleep{-1.2, -2.4, -1.3, -1.3, 0.0, -1.0, -1.8, -0.8, -4.6, -1.4};

double probability_below(double z) {
    return 0.5 * std::erfc(-z / std::sqrt(2.0));
}

}  // namespace

// R 4.2.2, t.test(extra ~ group, data = sleep, paired = TRUE); vignette of the package BayesFactor
// 0.9.12, ttestBF(x = diffScores): 17.25888, r = 0.707.
TEST_CASE("a paired t and its Bayes factor are those that R prints of Student's own data",
          "[people][golden]") {
    const PairedT test = paired_t(kSleep).value();
    CHECK(std::fabs(test.t + 4.0621) < 5e-5);
    CHECK(test.df == 9.0);
    CHECK(std::fabs(test.p - 0.002833) < 5e-7);
    CHECK(std::fabs(test.interval.low + 2.4598858) < 5e-8);
    CHECK(std::fabs(test.interval.high + 0.7001142) < 5e-8);
    CHECK(test.mean == Approx(-1.58));
    CHECK(std::fabs(jzs_bayes_factor(test.t, kSleep.size()) - 17.25888) < 5e-6);
    CHECK_FALSE(paired_t(std::vector<double>{0.5}));
    CHECK_FALSE(paired_t(std::vector<double>{0.5, 0.5}));
    CHECK_FALSE(paired_t({}));
}

TEST_CASE("a Bayes factor is the noncentral t's density over the prior, by that of no effect",
          "[people][law]") {
    SEED(12U);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform;
    const auto n = 2 + static_cast<std::size_t>(30.0 * uniform(random));
    const double t = 8.0 * uniform(random) - 4.0;
    const double r = 0.3 + uniform(random);
    const auto df = static_cast<double>(n - 1);
    // effect = r tan(a): the Cauchy prior is uniform in a.
    constexpr int kSteps = 1500;
    double sum = 0.0;
    for (int i = 0; i < kSteps; ++i) {
        const double angle = std::acos(-1.0) * ((i + 0.5) / kSteps - 0.5);
        const double shift = r * std::tan(angle) * std::sqrt(static_cast<double>(n));
        sum += std::fabs(shift) > 37.0
                 ? 0.0
                 : boost::math::pdf(boost::math::non_central_t(df, shift), t) / kSteps;
    }
    const double none = boost::math::pdf(boost::math::students_t(df), t);
    CAPTURE(n, t, r);
    CHECK(jzs_bayes_factor(t, n, r) == Approx(sum / none).epsilon(1e-4));
    CHECK(jzs_bayes_factor(-t, n, r) == jzs_bayes_factor(t, n, r));
}

// M. Hollander, D. A. Wolfe, Nonparametric Statistical Methods, 1973, p. 29, depression scores; R's
// example of wilcox.test prints V = 40, p-value = 0.01953 of one side.
TEST_CASE("the signed-rank test agrees with a published one, and zeros are left out",
          "[people][golden]") {
    const std::vector<double> first{1.83, 0.50, 1.62, 2.48, 1.68, 1.88, 1.55, 3.06, 1.30};
    const std::vector<double> second{0.878, 0.647, 0.598, 2.05, 1.06, 1.29, 1.06, 3.14, 1.29};
    std::vector<double> differences;
    for (std::size_t i = 0; i < first.size(); ++i) {
        differences.push_back(first[i] - second[i]);
    }
    const SignedRank test = signed_rank(differences);
    CHECK(test.v == 40.0);
    CHECK(test.p == 2.0 * 10.0 / 512.0);
    differences.push_back(0.0);
    CHECK(signed_rank(differences).ranked == 9);
    CHECK(signed_rank(differences).p == test.p);
    CHECK(signed_rank(std::vector<double>{0.0, 0.0}).p == 1.0);
}

TEST_CASE(
    "the signed-rank p is the share of all patterns of signs, ties and all, counted one by one",
    "[people][law]") {
    SEED(60U);
    std::mt19937 random(seed);
    const auto n = 1 + static_cast<std::size_t>(random() % 11);
    std::vector<double> differences;
    std::vector<int> sizes;
    for (std::size_t i = 0; i < n; ++i) {  // small whole numbers: many ties and zeros
        const int size = static_cast<int>(random() % 9) - 4;
        differences.push_back(static_cast<double>(size) / 7.0 + (size > 0 ? 1e-16 : 0.0));
        if (size != 0) {
            sizes.push_back(size);
        }
    }
    std::vector<double> ranks;
    double all = 0.0;
    double v = 0.0;
    for (const int size : sizes) {  // the mean place among the sorted sizes
        double below = 0.0;
        double equal = 0.0;
        for (const int other : sizes) {
            below += std::abs(other) < std::abs(size) ? 1.0 : 0.0;
            equal += std::abs(other) == std::abs(size) ? 1.0 : 0.0;
        }
        ranks.push_back(below + 0.5 * (equal + 1.0));
        all += ranks.back();
        v += size > 0 ? ranks.back() : 0.0;
    }
    std::size_t reached = 0;
    for (std::size_t signs = 0; signs < std::size_t{1} << sizes.size(); ++signs) {
        double sum = 0.0;
        for (std::size_t i = 0; i < sizes.size(); ++i) {
            sum += (signs >> i & 1U) != 0 ? ranks[i] : 0.0;
        }
        reached += std::fabs(sum - 0.5 * all) >= std::fabs(v - 0.5 * all) ? 1U : 0U;
    }
    const SignedRank test = signed_rank(differences);
    CHECK(test.v == v);
    CHECK(test.ranked == sizes.size());
    CHECK(test.p == static_cast<double>(reached) / std::ldexp(1.0, static_cast<int>(sizes.size())));
}

TEST_CASE("beyond 300 people the signed-rank p is normal, and there near the exact one",
          "[people]") {
    std::mt19937 random(4);
    std::normal_distribution<double> normal(0.1, 1.0);
    std::vector<double> differences(300);
    std::ranges::generate(differences, [&] { return normal(random); });
    const SignedRank exact = signed_rank(differences);
    CHECK(exact.exact);
    differences.push_back(1e-6 * differences[0]);  // the least rank: 1
    const SignedRank drawn = signed_rank(differences);
    CHECK_FALSE(drawn.exact);
    CHECK(drawn.p == Approx(exact.p).epsilon(0.03));
}

TEST_CASE("d' and c of yes and no give back the rates with half an answer more", "[people][law]") {
    for (std::int64_t signals = 1; signals <= 12; ++signals) {
        for (std::int64_t hits = 0; hits <= signals; ++hits) {
            for (std::int64_t alarms = 0; alarms <= 7; ++alarms) {
                const YesNo both = yes_no(hits, signals, alarms, 7);
                const double hit = probability_below(0.5 * both.d_prime - both.criterion);
                const double alarm = probability_below(-0.5 * both.d_prime - both.criterion);
                REQUIRE(std::fabs(hit - (static_cast<double>(hits) + 0.5) /
                                            (static_cast<double>(signals) + 1.0)) < 1e-12);
                REQUIRE(std::fabs(alarm - (static_cast<double>(alarms) + 0.5) / 8.0) < 1e-12);
            }
        }
    }
}
