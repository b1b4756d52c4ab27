#include "protocols/psychometric/exact_math.hpp"

#include <cmath>
#include <limits>

#include "engine/math/elementary.hpp"

namespace palpate::protocols {
namespace {

// ln 2 in two parts: n * part 1 is exact for every n that can occur.
constexpr double kLn2Hi = 0x1.62e42fee00000p-1;
constexpr double kLn2Lo = 0x1.a39ef35793c76p-33;

constexpr double kSqrtHalf = 0.707106781186547524400844362104849039;
constexpr double kInverseSqrtPi = 0.564189583547756286948079451560772586;
constexpr double kInverseSqrtTwoPi = 0.398942280401432677939946059934381868;

/// e^-(x^2): x^2 has rounding errors that e enlarges by x^2, so its upper half is squared exactly.
double gauss(double x) noexcept {
    constexpr double kSplit = 134217729.0;  // 2^27 + 1, Dekker 1971
    const double c = kSplit * x;
    const double upper = c - (c - x);
    return exponential(-upper * upper) * exponential(-(x - upper) * (x + upper));
}

/// erfc x for x >= 0.
double erfc_upper(double x) noexcept {
    constexpr double kBorder = 1.5;    // below it 1 - erf x loses at most a decimal and a half
    constexpr int kLevels = 100;       // give 1e-16 at the border
    constexpr double kNothing = 27.3;  // below the smallest number
    if (x > kNothing) {
        return 0.0;
    }
    if (x < kBorder) {
        // erf x = 2/sqrt(pi) e^(-x^2) sum 2^k x^(2k+1) / (1 3 5 ... (2k+1))
        double term = x;
        double sum = x;
        for (int k = 1; term > sum * 1e-17; ++k) {
            term *= 2.0 * x * x / static_cast<double>(2 * k + 1);
            sum += term;
        }
        return 1.0 - 2.0 * kInverseSqrtPi * gauss(x) * sum;
    }
    // erfc x = e^(-x^2)/sqrt(pi) / (x + (1/2)/(x + 1/(x + (3/2)/(x + ...)))).
    double tail = x;
    for (int k = kLevels; k >= 1; --k) {
        tail = x + 0.5 * static_cast<double>(k) / tail;
    }
    return gauss(x) * kInverseSqrtPi / tail;
}

/// The z <= 0 of 0 < p <= 1/2.
double lower_quantile(double p) noexcept {
    const double t = std::sqrt(-2.0 * engine::natural_log(p));
    double z = (2.515517 + t * (0.802853 + t * 0.010328)) /
                   (1.0 + t * (1.432788 + t * (0.189269 + t * 0.001308))) -
               t;
    for (int i = 0; i < 3; ++i) {
        const double density = kInverseSqrtTwoPi * gauss(z * kSqrtHalf);
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
    double factorial = 479001600.0;
    for (int k = 12; k >= 2; --k) {
        p = p * r + 1.0 / factorial;
        factorial /= static_cast<double>(k);
    }
    return std::ldexp(1.0 + (r + r * r * p), static_cast<int>(n));
}

double power_of_ten(double x) noexcept {
    return exponential(x * kLn10);
}

double log_two(double x) noexcept {
    return engine::natural_log(x) / kLn2;
}

double p_log_p(double p) noexcept {
    return p > 0.0 ? p * log_two(p) : 0.0;
}

double normal_cdf(double z) noexcept {
    if (std::isnan(z)) {
        return z;
    }
    const double tail = 0.5 * erfc_upper(std::fabs(z) * kSqrtHalf);
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
    return p <= 0.5 ? lower_quantile(p) : -lower_quantile(1.0 - p);
}

}  // namespace palpate::protocols
