#pragma once

#include <array>
#include <cstdint>

/// Sine, cosine, arctangent and logarithm from + - * / and exact scaling only.
///
/// libm's versions differ between C libraries in the last bit, and one bit is enough to break a
/// replay. These give the same result to the bit on every IEEE-754 machine built with
/// -ffp-contract=off. Accuracy against the true value, measured over 1e6 seeded arguments
/// (tests/engine/elementary_test.cpp): 2 ulp of the result, or 2.3e-16 near a zero of sine or
/// cosine.
namespace palpate::engine {

inline constexpr double kPi = 3.141592653589793238462643383279502884;
inline constexpr double kTurn = 2.0 * kPi;

/// Sine and cosine of one angle.
struct SinCos {
    double sin = 0.0;
    double cos = 1.0;
};

/// Sine and cosine of `x`, rad. |x| <= 1e5; beyond it the reduction loses digits.
/// Taylor polynomials on [-pi/4, pi/4] after subtracting a multiple of pi/2 in three parts
/// (Cody & Waite 1980). NaN for a value that is not finite, and finite for all others.
[[nodiscard]] SinCos sin_cos(double x) noexcept;

/// Angle of (x, y) in (-pi, pi], rad; 0 for the origin, NaN for what is not finite.
/// atan z = atan(k/8) + atan((z - k/8) / (1 + z k/8)), then the Taylor series for |t| <= 1/16.
[[nodiscard]] double arc_tan2(double y, double x) noexcept;

/// Angle whose cosine is `c`, rad in [0, pi]; `c` is clamped to [-1, 1].
[[nodiscard]] double arc_cos(double c) noexcept;

/// Natural logarithm of x > 0 (normal numbers). log m = 2 artanh((m-1)/(m+1)), m in [sqrt 1/2, sqrt
/// 2).
[[nodiscard]] double natural_log(double x) noexcept;

// The arithmetic of sin_cos() without its question whether x is near enough, for loops over many
// angles.

/// Quarter turns that a 32 bit number counts.
inline constexpr double kMaxQuarters = 0x1p31;

/// What near_sin_cos rounds down to a whole number of quarter turns.
[[nodiscard, gnu::always_inline]] inline double quarters_of(double x) noexcept {
    return x * (2.0 / kPi) + 0.5;
}

/// Two numbers at once, with the bits that each would have alone.
using Pair [[gnu::vector_size(2 * sizeof(double))]] = double;

/// sin r for |r| <= pi/4; the first term left out is below 1e-18 of the result.
/// @tparam Number  double or Pair
template <class Number>
[[nodiscard, gnu::always_inline]] inline Number sin_kernel(Number r) noexcept {
    const Number z = r * r;
    Number p = Number{} + 1.0 / 355687428096000.0;  // 1/17!
    p = p * z - 1.0 / 1307674368000.0;
    p = p * z + 1.0 / 6227020800.0;
    p = p * z - 1.0 / 39916800.0;
    p = p * z + 1.0 / 362880.0;
    p = p * z - 1.0 / 5040.0;
    p = p * z + 1.0 / 120.0;
    p = p * z - 1.0 / 6.0;
    return r + r * (z * p);
}

/// cos r for |r| <= pi/4. 1 - z/2 is formed last, with its rounding error put back.
template <class Number>
[[nodiscard, gnu::always_inline]] inline Number cos_kernel(Number r) noexcept {
    const Number z = r * r;
    Number p = Number{} + 1.0 / 20922789888000.0;  // 1/16!
    p = p * z - 1.0 / 87178291200.0;
    p = p * z + 1.0 / 479001600.0;
    p = p * z - 1.0 / 3628800.0;
    p = p * z + 1.0 / 40320.0;
    p = p * z - 1.0 / 720.0;
    p = p * z + 1.0 / 24.0;
    const Number half = 0.5 * z;
    const Number head = 1.0 - half;
    return head + (((1.0 - head) - half) + z * z * p);
}

/// x less n quarter turns. pi/2 in three parts of 33, 33 and 53 bits: n * part is exact for |n| <
/// 2^20.
template <class Number>
[[nodiscard, gnu::always_inline]] inline Number less_quarters(Number x, Number n) noexcept {
    constexpr double kHalfPi1 = 0x1.921fb54400000p+0;
    constexpr double kHalfPi2 = 0x1.0b4611a600000p-34;
    constexpr double kHalfPi3 = 0x1.3198a2e037073p-69;
    return ((x - n * kHalfPi1) - n * kHalfPi2) - n * kHalfPi3;
}

/// sin_cos(x). @pre |quarters_of(x)| < kMaxQuarters
[[nodiscard, gnu::always_inline]] inline SinCos near_sin_cos(double x) noexcept {
    const double quarters = quarters_of(x);
    const auto whole = static_cast<std::int32_t>(quarters);
    const std::int32_t n = whole - (static_cast<double>(whole) > quarters ? 1 : 0);  // floor
    const double r = less_quarters(x, static_cast<double>(n));
    const double s = sin_kernel(r);
    const double c = cos_kernel(r);
    const bool swapped = (n & 1) != 0;
    const double sine = swapped ? c : s;
    const double cosine = swapped ? s : c;
    return {(n & 2) != 0 ? -sine : sine, ((n + 1) & 2) != 0 ? -cosine : cosine};
}

/// sin_cos of two angles, for little more than that of one.
[[nodiscard, gnu::always_inline]] inline std::array<SinCos, 2> sin_cos(double x,
                                                                       double y) noexcept {
    using Whole [[gnu::vector_size(2 * sizeof(std::int32_t))]] = std::int32_t;
    using Bits [[gnu::vector_size(2 * sizeof(std::int64_t))]] = std::int64_t;
    const Pair angles{x, y};
    const Pair quarters = angles * (2.0 / kPi) + 0.5;
    const Bits near = (quarters < kMaxQuarters) & (quarters > -kMaxQuarters);
    if ((near[0] & near[1]) == 0) {
        return {sin_cos(x), sin_cos(y)};
    }
    const Pair whole = __builtin_convertvector(__builtin_convertvector(quarters, Whole), Pair);
    const Pair n =
        whole - reinterpret_cast<Pair>((whole > quarters) & reinterpret_cast<Bits>(Pair{1.0, 1.0}));
    const Pair r = less_quarters(angles, n);
    const auto s = reinterpret_cast<Bits>(sin_kernel(r));
    const auto c = reinterpret_cast<Bits>(cos_kernel(r));
    const Bits turns = __builtin_convertvector(__builtin_convertvector(n, Whole), Bits);
    const Bits swapped = (s ^ c) & -(turns & 1);
    const auto sine = reinterpret_cast<Pair>(s ^ swapped ^ ((turns & 2) << 62));
    const auto cosine = reinterpret_cast<Pair>(c ^ swapped ^ (((turns + 1) & 2) << 62));
    return {SinCos{sine[0], cosine[0]}, SinCos{sine[1], cosine[1]}};
}

// Exponential and its kin from + - * / and exact scaling only: the same bits on every IEEE-754
// machine built with -ffp-contract=off, as those above. Accuracy against
// the true value, measured over 1e5 seeded arguments (tests/engine/elementary_test.cpp): 2 ulp of
// the result, 4 for e^x - 1, 3 for tanh, 1e-13 relative for powers.

/// e^x for x <= 700; 0 below -708, where the result leaves the normal numbers. More than 700 counts
/// as 700: finite in, finite out.
/// x = n ln 2 + r with |r| <= ln 2 / 2, the Taylor polynomial of r, and 2^n exactly.
[[nodiscard]] double exponential(double x) noexcept;

/// e^x - 1 without the cancellation near 0. x <= 700.
[[nodiscard]] double exponential_less_one(double x) noexcept;

/// tanh x = -E / (2 + E) of its sign, with E = e^(-2|x|) - 1.
[[nodiscard]] double hyperbolic_tangent(double x) noexcept;

/// base^exponent = e^(exponent ln base); 0 for a base that is not a normal number above 0.
/// @pre |exponent ln base| <= 700
[[nodiscard]] double power(double base, double exponent) noexcept;

}  // namespace palpate::engine
