#include "protocols/psychometric/exact_math.hpp"
#include "protocols/psychometric/psychometric_function.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate::protocols;

namespace {

constexpr std::array kFamilies{Family::weibull, Family::weibull_log10, Family::weibull_db,
                               Family::gumbel,  Family::normal,        Family::logistic};

double ulps(double got, double wanted) {
    const double step = std::nextafter(std::fabs(wanted), std::numeric_limits<double>::infinity()) -
                        std::fabs(wanted);
    return std::fabs(got - wanted) / step;
}

PsychometricFunction some_function(Random& random) {
    PsychometricFunction f;
    f.family = kFamilies[random.index(6)];
    f.form = static_cast<LapseForm>(random.below(3));
    f.threshold = f.family == Family::weibull ? random.decade(-2, 2) : random.in(-40.0, 40.0);
    f.slope = random.decade(-1, 1);
    f.guess = random.in(0.0, 0.5);
    f.lapse = random.in(0.0, 0.2);
    return f;
}

}  // namespace

TEST_CASE("the exponential is within 2 ulp of the true one") {
    Random random(1);
    double worst = 0.0;
    for (int i = 0; i < 200'000; ++i) {
        const double x = random.in(-700.0, 700.0) * (i % 2 == 0 ? 1.0 : 1e-3);
        worst = std::max(worst, ulps(exponential(x),
                                     static_cast<double>(std::exp(static_cast<long double>(x)))));
    }
    CHECK(worst <= 2.0);
    CHECK(exponential(0.0) == 1.0);
    CHECK(exponential(-800.0) == 0.0);
    CHECK(exponential(800.0) == HUGE_VAL);
    CHECK(std::isnan(exponential(NAN)));
}

TEST_CASE("the normal distribution has fourteen digits in both tails") {
    Random random(2);
    double worst = 0.0;
    for (int i = 0; i < 100'000; ++i) {
        const double z = random.in(-37.0, 8.0);
        const auto exact =
            static_cast<double>(0.5L * std::erfc(-static_cast<long double>(z) / std::sqrt(2.0L)));
        worst = std::max(worst, std::fabs(normal_cdf(z) - exact) / exact);
    }
    CAPTURE(worst * 1e15);
    CHECK(worst < 1e-14);
    // Abramowitz & Stegun, table 26.1.
    CHECK(normal_cdf(1.0) == Approx(0.841344746068543).epsilon(1e-15));
    CHECK(normal_cdf(-2.0) == Approx(0.022750131948179).epsilon(1e-13));
    CHECK(normal_cdf(0.0) == 0.5);
    CHECK(normal_cdf(-60.0) == 0.0);
    CHECK(normal_cdf(60.0) == 1.0);
}

TEST_CASE("the normal quantile undoes the normal distribution") {
    Random random(3);
    for (int i = 0; i < 20'000; ++i) {
        const double p = random.decade(-300.0, std::log10(0.5));
        CAPTURE(p);
        REQUIRE(normal_cdf(normal_quantile(p)) == Approx(p).epsilon(1e-12));
        REQUIRE(normal_quantile(1.0 - p) == -normal_quantile(1.0 - (1.0 - p)));
    }
    CHECK(normal_quantile(0.975) == Approx(1.959963984540054).epsilon(1e-15));  // A&S 26.2
    CHECK(normal_quantile(0.5) == 0.0);
    CHECK(normal_quantile(0.0) == -HUGE_VAL);
    CHECK(std::isnan(normal_quantile(1.5)));
}

TEST_CASE("every family has its known chances at threshold and one slope away") {
    const double e = std::exp(1.0);
    // At the threshold.
    for (const Family family :
         {Family::weibull, Family::weibull_log10, Family::weibull_db, Family::gumbel}) {
        CHECK(core(family, 3.0, 3.0, 2.5) == Approx(1.0 - 1.0 / e).epsilon(1e-14));
    }
    CHECK(core(Family::normal, 3.0, 3.0, 2.5) == 0.5);
    CHECK(core(Family::logistic, 3.0, 3.0, 2.5) == 0.5);
    // Closed forms elsewhere.
    CHECK(core(Family::weibull, 2.0, 1.0, 3.0) == Approx(1.0 - std::exp(-8.0)).epsilon(1e-14));
    CHECK(core(Family::weibull, -1.0, 1.0, 3.0) == 0.0);
    CHECK(core(Family::weibull_log10, 1.1, 1.0, 10.0) ==
          Approx(1.0 - std::exp(-10.0)).epsilon(1e-14));
    CHECK(core(Family::weibull_db, -12.0, -10.0, 5.0) ==
          Approx(1.0 - std::exp(-std::pow(10.0, -0.5))).epsilon(1e-14));
    CHECK(core(Family::gumbel, 2.0, 1.0, 1.0) == Approx(1.0 - std::exp(-e)).epsilon(1e-14));
    CHECK(core(Family::normal, 1.5, 1.0, 2.0) == Approx(0.841344746068543).epsilon(1e-14));
    CHECK(core(Family::logistic, 2.0, 1.0, std::log(3.0)) == Approx(0.75).epsilon(1e-14));
}

TEST_CASE("the three Weibull axes are one function") {
    Random random(4);
    for (int i = 0; i < 2000; ++i) {
        const double x = random.decade(-2.0, 2.0);
        const double t = random.decade(-1.0, 1.0);
        const double slope = random.in(0.5, 6.0);
        CAPTURE(x, t, slope);
        const double linear = core(Family::weibull, x, t, slope);
        REQUIRE(core(Family::weibull_log10, std::log10(x), std::log10(t), slope) ==
                Approx(linear).epsilon(1e-11));
        REQUIRE(core(Family::weibull_db, 20.0 * std::log10(x), 20.0 * std::log10(t), slope) ==
                Approx(linear).epsilon(1e-11));
        // Kingdom & Prins' base 10 against e.
        REQUIRE(core(Family::gumbel, x, t, slope * std::log(10.0)) ==
                Approx(core(Family::weibull_log10, x, t, slope)).epsilon(1e-11));
    }
}

TEST_CASE("the stimulus at the chance of a stimulus is that stimulus") {
    Random random(5);
    for (int i = 0; i < 5000; ++i) {
        const PsychometricFunction f = some_function(random);
        CAPTURE(i, static_cast<int>(f.family), static_cast<int>(f.form), f.threshold, f.slope);
        check(f);
        const double share = random.in(0.02, 0.98);
        const double p = bottom(f) + (top(f) - bottom(f)) * share;
        const double x = stimulus_at(f, p);
        REQUIRE(probability(f, x) == Approx(p).epsilon(1e-12));
        REQUIRE(stimulus_at(f, probability(f, x)) == Approx(x).epsilon(1e-9).margin(1e-9));
    }
}

TEST_CASE("a chance grows with the stimulus and stays between guess and lapse") {
    Random random(6);
    for (int i = 0; i < 2000; ++i) {
        const PsychometricFunction f = some_function(random);
        double before = bottom(f);
        for (double share = -3.0; share <= 3.0; share += 0.25) {
            const double x = f.family == Family::weibull ? f.threshold * std::pow(10.0, share)
                                                         : f.threshold + share * 20.0 / f.slope;
            const double p = probability(f, x);
            CAPTURE(i, x, p);
            REQUIRE(p >= before - 1e-15);
            REQUIRE(p <= top(f));
            before = p;
        }
        CHECK(probability(f, f.family == Family::weibull ? HUGE_VAL : 1e6) ==
              Approx(top(f)).epsilon(1e-15));
    }
}

TEST_CASE("the three forms of lapse frame the core as their formulas say") {
    PsychometricFunction f{.family = Family::normal, .slope = 1.0, .guess = 0.25, .lapse = 0.04};
    f.threshold = 0.0;
    CHECK(probability(f, 0.0) == Approx(0.25 + 0.71 * 0.5).epsilon(1e-15));
    f.form = LapseForm::two_sided;
    CHECK(probability(f, 0.0) == Approx(0.5).epsilon(1e-15));
    CHECK(probability(f, -50.0) == Approx(0.04).epsilon(1e-15));
    CHECK(probability(f, 50.0) == Approx(0.96).epsilon(1e-15));
    f.form = LapseForm::guessing;
    // Watson & Pelli 1983: delta gamma + (1 - delta) (1 - (1 - gamma) ...).
    CHECK(probability(f, 0.0) == Approx(0.04 * 0.25 + 0.96 * (1.0 - 0.75 * 0.5)).epsilon(1e-15));
    CHECK(top(f) == Approx(1.0 - 0.04 * 0.75).epsilon(1e-15));
}

TEST_CASE("a psychometric function that makes no sense is refused with the remedy") {
    CHECK_THROWS_WITH(check({.slope = 0.0}), Has("slope is 0: give"));
    CHECK_THROWS_WITH(check({.threshold = NAN}), Has("threshold is nan: give"));
    CHECK_THROWS_WITH(check({.family = Family::weibull, .threshold = -1.0}), Has("above 0"));
    CHECK_THROWS_WITH(check({.guess = 0.6, .lapse = 0.5}), Has("give smaller rates"));
    CHECK_THROWS_WITH(check({.guess = 1.0}), Has("from 0 to below 1"));
    CHECK_THROWS_WITH(stimulus_at({.guess = 0.5, .lapse = 0.02}, 0.4),
                      Has("never reached: give one above 0.5 and below 0.98"));
}
