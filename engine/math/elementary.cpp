#include "engine/math/elementary.hpp"

#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>

namespace palpate::engine {
namespace {

// ln 2 in two parts: exponent * part 1 is exact.
constexpr double kLn2Hi = 0x1.62e42fee00000p-1;
constexpr double kLn2Lo = 0x1.a39ef35793c76p-33;

/// 1/19 to 1/3.
constexpr std::array<double, 9> kInverseOdds{1.0 / 19.0, 1.0 / 17.0, 1.0 / 15.0,
                                             1.0 / 13.0, 1.0 / 11.0, 1.0 / 9.0,
                                             1.0 / 7.0,  1.0 / 5.0,  1.0 / 3.0};

/// Beyond kMaxQuarters: the remainder is exact, 2 pi is not.
SinCos far_sin_cos(double x) noexcept {
    if (!std::isfinite(x)) {
        const double nan = std::numeric_limits<double>::quiet_NaN();
        return {nan, nan};
    }
    return sin_cos(std::fmod(x, 2.0 * kPi));
}

// atan(k/8), k = 0..8, rounded from 50 digits.
constexpr std::array<double, 9> kAtanEighths{0.0,
                                             0.12435499454676144,
                                             0.24497866312686414,
                                             0.35877067027057225,
                                             0.4636476090008061,
                                             0.5585993153435624,
                                             0.6435011087932844,
                                             0.7188299996216245,
                                             0.7853981633974483};

/// atan z for 0 <= z <= 1.
double atan_unit(double z) noexcept {
    const double eighths = std::floor(8.0 * z + 0.5);
    const double c = eighths * 0.125;
    const double t = (z - c) / (1.0 + z * c);
    const double s = t * t;
    double p = 1.0 / 13.0;
    p = 1.0 / 11.0 - p * s;
    p = 1.0 / 9.0 - p * s;
    p = 1.0 / 7.0 - p * s;
    p = 1.0 / 5.0 - p * s;
    p = 1.0 / 3.0 - p * s;
    return kAtanEighths[static_cast<std::size_t>(eighths)] + (t - t * s * p);
}

constexpr double kPerLn2 = 0x1.71547652b82fep+0;

/// A number as n ln 2 + r.
struct ReducedArgument {
    std::int64_t n = 0;
    double r = 0.0;
};

ReducedArgument reduced(double x) noexcept {
    const double n = std::floor(x * kPerLn2 + 0.5);
    return {static_cast<std::int64_t>(n), (x - n * kLn2Hi) - n * kLn2Lo};
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

SinCos sin_cos(double x) noexcept {
    return std::fabs(quarters_of(x)) < kMaxQuarters ? near_sin_cos(x) : far_sin_cos(x);
}

double arc_tan2(double y, double x) noexcept {
    if (!std::isfinite(x) || !std::isfinite(y)) {
        return std::numeric_limits<double>::quiet_NaN();
    }
    const double ax = std::fabs(x);
    const double ay = std::fabs(y);
    if (ax == 0.0 && ay == 0.0) {
        return 0.0;
    }
    double angle = ay <= ax ? atan_unit(ay / ax) : 0.5 * kPi - atan_unit(ax / ay);
    if (x < 0.0) {
        angle = kPi - angle;
    }
    return y < 0.0 ? -angle : angle;
}

double arc_cos(double c) noexcept {
    const double clamped = c < -1.0 ? -1.0 : (c > 1.0 ? 1.0 : c);
    return arc_tan2(std::sqrt((1.0 - clamped) * (1.0 + clamped)), clamped);
}

double natural_log(double x) noexcept {
    constexpr double kNormal = std::numeric_limits<double>::min();
    int exponent = 0;
    double m = 0.0;
    if (x >= kNormal && x <= std::numeric_limits<double>::max()) {  // what frexp does, in line
        constexpr int kMantissaBits = 52;
        constexpr int kBias = 1022;
        constexpr std::uint64_t kMantissa = (std::uint64_t{1} << kMantissaBits) - 1;
        constexpr std::uint64_t kHalf = std::uint64_t{kBias} << kMantissaBits;
        const auto bits = std::bit_cast<std::uint64_t>(x);
        exponent = static_cast<int>(bits >> kMantissaBits) - kBias;
        m = std::bit_cast<double>((bits & kMantissa) | kHalf);
    } else {
        m = std::frexp(x, &exponent);
    }
    constexpr double kSqrtHalf = 0.70710678118654752440;
    if (m < kSqrtHalf) {
        m *= 2.0;
        --exponent;
    }
    const double s = (m - 1.0) / (m + 1.0);
    const double z = s * s;
    double p = 1.0 / 21.0;
    for (const double term : kInverseOdds) {
        p = p * z + term;
    }
    const double e = static_cast<double>(exponent);
    return e * kLn2Hi + (2.0 * s + (2.0 * s * z * p + e * kLn2Lo));
}

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
