#include "engine/math/exponential.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "engine/math/elementary.hpp"

namespace palpate::engine {
namespace {

// ln 2 in two parts: n times part 1 is exact.
constexpr double kHigh = 0x1.62e42fee00000p-1;
constexpr double kLow = 0x1.a39ef35793c76p-33;
constexpr double kPerLn2 = 0x1.71547652b82fep+0;

/// A number as n ln 2 + r.
struct ReducedArgument {
    std::int64_t n = 0;
    double r = 0.0;
};

ReducedArgument reduced(double x) noexcept {
    const double n = std::floor(x * kPerLn2 + 0.5);
    return {static_cast<std::int64_t>(n), (x - n * kHigh) - n * kLow};
}

/// e^r - 1 for |r| <= ln 2 / 2; the first term left out is below 1e-18 of the result.
double small(double r) noexcept {
    double p = 1.0 / 87178291200.0;  // 1/14!
    p = p * r + 1.0 / 6227020800.0;
    p = p * r + 1.0 / 479001600.0;
    p = p * r + 1.0 / 39916800.0;
    p = p * r + 1.0 / 3628800.0;
    p = p * r + 1.0 / 362880.0;
    p = p * r + 1.0 / 40320.0;
    p = p * r + 1.0 / 5040.0;
    p = p * r + 1.0 / 720.0;
    p = p * r + 1.0 / 120.0;
    p = p * r + 1.0 / 24.0;
    p = p * r + 1.0 / 6.0;
    p = p * r + 0.5;
    return r + r * r * p;
}

/// 2^n for -1022 <= n <= 1023.
double two_to(std::int64_t n) noexcept {
    return std::bit_cast<double>(static_cast<std::uint64_t>(n + 1023) << 52U);
}

}  // namespace

double exponential(double x) noexcept {
    if (x < -708.0) {
        return 0.0;
    }
    const ReducedArgument parts = reduced(x < 700.0 ? x : 700.0);
    return (1.0 + small(parts.r)) * two_to(parts.n);
}

double exponential_less_one(double x) noexcept {
    if (-0.34 < x && x < 0.34) {
        return small(x);
    }
    return exponential(x) - 1.0;
}

double hyperbolic_tangent(double x) noexcept {
    const double e = exponential_less_one(-2.0 * std::fabs(x));
    const double tangent = -e / (2.0 + e);
    return x < 0.0 ? -tangent : tangent;
}

double power(double base, double exponent) noexcept {
    return base >= std::numeric_limits<double>::min() ? exponential(exponent * natural_log(base))
                                                      : 0.0;
}

}  // namespace palpate::engine
