#include "protocols/psychometric/exact_math.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "engine/math/elementary.hpp"

namespace palpate::protocols {
namespace {

/// 1/12! to 1/2!.
constexpr std::array<double, 11> kInverseFactorials{
    1.0 / 479001600.0, 1.0 / 39916800.0, 1.0 / 3628800.0, 1.0 / 362880.0,
    1.0 / 40320.0,     1.0 / 5040.0,     1.0 / 720.0,     1.0 / 120.0,
    1.0 / 24.0,        1.0 / 6.0,        1.0 / 2.0};

// ln 2 in two parts: n * part 1 is exact for every n that can occur.
constexpr double kLn2Hi = 0x1.62e42fee00000p-1;
constexpr double kLn2Lo = 0x1.a39ef35793c76p-33;

constexpr double kInverseSqrtTwoPi = 0.398942280401432677939946059934381868;

/// e^(-z^2 / 2): z^2 has rounding errors that e enlarges by z^2, so its upper half is squared
/// exactly.
double gauss(double z) noexcept {
    constexpr double kSplit = 134217729.0;  // 2^27 + 1, Dekker 1971
    const double c = kSplit * z;
    const double upper = c - (c - z);
    return exponential(-0.5 * upper * upper) * exponential(-0.5 * (z - upper) * (z + upper));
}

/// Phi(-z) for z >= 0.
double upper_tail(double z) noexcept {
    constexpr double kBorder = 1.5;    // below it 1/2 - ... loses less than a decimal
    constexpr double kNothing = 38.6;  // below the smallest number
    if (z > kNothing) {
        return 0.0;
    }
    if (z < kBorder) {
        // 1/2 - density(z) sum z^(2k+1) / (1 3 5 ... (2k+1))
        double term = z;
        double sum = z;
        for (int k = 1; term > sum * 1e-17; ++k) {
            term *= z * z / static_cast<double>(2 * k + 1);
            sum += term;
        }
        return 0.5 - kInverseSqrtTwoPi * gauss(z) * sum;
    }
    // density(z) / (z + 1/(z + 2/(z + 3/(z + ...))))
    const int levels = 20 + static_cast<int>(400.0 / (z * z));  // 1e-17, found by trying
    double tail = z;
    for (int k = levels; k >= 1; --k) {
        tail = z + static_cast<double>(k) / tail;
    }
    return kInverseSqrtTwoPi * gauss(z) / tail;
}

/// The z <= 0 of 0 < p <= 1/2.
double lower_quantile(double p) noexcept {
    const double t = std::sqrt(-2.0 * engine::natural_log(p));
    double z = (2.515517 + t * (0.802853 + t * 0.010328)) /
                   (1.0 + t * (1.432788 + t * (0.189269 + t * 0.001308))) -
               t;
    for (int i = 0; i < 3; ++i) {
        const double density = kInverseSqrtTwoPi * gauss(z);
        if (density <= 0.0) {
            break;  // so far out that the formula itself is as good as it gets
        }
        const double newton = (normal_cdf(z) - p) / density;
        z -= newton / (1.0 + 0.5 * z * newton);  // the density's slope is -z times the density
    }
    return z;
}

}  // namespace

double exponential(double x) noexcept {
    if (std::isnan(x)) {
        return x;
    }
    if (x > 709.8) {
        return std::numeric_limits<double>::infinity();
    }
    if (x < -745.2) {
        return 0.0;
    }
    const double n = std::floor(x / kLn2 + 0.5);
    const double r = (x - n * kLn2Hi) - n * kLn2Lo;
    double p = 1.0 / 6227020800.0;  // 1/13!
    for (const double term : kInverseFactorials) {
        p = p * r + term;
    }
    const double mantissa = 1.0 + (r + r * r * p);
    if (n < -1021.0 || n > 1023.0) {
        return std::ldexp(mantissa, static_cast<int>(n));
    }
    constexpr int kBias = 1023;
    constexpr int kMantissaBits = 52;
    const auto exponent = static_cast<std::uint64_t>(static_cast<int>(n) + kBias);
    return mantissa * std::bit_cast<double>(exponent << kMantissaBits);  // exact, as ldexp is
}

double power_of_ten(double x) noexcept {
    return exponential(x * kLn10);
}

double p_log_p(double p) noexcept {
    return p > 0.0 ? p * (engine::natural_log(p) / kLn2) : 0.0;
}

double normal_cdf(double z) noexcept {
    if (std::isnan(z)) {
        return z;
    }
    const double tail = upper_tail(std::fabs(z));
    return z <= 0.0 ? tail : 1.0 - tail;
}

double normal_quantile(double p) noexcept {
    if (p == 0.0 || p == 1.0) {
        const double end = std::numeric_limits<double>::infinity();
        return p == 0.0 ? -end : end;
    }
    if (!(p > 0.0 && p < 1.0)) {
        return std::numeric_limits<double>::quiet_NaN();
    }
    if (p == 0.5) {
        return 0.0;  // by symmetry; the fraction leaves 2e-18
    }
    return p < 0.5 ? lower_quantile(p) : -lower_quantile(1.0 - p);
}

double entropy_of(std::span<const double> shares) noexcept {
    double entropy = 0.0;
    for (const double p : shares) {
        entropy -= p_log_p(p);
    }
    return entropy;
}

}  // namespace palpate::protocols
