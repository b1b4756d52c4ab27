#include "engine/math/elementary.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

namespace {

/// Error in ulp of the true value, or of 1 when `floor_at_one` (near a zero of sine or cosine).
double ulps(double value, long double truth, double smallest = 0.0) {
    const double scale = std::max(std::fabs(static_cast<double>(truth)), smallest);
    const double ulp = std::nextafter(scale, std::numeric_limits<double>::infinity()) - scale;
    return static_cast<double>(std::fabs(static_cast<long double>(value) - truth)) / ulp;
}

/// The largest of so many errors.
double worst_of(int count, const std::function<double(int)>& error) {
    double worst = 0.0;
    for (int i = 0; i < count; ++i) {
        worst = std::max(worst, error(i));
    }
    return worst;
}

}  // namespace

// Origin of the expected values: the C library's long double functions (64-bit mantissa).
TEST_CASE("sine and cosine are within 2 ulp, or 2.3e-16 near their zeros") {
    Random random(11);
    CHECK(worst_of(1'000'000, [&](int i) {
              const double x = i % 2 == 0 ? random.in(-7.0, 7.0) : random.in(-1e5, 1e5);
              const SinCos both = sin_cos(x);
              return std::max(ulps(both.sin, std::sin(static_cast<long double>(x)), 0.5),
                              ulps(both.cos, std::cos(static_cast<long double>(x)), 0.5));
          }) <= 2.0);
}

TEST_CASE("the arctangent of two sides is within 2 ulp in all quadrants") {
    Random random(12);
    CHECK(worst_of(1'000'000, [&](int /*i*/) {
              const double x = random.in(-1.0, 1.0) * random.decade(-3.0, 3.0);
              const double y = random.in(-1.0, 1.0) * random.decade(-3.0, 3.0);
              return ulps(arc_tan2(y, x),
                          std::atan2(static_cast<long double>(y), static_cast<long double>(x)));
          }) <= 2.0);
    CHECK(arc_tan2(0.0, 0.0) == 0.0);
    CHECK(arc_tan2(0.0, -1.0) == kPi);
    CHECK(arc_tan2(1.0, 0.0) == kPi / 2);
    CHECK(arc_tan2(-1.0, 0.0) == -kPi / 2);
}

TEST_CASE("the arccosine is within 4e-16 and clamps what rounding put outside") {
    Random random(13);
    CHECK(worst_of(200'000, [&](int /*i*/) {
              const double c = random.in(-1.0, 1.0);
              return std::fabs(arc_cos(c) -
                               static_cast<double>(std::acos(static_cast<long double>(c))));
          }) <= 4.5e-16);
    CHECK(arc_cos(1.0 + 1e-15) == 0.0);
    CHECK(arc_cos(-1.0 - 1e-15) == kPi);
}

TEST_CASE("the logarithm is within 2 ulp over 600 decades") {
    Random random(14);
    CHECK(worst_of(500'000, [&](int i) {
              const double x = i % 2 == 0 ? random.decade(-300.0, 300.0) : random.in(0.5, 2.0);
              return ulps(natural_log(x), std::log(static_cast<long double>(x)), 1e-3);
          }) <= 2.0);
    CHECK(natural_log(1.0) == 0.0);
}

TEST_CASE("sine and cosine of what is not finite are NaN") {
    CHECK(std::isnan(sin_cos(std::numeric_limits<double>::infinity()).sin));
    CHECK(std::isnan(sin_cos(std::numeric_limits<double>::quiet_NaN()).cos));
}

TEST_CASE("sine and cosine of everything finite lie within the unit circle") {
    Random random(15);
    for (int i = 0; i < 200'000; ++i) {
        const double x = (random.coin() ? 1.0 : -1.0) * random.decade(-300.0, 308.0);
        const SinCos both = sin_cos(x);
        REQUIRE(std::fabs(both.sin * both.sin + both.cos * both.cos - 1.0) <= 1e-6);
    }
}

TEST_CASE("the angle of what is not finite is NaN") {
    const double inf = std::numeric_limits<double>::infinity();
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double bad : {inf, -inf, nan}) {
        CHECK(std::isnan(arc_tan2(bad, 1.0)));
        CHECK(std::isnan(arc_tan2(1.0, bad)));
        CHECK(std::isnan(arc_tan2(bad, bad)));
    }
    CHECK(std::isnan(arc_cos(nan)));
}

TEST_CASE("the exponential is within 2 ulp, less one within 4, the hyperbolic tangent within 3") {
    Random random(21);
    double worst_exp = 0.0;
    double worst_less = 0.0;
    double worst_tanh = 0.0;
    for (int i = 0; i < 100'000; ++i) {
        const double x = i % 2 == 0 ? random.in(-690.0, 690.0) : random.in(-2.0, 2.0);
        const double y = (random.coin() ? 1.0 : -1.0) * random.decade(-12.0, 1.3);
        worst_exp =
            std::max(worst_exp, ulps(exponential(x), std::exp(static_cast<long double>(x))));
        worst_less = std::max(
            worst_less, ulps(exponential_less_one(y), std::expm1(static_cast<long double>(y))));
        worst_tanh = std::max(worst_tanh,
                              ulps(hyperbolic_tangent(y), std::tanh(static_cast<long double>(y))));
    }
    CHECK(worst_exp <= 2.0);
    CHECK(worst_less <= 4.0);
    CHECK(worst_tanh <= 3.0);
}

TEST_CASE("the exponential is exact at 0, 0 far below, and finite wherever one asks") {
    CHECK(exponential(0.0) == 1.0);
    CHECK(exponential(-1e9) == 0.0);
    CHECK(exponential(-std::numeric_limits<double>::infinity()) == 0.0);
    CHECK(exponential(1e9) == exponential(700.0));
    CHECK(hyperbolic_tangent(0.0) == 0.0);
    CHECK(hyperbolic_tangent(1e300) == 1.0);
    CHECK(hyperbolic_tangent(-1e300) == -1.0);
}

TEST_CASE("powers are within 1e-13 of the true ones") {
    Random random(22);
    for (int i = 0; i < 20'000; ++i) {
        const double base = random.decade(-6.0, 3.0);
        const double exponent = random.in(-3.0, 3.0);
        REQUIRE(power(base, exponent) == Approx(std::pow(base, exponent)).epsilon(1e-13));
    }
    CHECK(power(0.0, 2.0) == 0.0);
    CHECK(power(-1.0, 2.0) == 0.0);
}
