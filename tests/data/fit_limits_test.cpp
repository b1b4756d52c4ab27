#include "data/fit/curve_fit.hpp"
#include "data/fit/fit_report.hpp"
#include "tests/data/highest.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate::data;
using palpate::protocols::Family;

namespace {

constexpr double kChiSquare95 = 3.841458820694124;  ///< of one degree of freedom

std::vector<Level> counted(double first, std::int64_t n, const std::vector<std::int64_t>& hits) {
    std::vector<Level> levels;
    for (const std::int64_t k : hits) {
        levels.push_back({first + static_cast<double>(levels.size()), n, k});
    }
    return levels;
}

/// What a curve may say that the fit does not, on a grid that knows nothing of it: no point is
/// higher than the fit, and all that the answers do not refute lies within the intervals.
void hold_against_grid(const CurveModel& model, const CurveFit& fit) {
    constexpr std::array kQuantities{Quantity::threshold, Quantity::slope, Quantity::jnd,
                                     Quantity::weber};
    std::array<std::optional<Interval>, kQuantities.size()> intervals{};
    for (std::size_t q = 0; q < kQuantities.size(); ++q) {
        intervals.at(q) = profile_interval(model, fit, kQuantities.at(q));
    }
    const double range = model.last() - model.first();
    std::array<Interval, kQuantities.size()> seen{};
    seen.fill({INFINITY, -INFINITY});
    double highest = -INFINITY;
    for (int row = 0; row <= 90; ++row) {
        const double log_slope =
            model.low()[1] + (model.high()[1] - model.low()[1]) * std::pow(row / 90.0, 0.5);
        for (int i = 0; i <= 330; ++i) {
            const CurvePoint at{model.first() + range * (i - 80.37) / 150.0, log_slope,
                                model.spec().guess, model.spec().lapse};
            const double value = model.value(at);
            highest = std::max(highest, value);
            if (2.0 * (fit.value - value) > kChiSquare95 - 1e-5) {
                continue;
            }
            for (std::size_t q = 0; q < kQuantities.size(); ++q) {
                const double here = quantity_of(model.spec(), at, kQuantities.at(q));
                if (!std::isnan(here)) {
                    seen.at(q).low = std::min(seen.at(q).low, here);
                    seen.at(q).high = std::max(seen.at(q).high, here);
                }
            }
        }
    }
    CHECK(highest < fit.value + 1e-7);
    for (std::size_t q = 0; q < kQuantities.size(); ++q) {
        CAPTURE(q, seen.at(q).low, seen.at(q).high);
        if (intervals.at(q)) {
            CHECK(intervals.at(q)->low <= seen.at(q).low + 1e-6 * std::fabs(seen.at(q).low));
            CHECK(intervals.at(q)->high >= seen.at(q).high - 1e-6 * std::fabs(seen.at(q).high));
        }
    }
}

}  // namespace

TEST_CASE(
    "no curve of a grid is higher than the fit, and none that is not refuted lies outside the "
    "intervals") {
    SECTION("answers with two maxima, or a slope without end") {
        struct Case {
            Family family;
            double guess;
            std::int64_t n;
            std::vector<std::int64_t> hits;
        };
        const Case one = GENERATE(Case{Family::weibull, 0.0, 20, {0, 7, 19, 20}},
                                  Case{Family::normal, 0.5, 20, {13, 15, 20}},
                                  Case{Family::logistic, 0.5, 20, {13, 14, 14, 20, 20, 19}},
                                  Case{Family::normal, 1.0 / 3.0, 30, {13, 21, 30}},
                                  Case{Family::normal, 1.0 / 3.0, 10, {4, 5, 10, 8, 10, 9}},
                                  Case{Family::normal, 0.0, 40, {0, 0, 40, 40}},
                                  Case{Family::gumbel, 1.0 / 3.0, 40, {10, 32, 39, 40, 39, 39, 38}},
                                  Case{Family::normal, 0.5, 26, {20, 23, 25, 26, 26, 25, 26}},
                                  Case{Family::logistic, 0.5, 13, {11, 12, 13}},
                                  Case{Family::weibull, 0.5, 40, {2, 8, 20, 31, 38}});
        CAPTURE(one.family, one.guess, one.hits);
        const CurveModel model(counted(1.0, one.n, one.hits),
                               {.family = one.family, .guess = one.guess, .lapse = 0.02});
        hold_against_grid(model, fit_curve(model));
    }
    SECTION("drawn answers") {
        SEEDED(random, 25U);
        const CurveSpec spec{
            .family =
                std::array{Family::weibull, Family::gumbel, Family::normal, Family::logistic}.at(
                    seed % 4),
            .guess = std::array{0.0, 0.5, 1.0 / 3.0}.at(seed % 3),
            .lapse = 0.02};
        const auto n = static_cast<std::int64_t>(random.in(8.0, 41.0));
        std::vector<std::int64_t> hits(static_cast<std::size_t>(random.in(3.0, 8.0)));
        const double middle = random.in(1.0, static_cast<double>(hits.size()));
        const double slope = random.decade(-1, 1);
        for (std::size_t i = 0; i < hits.size(); ++i) {
            const double away = slope * (static_cast<double>(i + 1) - middle);
            const double p = spec.guess + (0.98 - spec.guess) / (1.0 + std::exp(-away));
            for (std::int64_t answer = 0; answer < n; ++answer) {
                hits[i] += random.in(0.0, 1.0) < p ? 1 : 0;
            }
        }
        CAPTURE(spec.family, n, hits);
        const CurveModel model(counted(1.0, n, hits), spec);
        const CurveFit fit = fit_curve(model);
        if (!fit.shallow) {
            hold_against_grid(model, fit);
        }
    }
}

TEST_CASE(
    "at both ends of a Weber fraction's interval the answers refute it just so, wherever the "
    "levels begin") {
    EACH(first, 1.0, 11.0, 101.0, 1001.0);
    EACH(family, Family::normal, Family::logistic, Family::gumbel);
    const CurveSpec spec{.family = family, .lapse = 0.02};
    const CurveModel model(counted(first, 40, {2, 8, 20, 33, 38}), spec);
    const CurveFit fit = fit_curve(model);
    const Interval intervals = profile_interval(model, fit, Quantity::weber).value();
    const double jnd = 0.5 * (core_quantile(family, 0.75) - core_quantile(family, 0.25));
    for (const double weber : {intervals.low, intervals.high}) {
        double highest = -INFINITY;
        for (int i = 0; i <= 20000; ++i) {
            const double location = first - 0.9 + i * 4.0 / 20000.0;
            highest = std::max(
                highest, model.value({location, std::log(jnd / (weber * location)), 0.0, 0.02}));
        }
        CHECK(2.0 * (fit.value - highest) == Approx(kChiSquare95).margin(1e-3));
    }
    CHECK(intervals.low < quantity_of(spec, fit.at, Quantity::weber));
    CHECK(intervals.high > quantity_of(spec, fit.at, Quantity::weber));
}

/// Answers of a curve with a threshold of .5, an sd of .6 and 2 % of lapses at seven levels.
std::vector<Level> ordinary(Random& random, std::int64_t n) {
    std::vector<Level> levels;
    for (int i = 0; i < 7; ++i) {
        const double x = -1.5 + 4.0 * i / 6.0;
        const double share = 0.02 + 0.48 * std::erfc(-(x - 0.5) / (0.6 * std::sqrt(2.0)));
        std::int64_t k = 0;
        for (std::int64_t trial = 0; trial < n; ++trial) {
            k += random.in(0.0, 1.0) < share ? 1 : 0;
        }
        levels.push_back({x, n, k});
    }
    return levels;
}

/// The highest log-likelihood of a normal curve with guesses of .02, by steps that shrink.
double highest_normal(const std::vector<Level>& levels, bool lapse_free) {
    std::array<double, 3> at{0.5, std::log(0.6), 0.02};
    const auto value = [&] {
        double sum = 0.0;
        for (const Level& level : levels) {
            const double z = (level.stimulus - at[0]) * std::exp(-at[1]);
            const double p = 0.02 + (0.98 - at[2]) * 0.5 * std::erfc(-z / std::sqrt(2.0));
            sum += static_cast<double>(level.k) * std::log(p);
            sum +=
                level.k < level.n ? static_cast<double>(level.n - level.k) * std::log1p(-p) : 0.0;
        }
        return at[2] < 0.0 || at[2] > 0.25 ? -HUGE_VAL : sum;
    };
    std::vector<double*> free{&at[0], &at[1]};
    if (lapse_free) {
        free.push_back(&at[2]);
    }
    return highest_by_steps(value, free, 0.1, 1e-6, 1e-9);
}

TEST_CASE("the second optimiser confirms ordinary curves, which are the highest there is") {
    int fits = 0;
    int differ = 0;
    Random random(7);
    for (const Family family : {Family::gumbel, Family::normal, Family::logistic}) {
        for (int person = 0; person < 80; ++person) {
            const std::vector<Level> levels = ordinary(random, 100);
            for (const bool free : {false, true}) {
                const CurveSpec spec{
                    .family = family, .guess = 0.02, .lapse = 0.02, .lapse_free = free};
                const CurveFit fit = fit_curve(CurveModel(levels, spec));
                differ += fit.agree ? 0 : 1;
                ++fits;
                if (family == Family::normal && person < 30) {
                    const double own = highest_normal(levels, free);
                    CHECK(own < fit.value + 1e-6);
                    CHECK(own > fit.value - 1e-3);
                }
            }
        }
    }
    CAPTURE(fits, differ);
    CHECK(500 * differ <= fits);
}

TEST_CASE(
    "a climb that ends beside the maximum, and above all of the grid, is reported and mended") {
    Random random(GENERATE(range(1U, 11U)));
    const CurveSpec spec{.family = Family::normal, .guess = 0.02, .lapse_free = true};
    const CurveModel model(ordinary(random, 100), spec);
    const Highest found = highest(model, model.middle(), model.free(), Search::thorough);
    CHECK(checked_by_simplex(model, found).agree);
    Highest wrong = found;
    wrong.best.at[0] += random.in(0.005, 0.05);
    wrong.best.value = model.value(wrong.best.at);
    REQUIRE(wrong.best.value < found.best.value - 1e-5);
    const Checked checked = checked_by_simplex(model, wrong);
    CHECK_FALSE(checked.agree);
    CHECK(checked.second > wrong.best.value);
    CHECK(std::fabs(checked.best.value - found.best.value) < 1e-6);
    wrong.best = found.best;
    wrong.best.value += 1e-3;  // a value that no place has
    CHECK_FALSE(checked_by_simplex(model, wrong).agree);
}

TEST_CASE("the least between two places is found, however few numbers lie between them") {
    // Slopes of two steep curves may be one place but for the last bits: ln(60 / gap) of both.
    EACH(low, 1.791759469228054, -4.0, 1e-300, 3e10);
    EACH(numbers, range(0, 80));
    double high = low;
    for (int i = 0; i < numbers; ++i) {
        high = std::nextafter(high, INFINITY);
    }
    int asked = 0;
    const auto loss = [&](double place) {
        REQUIRE(++asked < 1000);
        REQUIRE(place >= low);
        REQUIRE(place <= high);
        return (place - low) * (place - low);
    };
    CHECK(least_between(loss, high, low) == 0.0);
}

TEST_CASE("the standard error of a place is the same wherever the stimulus has its origin") {
    const auto errors = [](double first, Family family) {
        const CurveSpec spec{.family = family, .lapse = 0.02};
        const CurveModel model(counted(first, 40, {2, 8, 20, 33, 38}), spec);
        const CurveFit fit = fit_curve(model);
        return std::array{standard_error(spec, fit, Quantity::threshold).value(),
                          standard_error(spec, fit, Quantity::at_share, 0.7).value(),
                          std::sqrt(fit.covariance[0][0])};
    };
    for (const Family family : {Family::normal, Family::logistic, Family::gumbel}) {
        const auto near = errors(1.0, family);
        CHECK(near[0] == Approx(near[2]).epsilon(1e-9));  // the threshold is a parameter
        for (const double far : {1e8, 1e11, 1e12}) {
            CAPTURE(far);
            CHECK(errors(far, family)[0] == Approx(near[0]).epsilon(1e-2));
            CHECK(errors(far, family)[1] == Approx(near[1]).epsilon(1e-2));
        }
    }
}

TEST_CASE("a difference has no bootstrap interval where one of its curves has none") {
    const Answers bounded{
        .participant = "P01", .condition = "off", .levels = counted(1.0, 40, {2, 8, 20, 33, 38})};
    Answers other{.participant = "P01",
                  .condition = "on",
                  .levels = counted(1.0, 40, {0, 0, 40, 40}),
                  .stream = 1};
    const auto differences = [&] {
        return fit_all("test", {bounded, other}, {.bootstrap = 100}).differences;
    };
    const std::vector<Difference> unbounded = differences();
    CHECK(std::isnan(unbounded.at(1).value));
    CHECK_FALSE(unbounded.at(1).interval);
    CHECK_FALSE(unbounded.at(0).interval);
    other.levels = counted(1.0, 40, {1, 6, 17, 31, 39});
    CHECK(differences().at(1).interval);
    CHECK(differences().at(0).interval);
}

TEST_CASE("answers that bound nothing are reported so, and a prior bounds them") {
    const std::vector<Level> perfect{{1, 10, 0}, {2, 10, 0}, {3, 10, 10}, {4, 10, 10}};
    CurveSpec spec{.family = GENERATE(Family::weibull, Family::weibull_log10, Family::weibull_db,
                                      Family::gumbel, Family::normal, Family::logistic)};
    CAPTURE(spec.family);
    const CurveModel model(perfect, spec);
    const CurveFit fit = fit_curve(model);
    CHECK(fit.steep);
    CHECK_FALSE(fit.shallow);
    CHECK(quantity_of(spec, fit.at, Quantity::threshold) > 2.0);
    CHECK(quantity_of(spec, fit.at, Quantity::threshold) < 3.0);
    const Interval slope = profile_interval(model, fit, Quantity::slope).value();
    CHECK(slope.low > 0.0);
    CHECK(std::isinf(slope.high));
    CHECK(profile_interval(model, fit, Quantity::jnd).value().low <= 1e-3);
    CHECK_FALSE(standard_error(spec, fit, Quantity::slope));

    const bool decibels = spec.family == Family::weibull_db;
    spec.slope_prior = Prior{decibels ? 40.0 : 2.0, 0.5};
    const CurveFit believed = fit_curve(CurveModel(perfect, spec));
    CHECK_FALSE(believed.steep);
    CHECK(quantity_of(spec, believed.at, Quantity::slope) < (decibels ? 400.0 : 20.0));

    const std::vector<Level> falling{{1, 10, 9}, {2, 10, 6}, {3, 10, 3}, {4, 10, 1}};
    CHECK(fit_curve(CurveModel(falling, {.family = spec.family})).shallow);
}

TEST_CASE(
    "samples lapse though the estimated rate is 0, and by their mean the estimate is corrected") {
    const std::vector<Level> levels{{1, 40, 2},  {2, 40, 6},  {3, 40, 14}, {4, 40, 22},
                                    {5, 40, 30}, {6, 40, 38}, {7, 40, 40}};
    CurveSpec spec{.lapse_free = true};
    const CurveModel model(levels, spec);
    const CurveFit fit = fit_curve(model);
    REQUIRE(fit.at[3] == 0.0);
    const Bootstrap samples = bootstrap(model, fit, 400, 1, 2);
    spec.lapse_prior = Prior{2.0, 20.0};
    const CurveFit believed = fit_curve(CurveModel(levels, spec));
    std::size_t lapsing = 0;
    for (std::size_t i = 0; i < kCurveParameters; ++i) {
        CHECK(samples.from.at(i) == Approx(believed.at.at(i)).margin(1e-5));
    }
    double sum = 0.0;
    for (const CurvePoint& point : samples.at) {
        lapsing += point[3] > 0.0 ? std::size_t{1} : 0;
        sum += point[1] - samples.from[1];
    }
    CHECK(lapsing > 100);
    // The slope is given by its logarithm, which is the second parameter.
    const double slope = corrected(spec, fit, samples, Quantity::slope).value();
    CHECK(std::log(slope) == Approx(fit.at[1] - sum / 400.0).epsilon(1e-12));
    CHECK(slope < quantity_of(spec, fit.at, Quantity::slope));
}

TEST_CASE("answers that are none are refused with value and remedy") {
    const std::vector<Level> good{{1, 10, 2}, {2, 10, 8}};
    const auto refused = [&](const std::vector<Level>& levels, const CurveSpec& spec,
                             const char* why) {
        CHECK_THROWS_WITH(CurveModel(levels, spec), Has(why));
    };
    refused({}, {}, "no stimulus");
    refused({{1, 10, 2}, {1, 10, 3}}, {}, "two different ones");
    refused({{1, 10, 2}, {2, 10, 11}}, {}, "k is 11 of n = 10");
    refused({{NAN, 10, 2}, {2, 10, 1}}, {}, "finite");
    refused({{1e308, 10, 2}, {-1e308, 10, 1}}, {}, "a stimulus is 1e+308");
    refused({{0, 10, 2}, {1e-308, 10, 1}}, {}, "1e-308 apart");
    refused({{-1, 10, 2}, {2, 10, 1}}, {.family = Family::weibull}, "a Weibull begins at 0");
    refused({{0, 10, 2}, {2, 10, 1}}, {.family = Family::weibull}, "above 0");
    refused(good, {.guess = 0.8}, "guess rate is 0.8");
    refused(good, {.lapse = -0.1}, "lapse rate is -0.1");
    refused(good, {.slope_prior = Prior{-1, 1}}, "median of the slope");
    refused(good, {.lapse_prior = Prior{0.5, 1}}, "beta(0.5, 1)");
}
