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

}  // namespace

TEST_CASE(
    "an interval over people covers the mean share as often as it says, where pooled trials do not",
    "[analysis][people][law]") {
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

TEST_CASE("nothing is said of how people differ where one is known, or all are alike", "[people]") {
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

TEST_CASE("the sign-flip p is the share of all patterns of signs, counted one by one",
          "[people][law]") {
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

TEST_CASE("beyond 40 people the sign-flip p is drawn, and near that of a normal sum", "[people]") {
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
TEST_CASE("the interval of a difference of two shares agrees with the published values",
          "[golden]") {
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
