#include "engine/math/elementary.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;
using palpate::tests::Random;

namespace {

double ulps(double value, long double truth) {
    const double scale = std::fabs(static_cast<double>(truth));
    const double ulp = std::nextafter(scale, std::numeric_limits<double>::infinity()) - scale;
    return static_cast<double>(std::fabs(static_cast<long double>(value) - truth)) / ulp;
}

}  // namespace

// Origin of the expected values: the C library's long double functions (64-bit mantissa).
TEST_CASE("the exponential is within 2 ulp, less one within 4, the hyperbolic tangent within 3",
          "[math]") {
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

TEST_CASE("the exponential is exact at 0, 0 far below, and finite wherever one asks", "[math]") {
    CHECK(exponential(0.0) == 1.0);
    CHECK(exponential(-1e9) == 0.0);
    CHECK(exponential(-std::numeric_limits<double>::infinity()) == 0.0);
    CHECK(exponential(1e9) == exponential(700.0));
    CHECK(hyperbolic_tangent(0.0) == 0.0);
    CHECK(hyperbolic_tangent(1e300) == 1.0);
    CHECK(hyperbolic_tangent(-1e300) == -1.0);
}

TEST_CASE("powers are within 1e-13 of the true ones", "[math]") {
    Random random(22);
    for (int i = 0; i < 20'000; ++i) {
        const double base = random.decade(-6.0, 3.0);
        const double exponent = random.in(-3.0, 3.0);
        REQUIRE(power(base, exponent) == Approx(std::pow(base, exponent)).epsilon(1e-13));
    }
    CHECK(power(0.0, 2.0) == 0.0);
    CHECK(power(-1.0, 2.0) == 0.0);
}
