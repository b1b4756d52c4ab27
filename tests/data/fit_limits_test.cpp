#include <cmath>

#include "data/fit/bootstrap.hpp"
#include "tests/support/catch.hpp"

using namespace palpate::data;
using palpate::protocols::Family;

TEST_CASE("answers that bound nothing are told so, and a prior bounds them", "[fit]") {
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
    "samples lapse though the estimated rate is 0, and by their mean the estimate is corrected",
    "[fit]") {
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
        lapsing += point[3] > 0.0 ? 1 : 0;
        sum += point[1] - samples.from[1];
    }
    CHECK(lapsing > 100);
    // The slope is told by its logarithm, which is the second parameter.
    const double slope = corrected(spec, fit, samples, Quantity::slope).value();
    CHECK(std::log(slope) == Approx(fit.at[1] - sum / 400.0).epsilon(1e-12));
    CHECK(slope < quantity_of(spec, fit.at, Quantity::slope));
}

TEST_CASE("answers that are none are refused with value and remedy", "[fit]") {
    using Catch::Matchers::Contains;
    const std::vector<Level> good{{1, 10, 2}, {2, 10, 8}};
    const auto refused = [&](const std::vector<Level>& levels, const CurveSpec& spec,
                             const char* why) {
        CHECK_THROWS_WITH(CurveModel(levels, spec), Contains(why));
    };
    refused({}, {}, "no stimulus");
    refused({{1, 10, 2}, {1, 10, 3}}, {}, "two different stimuli");
    refused({{1, 10, 2}, {2, 10, 11}}, {}, "k is 11 of n = 10");
    refused({{NAN, 10, 2}, {2, 10, 1}}, {}, "finite");
    refused({{-1, 10, 2}, {2, 10, 1}}, {.family = Family::weibull}, "a Weibull begins at 0");
    refused({{0, 10, 2}, {2, 10, 1}}, {.family = Family::weibull}, "above 0");
    refused(good, {.guess = 0.8}, "guess rate is 0.8");
    refused(good, {.lapse = -0.1}, "lapse rate is -0.1");
    refused(good, {.slope_prior = Prior{-1, 1}}, "median of the slope");
    refused(good, {.lapse_prior = Prior{0.5, 1}}, "beta(0.5, 1)");
}
