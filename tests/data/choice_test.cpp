#include <boost/math/distributions/normal.hpp>

#include "data/choice/identification.hpp"
#include "tests/data/highest.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate::data;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

namespace {

double quantile(double p) {
    return boost::math::quantile(boost::math::normal(), p);
}

double below(double z) {
    return boost::math::cdf(boost::math::normal(), z);
}

/// An observer of five items.
struct Namer {
    double sigma = 2.6;
    double shift = 0.0;
    std::array<double, 4> criteria{-7.0, -2.0, 3.5, 7.0};

    [[nodiscard]] double share(double item, std::size_t j) const {
        const double high = j == 4 ? 1.0 : below((criteria.at(j) - item - shift) / sigma);
        const double low = j == 0 ? 0.0 : below((criteria.at(j - 1) - item - shift) / sigma);
        return 0.98 * (high - low) + 0.02 / 5.0;
    }
    [[nodiscard]] CallCounts answers(Random& random, int trials_an_item) const {
        CallCounts counts(5, std::vector<std::int64_t>(5, 0));
        for (std::size_t i = 0; i < 5; ++i) {
            for (int trial = 0; trial < trials_an_item; ++trial) {
                double left = random.in(0.0, 1.0);
                std::size_t j = 0;
                while (j < 4 && left >= share(kItems.at(i), j)) {
                    left -= share(kItems.at(i), j);
                    ++j;
                }
                ++counts[i][j];
            }
        }
        return counts;
    }
    /// What is expected of n answers an item, to the nearest whole.
    [[nodiscard]] CallCounts expected(double n) const {
        CallCounts counts(5, std::vector<std::int64_t>(5, 0));
        for (std::size_t i = 0; i < 5; ++i) {
            for (std::size_t j = 0; j < 5; ++j) {
                counts[i][j] = std::llround(n * share(kItems.at(i), j));
            }
        }
        return counts;
    }

    static constexpr std::array<double, 5> kItems{-10.0, -5.0, 0.0, 5.0, 10.0};
};

const std::vector<double> kFive(Namer::kItems.begin(), Namer::kItems.end());

/// The log-likelihood of the answers of two Namers with one set of criteria; a lapse of .02.
double log_likelihood(const std::vector<CallCounts>& both, const Namer& off, const Namer& on) {
    double sum = 0.0;
    for (std::size_t i = 0; i < 5; ++i) {
        for (std::size_t j = 0; j < 5; ++j) {
            for (const std::size_t f : {0U, 1U}) {
                const double n = static_cast<double>(both[f][i][j]);
                sum += n > 0.0 ? n * std::log((f == 0 ? off : on).share(kFive[i], j)) : 0.0;
            }
        }
    }
    return sum;
}

/// The highest near a place, by steps along one number at a time that shrink.
double highest_near(const std::vector<CallCounts>& both, Namer off, Namer on) {
    const std::vector<double*> all{&off.criteria[0], &off.criteria[1], &off.criteria[2],
                                   &off.criteria[3], &off.sigma,       &on.sigma,
                                   &on.shift};
    const auto value = [&] {
        on.criteria = off.criteria;
        const bool in_order = std::ranges::is_sorted(off.criteria);
        return in_order && off.sigma > 0.01 && on.sigma > 0.01 ? log_likelihood(both, off, on)
                                                               : -HUGE_VAL;
    };
    return highest_by_steps(value, all, 1.0, 1e-3, 1e-4);
}

}  // namespace

TEST_CASE("of two items and two answers the ordinal model is two quantiles") {
    Random random(GENERATE(range(1U, 40U)));
    const double near = random.in(-5.0, 5.0);
    const double far = near + random.in(0.5, 8.0);
    const std::int64_t n = 40;
    const std::int64_t k1 = 1 + random.below(30);
    const std::int64_t k2 = k1 + 1 + random.below(static_cast<int>(n - k1 - 1));
    const auto fit =
        data::fit_thurstone({{{n - k1, k1}, {n - k2, k2}}}, {.items = {near, far}, .lapse = 0.0});
    const double z1 = quantile(static_cast<double>(k1) / static_cast<double>(n));
    const double z2 = quantile(static_cast<double>(k2) / static_cast<double>(n));
    const double sigma = (far - near) / (z2 - z1);
    CHECK_THAT(fit.parts[0].sigma, WithinRel(sigma, 1e-5));
    CHECK_THAT(fit.criteria[0], WithinAbs(near - z1 * sigma, 1e-4 * sigma));
    CHECK_THAT(fit.deviance, WithinAbs(0.0, 1e-8));
    CHECK(fit.df == 0);
    CHECK(fit.agree);
}

TEST_CASE("sigma and shift of each condition come apart, and no share correct parts them") {
    Random random(GENERATE(range(1U, 12U)));
    const Namer off{.sigma = random.in(1.5, 5.0)};
    const Namer on{.sigma = random.in(1.5, 5.0), .shift = random.in(-3.0, 3.0)};
    const auto fit = data::fit_thurstone({off.expected(1e7), on.expected(1e7)}, {.items = kFive});
    CHECK_THAT(fit.parts[0].sigma, WithinRel(off.sigma, 1e-4));
    CHECK_THAT(fit.parts[1].sigma, WithinRel(on.sigma, 1e-4));
    CHECK_THAT(fit.parts[1].shift, WithinAbs(on.shift, 1e-3));
    CHECK(fit.parts[0].shift == 0.0);
    for (std::size_t j = 0; j < 4; ++j) {
        CHECK_THAT(fit.criteria[j], WithinAbs(off.criteria.at(j), 2e-3));
    }
    CHECK(fit.deviance < 1.0);
    CHECK(fit.df == 40 - 7);
}

TEST_CASE("no place has a higher likelihood than the fit, however few the answers") {
    Random random(GENERATE(range(1U, 31U)));
    Namer off{.sigma = random.in(2.0, 7.0)};
    for (double& one : off.criteria) {
        one += random.in(-2.0, 2.0);
    }
    std::ranges::sort(off.criteria);
    Namer on = off;
    on.sigma *= random.in(0.7, 1.4);
    on.shift = random.in(-2.0, 2.0);
    const std::vector<CallCounts> both{off.answers(random, 4), on.answers(random, 4)};
    const auto fit = data::fit_thurstone(both, {.items = kFive});
    for (const double sharper : {1.0, 0.15}) {
        Namer first = off;
        Namer second = on;
        second.sigma *= sharper;
        CHECK(highest_near(both, first, second) < fit.log_likelihood + 2e-3);
        std::swap(first.sigma, second.sigma);
        CHECK(highest_near(both, first, second) < fit.log_likelihood + 2e-3);
    }
    const auto ratios = data::fit_thurstone(both, {.items = kFive, .relative = true});
    CHECK_THAT(ratios.log_likelihood, WithinAbs(fit.log_likelihood, 0.02));
}

// SciPy's Nelder-Mead from 12 starts: -37.293 at criteria -6.2007, -2.4215, -1.3753 and 2.0343,
// sigmas 4.6742 and 0.5392 and a shift of -1.9627; with one sigma -40.5785, p .01036.
TEST_CASE("of a person with two hills the higher one is fitted, and p is that of SciPy") {
    const std::vector<CallCounts> both{
        {{2, 1, 1, 0, 0}, {0, 2, 1, 1, 0}, {0, 2, 1, 0, 1}, {0, 1, 0, 2, 1}, {0, 0, 0, 0, 4}},
        {{3, 0, 1, 0, 0}, {4, 0, 0, 0, 0}, {0, 1, 2, 1, 0}, {0, 0, 0, 0, 4}, {0, 0, 0, 0, 4}}};
    const Namer off{.sigma = 4.6742, .criteria = {-6.2007, -2.4215, -1.3753, 2.0343}};
    const Namer on{.sigma = 0.5392, .shift = -1.9627, .criteria = off.criteria};
    CHECK_THAT(log_likelihood(both, off, on), WithinAbs(-37.293, 1e-3));
    const auto fit = data::fit_thurstone(both, {.items = kFive});
    CHECK_THAT(fit.log_likelihood, WithinAbs(-37.293, 1e-3));
    CHECK(fit.agree);
    CHECK_THAT(fit.parts[0].sigma, WithinAbs(4.6742, 1e-3));
    CHECK_THAT(fit.parts[1].sigma, WithinAbs(0.5392, 1e-2));
    CHECK_THAT(fit.parts[1].shift, WithinAbs(-1.9627, 1e-2));
    const auto one = data::fit_thurstone(both, {.items = kFive, .one_sigma = 1});
    CHECK_THAT(data::chi_square_p(2.0 * (fit.log_likelihood - one.log_likelihood), 1),
               WithinAbs(0.01036, 1e-5));
}

TEST_CASE(
    "95 % intervals of sigma and shift hold the truth of people with 50 answers a condition") {
    const char* asked = std::getenv("PALPATE_CHOICE_PEOPLE");
    const int people = asked != nullptr ? std::atoi(asked) : 90;
    Random random(20);
    int sigma_holds = 0;
    int shift_holds = 0;
    int agree = 0;
    double error = 0.0;
    double error2 = 0.0;
    for (int i = 0; i < people; ++i) {
        const Namer off{.sigma = 2.6};
        const Namer on{.sigma = 3.4, .shift = 1.0};
        const auto fit = data::fit_thurstone({off.answers(random, 10), on.answers(random, 10)},
                                             {.items = kFive, .checked = i < 20});
        const auto& part = fit.parts[1];
        REQUIRE(part.sigma_interval);
        REQUIRE(part.shift_interval);
        sigma_holds += part.sigma_interval->low < on.sigma && on.sigma < part.sigma_interval->high;
        shift_holds += part.shift_interval->low < on.shift && on.shift < part.shift_interval->high;
        agree += i < 20 && fit.agree;
        const double of_log = std::log(part.sigma / on.sigma);
        error += of_log;
        error2 += of_log * of_log;
    }
    const double n = people;
    CAPTURE(sigma_holds, shift_holds, error / n, std::sqrt(error2 / n));
    // Of 90 people intervals that held .80 of the truth would be found out 19 times in 20.
    const double spare = 3.5 * std::sqrt(0.95 * 0.05 / n);
    CHECK_THAT(sigma_holds / n, WithinAbs(0.95, spare));
    CHECK_THAT(shift_holds / n, WithinAbs(0.95, spare));
    CHECK(agree == 20);
}

TEST_CASE("an answer that was never given, items that are never confused, and nonsense") {
    const auto fit = data::fit_thurstone({{{6, 0, 4, 0}, {2, 0, 6, 2}, {1, 0, 3, 6}, {0, 0, 1, 9}}},
                                         {.items = {0, 1, 2, 3}});
    CHECK(fit.criteria[0] == fit.criteria[1]);
    CHECK(fit.criteria[1] < fit.criteria[2]);
    const auto sharp =
        data::fit_thurstone({{{10, 0, 0}, {0, 10, 0}, {0, 0, 10}}}, {.items = {-1, 0, 1}});
    CHECK(sharp.parts[0].end == data::SigmaEnd::sharp);
    CHECK(sharp.parts[0].sigma_interval->low == 0.0);
    CHECK(sharp.parts[0].sigma_interval->high < 1.0);
    CHECK_THROWS_WITH(data::fit_thurstone({{{10, 0}, {10, 0}}}, {.items = {-1, 1}}),
                      Has("the same response"));
    CHECK_THROWS_WITH(data::fit_thurstone({{{10, 0}, {0, 10}}}, {.items = {1, 1}}), Has("1 and 1"));
}

TEST_CASE("of two items the similarity choice model is the table itself") {
    Random random(GENERATE(range(1U, 40U)));
    const auto count = [&] {
        return static_cast<std::int64_t>(1 + random.below(60));
    };
    const CallCounts n{{count(), count()}, {count(), count()}};
    const auto p = [&](std::size_t i, std::size_t j) {
        return static_cast<double>(n[i][j]) / static_cast<double>(n[i][0] + n[i][1]);
    };
    const auto fit = data::fit_similarity(n);
    CHECK_THAT(fit.similarity[0][1],
               WithinRel(std::sqrt(p(0, 1) * p(1, 0) / (p(0, 0) * p(1, 1))), 1e-7));
    CHECK_THAT(fit.bias[1] / fit.bias[0],
               WithinRel(std::sqrt(p(0, 1) * p(1, 1) / (p(0, 0) * p(1, 0))), 1e-7));
    CHECK_THAT(fit.deviance, WithinAbs(0.0, 1e-7));
}

TEST_CASE("similarities and biases of five items come back from the shares they make") {
    Random random(GENERATE(range(1U, 10U)));
    std::vector<double> bias;
    std::vector<std::vector<double>> similarity(5, std::vector<double>(5, 1.0));
    double total = 0.0;
    for (std::size_t i = 0; i < 5; ++i) {
        total += bias.emplace_back(random.in(0.3, 1.0));
        for (std::size_t j = 0; j < i; ++j) {
            similarity[i][j] = similarity[j][i] = random.in(0.05, 0.8);
        }
    }
    CallCounts counts(5, std::vector<std::int64_t>(5));
    for (std::size_t i = 0; i < 5; ++i) {
        double sum = 0.0;
        for (std::size_t j = 0; j < 5; ++j) {
            sum += bias[j] * similarity[i][j];
        }
        for (std::size_t j = 0; j < 5; ++j) {
            counts[i][j] = std::llround(1e6 * bias[j] * similarity[i][j] / sum);
        }
    }
    const auto fit = data::fit_similarity(counts);
    for (std::size_t i = 0; i < 5; ++i) {
        CHECK_THAT(fit.bias[i], WithinAbs(bias[i] / total, 1e-4));
        for (std::size_t j = 0; j < 5; ++j) {
            CHECK_THAT(fit.similarity[i][j], WithinAbs(similarity[i][j], 1e-4));
        }
    }
    CHECK(fit.residual < 1e-6);
    CHECK(fit.df == 6);
    CHECK_THROWS_WITH(data::fit_similarity({{1, 1}, {1, 0}}), Has("item 2"));
}

// R: the slopes of glm(cbind(k, n - k) ~ 1, binomial(probit), offset = slope * x), x = -2, 3, k = 9
// and 27 of 40, whose deviance is 3.8415 above that of the best; a slope is 1 / sigma.
TEST_CASE("of two items and two answers sigma's interval is that of R's profiled glm") {
    const auto fit =
        data::fit_thurstone({{{31, 9}, {13, 27}}}, {.items = {-2.0, 3.0}, .lapse = 0.0});
    const data::Interval& interval = fit.parts[0].sigma_interval.value();
    CHECK_THAT(interval.low, WithinRel(1.0 / 0.361878185, 1e-5));
    CHECK_THAT(interval.high, WithinRel(1.0 / 0.125357668, 1e-5));
}

TEST_CASE(
    "answers that do not follow the items leave sigma without an upper end, and p says the same") {
    Random random(GENERATE(range(1U, 13U)));
    CallCounts chance(5, std::vector<std::int64_t>(5, 0));
    for (auto& row : chance) {
        for (int trial = 0; trial < 10; ++trial) {
            ++row[random.index(5)];
        }
    }
    // No model tells fewer shares apart than one of the responses alone, which is that of an
    // infinite sigma.
    double flat = 0.0;
    for (std::size_t j = 0; j < 5; ++j) {
        double given = 0.0;
        for (const auto& row : chance) {
            given += static_cast<double>(row[j]);
        }
        flat += given > 0.0 ? given * std::log(given / 50.0) : 0.0;
    }
    const auto fit = data::fit_thurstone({chance}, {.items = kFive, .lapse = 0.0});
    const auto& part = fit.parts[0];
    CAPTURE(part.sigma, part.sigma_interval->low, fit.log_likelihood - flat);
    const bool follows = 2.0 * (fit.log_likelihood - flat) > 3.8414588;
    CHECK(std::isfinite(part.sigma_interval->high) == follows);
    CHECK(fit.log_likelihood > flat - 1e-4);
    if (fit.log_likelihood < flat + 1e-4) {
        CHECK(part.end == data::SigmaEnd::blunt);
    }
    if (part.end == data::SigmaEnd::blunt) {
        CHECK(fit.log_likelihood < flat + 2e-3);
    }
}

TEST_CASE(
    "a change of sigma has a p below .05 where its interval leaves out none, and so a shift") {
    Random random(GENERATE(range(1U, 12U)));
    const int n = 10;
    const Namer off{.sigma = random.in(1.0, 6.0)};
    const Namer on{.sigma = random.in(1.0, 6.0), .shift = random.in(-3.0, 3.0)};
    const std::vector<CallCounts> both{off.answers(random, n), on.answers(random, n)};
    const ThurstoneSpec relative{.items = kFive, .relative = true, .checked = false};
    const auto full = data::fit_thurstone(both, relative);
    const auto plain = data::fit_thurstone(both, {.items = kFive, .checked = false});
    CHECK_THAT(full.log_likelihood, WithinAbs(plain.log_likelihood, 1e-6));
    CHECK_THAT(full.parts[1].sigma, WithinRel(plain.parts[1].sigma, 1e-3));
    const auto outside = [](const data::Interval& one, double none) {
        return none < one.low || none > one.high;
    };
    const auto loss = [&](ThurstoneSpec less) {
        less.intervals = less.checked = false;
        return full.log_likelihood - data::fit_thurstone(both, less).log_likelihood;
    };
    const double of_sigma = loss({.items = kFive, .one_sigma = 1});
    const double of_shift = loss({.items = kFive, .no_shift = 1});
    CAPTURE(of_sigma, of_shift);
    CHECK(outside(full.parts[1].sigma_interval.value(), 1.0) == (of_sigma > 1.92072941));
    CHECK(outside(full.parts[1].shift_interval.value(), 0.0) == (of_shift > 1.92072941));
    CHECK(plain.parts[1].shift_interval->low ==
          Approx(full.parts[1].shift_interval->low).margin(1e-3));
}

TEST_CASE("a shift that its p does not refute lies in its interval") {
    // R (nlminb, 45 starts): log-likelihood -21.3014, -23.0166 without a shift, -23.2221 at -.14.
    const auto fit = data::fit_thurstone(
        {{{4, 0, 0, 0, 0}, {1, 3, 0, 0, 0}, {0, 2, 2, 0, 0}, {0, 0, 2, 2, 0}, {0, 0, 0, 3, 1}},
         {{4, 0, 0, 0, 0}, {0, 4, 0, 0, 0}, {0, 1, 2, 1, 0}, {0, 0, 1, 3, 0}, {0, 0, 0, 1, 3}}},
        {.items = kFive, .relative = true});
    CHECK_THAT(fit.parts[1].shift_loss, WithinAbs(23.0166 - 21.3014, 5e-4));
    CHECK_THAT(fit.parts[1].shift_interval->low, WithinAbs(-0.140, 3e-3));
}

// A pair's similarity is the root of an odds ratio of a table of two: of n of n against k of n its
// profile is known.
TEST_CASE(
    "intervals of similarities hold what the answers do not refute, and are open where they bound "
    "nothing") {
    const auto none = data::fit_similarity({{20, 0}, {0, 30}});
    CHECK(none.similarity[0][1] == 0.0);
    CHECK(none.intervals[0][1].low == 0.0);
    CHECK(none.one_way.empty());
    // P(1 | 1) P(2 | 2) = 1 / (1 + s r) 1 / (1 + s / r), the highest where r is that of equal
    // shares of 20 and 30.
    const double s = none.intervals[0][1].high;
    double best = -1e9;
    for (double r = 0.2; r < 5.0; r += 1e-4) {
        best = std::max(best, -20.0 * std::log1p(s * r) - 30.0 * std::log1p(s / r));
    }
    CHECK_THAT(best, WithinAbs(-1.92072941, 1e-5));

    const auto one_way = data::fit_similarity({{10, 0}, {3, 7}});
    CHECK(one_way.similarity[0][1] == 0.0);
    REQUIRE(one_way.one_way.size() == 1);
    CHECK(one_way.intervals[0][1].low == 0.0);
    const auto both = data::fit_similarity({{12, 8}, {6, 14}});
    CHECK(both.one_way.empty());
    CHECK(both.intervals[0][1].low > 0.1);
    CHECK(both.intervals[0][1].low < both.similarity[0][1]);
    CHECK(both.similarity[0][1] < both.intervals[0][1].high);
}
