#include <boost/math/distributions/non_central_t.hpp>
#include <boost/math/distributions/students_t.hpp>

#include "data/inference/mixed_logit.hpp"
#include "data/inference/power.hpp"
#include "data/statistics/paired.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate::data;
using protocols::PrimaryTest;

namespace {

constexpr double kTrials = 50.0;

/// People of one share without friction, who differ in what friction changes.
struct Closed {
    double share = 0.6;
    double change = -0.1;
    double spread = 0.05;

    [[nodiscard]] PowerPeople people(std::uint64_t seed = 1) const {
        return [*this, seed](std::size_t study, std::size_t number) {
            Random random(static_cast<std::uint32_t>(seed * 7'000'003 + study * 211 + number));
            double normal = -6.0;
            for (int i = 0; i < 12; ++i) {
                normal += random.in(0.0, 1.0);
            }
            const double with = share + change + spread * normal;
            PowerPerson one{.trials = kTrials, .expected = with - share};
            for (int i = 0; i < static_cast<int>(kTrials); ++i) {
                one.right_without += random.in(0.0, 1.0) < share ? 1.0 : 0.0;
                one.right_with += random.in(0.0, 1.0) < with ? 1.0 : 0.0;
            }
            return one;
        };
    }
    [[nodiscard]] double sd() const {
        const double with = share + change;
        return std::sqrt((share * (1.0 - share) + with * (1.0 - with) - spread * spread) / kTrials +
                         spread * spread);
    }
    /// Of the paired t of n people whose differences are normal.
    [[nodiscard]] double power(double n) const {
        const boost::math::non_central_t t(n - 1.0, std::fabs(change) / sd() * std::sqrt(n));
        const double far = boost::math::quantile(boost::math::students_t(n - 1.0), 0.975);
        return boost::math::cdf(complement(t, far)) + wrong(n);
    }
    /// Of it, with the wrong sign.
    [[nodiscard]] double wrong(double n) const {
        const boost::math::non_central_t t(n - 1.0, std::fabs(change) / sd() * std::sqrt(n));
        return boost::math::cdf(t, -boost::math::quantile(boost::math::students_t(n - 1.0), 0.975));
    }
};

}  // namespace

TEST_CASE("power of the paired t is that of the noncentral t where differences are nearly normal") {
    const double change = GENERATE(-0.12, -0.07, 0.1);
    const double spread = GENERATE(0.0, 0.08);
    const std::size_t people = GENERATE(8U, 16U);
    CAPTURE(change, spread, people);
    const Closed closed{.share = 0.6, .change = change, .spread = spread};
    PowerStudies studies({.studies = 1500}, closed.people());
    const PowerPoint point = studies.at(people);
    const double n = static_cast<double>(people);
    const double expected = closed.power(n);
    CHECK(point.power.value ==
          Approx(expected).margin(0.01 + 4.0 * std::sqrt(expected * (1.0 - expected) / 1500.0)));
    CHECK(point.estimate.value == Approx(change).margin(4.0 * point.estimate.se + 1e-3));
    CHECK(studies.truth() == Approx(change).margin(4.0 * spread / std::sqrt(1500.0 * n) + 1e-9));
    // Student's interval: 2 t c4 sd / sqrt(n), c4 the mean of a sample's sd by the true one.
    const double c4 =
        std::sqrt(2.0 / (n - 1.0)) * std::exp(std::lgamma(0.5 * n) - std::lgamma(0.5 * (n - 1.0)));
    const double t = boost::math::quantile(boost::math::students_t(n - 1.0), 0.975);
    CHECK(point.width.value == Approx(2.0 * t * c4 * closed.sd() / std::sqrt(n)).epsilon(0.02));
    REQUIRE(point.exaggeration);
    CHECK(point.exaggeration->value > 1.0 - 4.0 * point.exaggeration->se);
    if (expected < 0.6) {
        CHECK(point.exaggeration->value > 1.1);
    }
    const double wrong = closed.wrong(n) / expected;
    CHECK(
        point.wrong_sign.value().value ==
        Approx(wrong).margin(0.005 + 4.0 * std::sqrt(wrong * (1.0 - wrong) / (1500.0 * expected))));
}

TEST_CASE("without an effect each test is significant as often as it says") {
    const Closed none{.share = 0.6, .change = 0.0, .spread = 0.1};
    const auto test =
        GENERATE(PrimaryTest::paired_t, PrimaryTest::sign_flip, PrimaryTest::signed_rank);
    PowerStudies studies({.test = test, .studies = 3000}, none.people(5));
    const PowerPoint point = studies.at(12);
    CHECK(point.power.value == Approx(0.05).margin(4.0 * std::sqrt(0.05 * 0.95 / 3000.0)));
    CHECK_FALSE(point.exaggeration);
}

TEST_CASE("tests of power are those of stats, by another way") {
    SEEDED(random, 60U);
    const Closed closed{.change = random.in(-0.2, 0.2), .spread = 0.1};
    const PowerPeople draw = closed.people(seed);
    std::vector<PowerPerson> people;
    std::vector<double> differences;
    std::vector<TwoCounts> counts;
    for (std::size_t i = 0; i < 3 + seed % 12; ++i) {
        const PowerPerson one = draw(0, i);
        people.push_back(one);
        differences.push_back((one.right_with - one.right_without) / kTrials);
        counts.push_back({.n = {kTrials, kTrials}, .k = {one.right_without, one.right_with}});
    }
    CHECK(p_of(PrimaryTest::sign_flip, people) == Approx(sign_flip(differences).p).epsilon(1e-9));
    CHECK(p_of(PrimaryTest::signed_rank, people) == signed_rank(differences).p);
    CHECK(p_of(PrimaryTest::paired_t, people) == paired_t(differences)->p);
    if (seed % 10 == 0) {
        const double ratio =
            likelihood_ratio(fit_mixed(counts, {}), fit_mixed(counts, {.effect = false}));
        CHECK(p_of(PrimaryTest::mixed, people) == Approx(chi_square_p(ratio, 1)).margin(2e-3));
    }
}

TEST_CASE("any number of threads and any order of questions gives the same power") {
    const Closed closed{};
    PowerStudies one({.studies = 200, .threads = 1}, closed.people());
    PowerStudies three({.studies = 200, .threads = 3}, closed.people());
    static_cast<void>(one.at(20));
    static_cast<void>(three.at(20));
    CHECK(three.at(5) == one.at(5));
    CHECK(three.at(12) == one.at(12));
    const auto least = one.least(0.8, 100);
    REQUIRE(least.people);
    REQUIRE(least.low);
    REQUIRE(least.high);
    CHECK(three.least(0.8, 100) == least);
    CHECK(one.at(*least.people).power.value >= 0.8);
    CHECK(one.at(*least.people - 1).power.value < 0.8);
    CHECK(*least.low < *least.people);
    CHECK(*least.people < *least.high);
    const auto ends = [&](std::size_t people) {
        return wilson(std::llround(200.0 * one.at(people).power.value), 200);
    };
    CHECK(ends(*least.low).high >= 0.8);
    CHECK(ends(*least.low - 1).high < 0.8);
    CHECK(ends(*least.high).low >= 0.8);
    CHECK(ends(*least.high - 1).low < 0.8);
    CHECK(least.studies.value() > 200);
    CHECK_FALSE(one.least(0.999999, 8).people);
}
