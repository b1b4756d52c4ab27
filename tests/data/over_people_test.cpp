#include <boost/math/distributions/non_central_t.hpp>

#include "data/statistics/information.hpp"
#include "data/statistics/paired.hpp"
#include "tests/support/catch.hpp"

using namespace palpate::data;

namespace {

double share_at(double logit) {
    return 1.0 / (1.0 + std::exp(-logit));
}

/// The mean share of people whose logits are normal, by Simpson's rule over 8 deviations to each
/// side.
double true_mean(double centre, double spread) {
    constexpr int kSteps = 1600;
    double sum = 0.0;
    for (int i = 0; i <= kSteps; ++i) {
        const double z = -8.0 + 16.0 * i / kSteps;
        const double weight = i == 0 || i == kSteps ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
        sum += weight * share_at(centre + spread * z) * std::exp(-0.5 * z * z);
    }
    return sum * 16.0 / kSteps / 3.0 / std::sqrt(2.0 * std::acos(-1.0));
}

bool holds(const Interval& interval, double value) {
    return interval.low <= value && value <= interval.high;
}

/// Extra hours of sleep of ten people, drug 1 less drug 2 (A. R. Cushny, A. R. Peebles, 1905): R's
/// data set `sleep`.
const std::vector<double> kSleep{-1.2, -2.4, -1.3, -1.3, 0.0, -1.0, -1.8, -0.8, -4.6, -1.4};

double probability_below(double z) {
    return 0.5 * std::erfc(-z / std::sqrt(2.0));
}

}  // namespace

TEST_CASE("a mean over people and its interval are the same to the bit in any order of people") {
    std::vector<double> shares{0.3, 0.35, 0.4, 0.6};  // 0.4125: half of the third decimal
    const PeopleMean share = mean_share_over_people(shares);
    const PeopleMean any = mean_over_people(shares);
    do {
        CHECK(mean_share_over_people(shares).mean == share.mean);
        CHECK(mean_share_over_people(shares).interval->low == share.interval->low);
        CHECK(mean_over_people(shares).mean == any.mean);
        CHECK(mean_over_people(shares).interval->high == any.interval->high);
    } while (std::ranges::next_permutation(shares).found);
}

TEST_CASE(
    "an interval over people covers the mean share as often as it says, where pooled trials do "
    "not") {
    constexpr int kSamples = 4000;
    constexpr int kPeople = 12;
    constexpr int kTrials = 50;
    const double spread = GENERATE(0.0, 0.5, 1.0);
    const double centre = GENERATE(0.0, 0.8);
    const double truth = true_mean(centre, spread);
    std::mt19937_64 random(20260301);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform;
    int covered = 0;
    int pooled = 0;
    int differences = 0;
    for (int sample = 0; sample < kSamples; ++sample) {
        std::vector<double> shares;
        std::vector<double> difference;
        std::int64_t all = 0;
        for (int person = 0; person < kPeople; ++person) {
            const double p = share_at(centre + spread * normal(random));
            int k[2] = {0, 0};
            for (int trial = 0; trial < 2 * kTrials; ++trial) {
                k[trial % 2] += uniform(random) < p ? 1 : 0;
            }
            shares.push_back(static_cast<double>(k[0]) / kTrials);
            difference.push_back(static_cast<double>(k[1] - k[0]) / kTrials);
            all += k[0];
        }
        covered += holds(mean_share_over_people(shares).interval.value(), truth) ? 1 : 0;
        differences += holds(mean_over_people(difference).interval.value(), 0.0) ? 1 : 0;
        pooled += holds(wilson(all, std::int64_t{kPeople} * kTrials), truth) ? 1 : 0;
    }
    CAPTURE(spread, centre, truth, covered, pooled, differences);
    CHECK(covered >= 0.93 * kSamples);
    CHECK(covered <= 0.97 * kSamples);
    CHECK(differences >= 0.93 * kSamples);
    CHECK(differences <= 0.97 * kSamples);
    if (spread == 0.5) {
        CHECK(std::fabs(pooled - 0.70 * kSamples) < 0.03 * kSamples);
    }
}

TEST_CASE("nothing is said of how people differ where one is known, or all are alike") {
    const auto share = [](std::vector<double> shares) {
        return mean_share_over_people(shares);
    };
    CHECK_FALSE(share({0.7}).interval);
    CHECK_FALSE(share({0.7, 0.7, 0.7}).interval);
    CHECK_FALSE(share({1.0, 1.0}).interval);
    const PeopleMean two = share({0.5, 0.9});
    CHECK(two.mean == Approx(0.7));
    CHECK(two.interval.value().low > 0.0);
    CHECK(two.interval.value().high < 1.0);
    CHECK(two.interval.value().low < 0.01);  // t of one degree of freedom is 12.7
}

TEST_CASE("the sign-flip p is the share of all patterns of signs, counted one by one") {
    SEED(40U);
    std::mt19937_64 random(seed);
    const auto n = 1 + static_cast<std::size_t>(random() % 12);
    std::vector<double> differences;
    for (std::size_t i = 0; i < n; ++i) {  // shares of 50: many sums are the same
        differences.push_back(static_cast<double>(static_cast<int>(random() % 21) - 8) / 50.0);
    }
    const auto sum_of = [&](std::uint64_t signs) {
        long sum = 0;
        for (std::size_t i = 0; i < n; ++i) {
            const long fiftieths = std::lround(differences[i] * 50.0);
            sum += (signs >> i & 1U) != 0 ? -fiftieths : fiftieths;
        }
        return std::labs(sum);
    };
    std::uint64_t reached = 0;
    for (std::uint64_t signs = 0; signs < std::uint64_t{1} << n; ++signs) {
        reached += sum_of(signs) >= sum_of(0) ? 1U : 0U;
    }
    const SignFlip test = sign_flip(differences);
    CHECK(test.exact);
    CHECK(test.p == static_cast<double>(reached) / std::ldexp(1.0, static_cast<int>(n)));
}

TEST_CASE("beyond 40 people the sign-flip p is drawn, and near that of a normal sum") {
    std::mt19937_64 random(5);
    std::normal_distribution<double> normal;
    std::vector<double> differences;
    double sum = 0.0;
    double square = 0.0;
    for (int i = 0; i < 60; ++i) {
        differences.push_back(normal(random) + 0.2);
        sum += differences.back();
        square += differences.back() * differences.back();
    }
    const SignFlip test = sign_flip(differences);
    CHECK_FALSE(test.exact);
    CHECK(test.p == Approx(std::erfc(std::fabs(sum) / std::sqrt(2.0 * square))).margin(0.005));
}

// R. G. Newcombe, "Interval estimation for the difference between independent proportions",
// Statistics in Medicine 17 (1998) 873, table II, method 10.
TEST_CASE("the interval of a difference of two shares agrees with the published values") {
    struct Published {
        std::int64_t k2, n2, k1, n1;
        double low, high;
    };
    for (const Published& p :
         {Published{56, 70, 48, 80, 0.0524, 0.3339}, Published{9, 10, 3, 10, 0.1705, 0.8090},
          Published{10, 10, 0, 10, 0.6075, 1.0}}) {
        const Interval ci = newcombe(p.k1, p.n1, p.k2, p.n2);
        CAPTURE(p.k2, p.k1, ci.low, ci.high);
        CHECK(std::fabs(ci.low - p.low) < 5.1e-5);
        CHECK(std::fabs(ci.high - p.high) < 5.1e-5);
    }
}

// R 4.2.2, t.test(extra ~ group, data = sleep, paired = TRUE); vignette of the package BayesFactor
// 0.9.12, ttestBF(x = diffScores): 17.25888, r = 0.707.
TEST_CASE("a paired t and its Bayes factor are those that R prints of Student's own data") {
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

TEST_CASE("what differs by rounding alone is no spread of people") {
    SEED(20U);
    std::mt19937 random(seed);
    std::uniform_int_distribution<int> tenths(0, 8);
    std::vector<double> differences;
    std::vector<double> shares;
    for (int person = 0; person < 12; ++person) {  // two tenths more, of everybody
        const int before = tenths(random);
        differences.push_back((before + 2) / 10.0 - before / 10.0);
        shares.push_back(0.5 + differences.back());
    }
    CHECK_FALSE(paired_t(differences));
    CHECK_FALSE(mean_over_people(differences).interval);
    CHECK_FALSE(mean_share_over_people(shares).interval);
    for (double& one : differences) {
        one -= 0.2;  // against another number than 0 only what they were says how large they are
    }
    CHECK_FALSE(paired_t(differences, 1.0));
    differences.front() += 1e-9;  // a spread that no rounding makes
    CHECK(paired_t(differences, 1.0));
    CHECK(difference_of(0.3, 0.1 + 0.2) == 0.0);
    CHECK(difference_of(1.0, 1.0 + 1e-9) > 0.0);
}

TEST_CASE("a Bayes factor is the noncentral t's density over the prior, by that of no effect") {
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
TEST_CASE("the signed-rank test agrees with a published one, and zeros are left out") {
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
    "the signed-rank p is the share of all patterns of signs, ties and all, counted one by one") {
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

TEST_CASE("beyond 300 people the signed-rank p is normal, and there near the exact one") {
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

TEST_CASE("d' and c of yes and no give back the rates with half an answer more") {
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
