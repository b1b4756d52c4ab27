#pragma once

/// Sine, cosine, arctangent and logarithm from + - * / and exact scaling only.
///
/// libm's versions differ between C libraries in the last bit, and one bit is enough to break a
/// replay. These give the same result to the bit on every IEEE-754 machine built with
/// -ffp-contract=off. Accuracy against the true value, measured over 1e6 seeded arguments
/// (tests/engine/elementary_test.cpp): 2 ulp of the result, or 2.3e-16 near a zero of sine or cosine.
namespace palpate::engine {

inline constexpr double kPi = 3.141592653589793238462643383279502884;

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

/// Natural logarithm of x > 0 (normal numbers). log m = 2 artanh((m-1)/(m+1)), m in [sqrt 1/2, sqrt 2).
[[nodiscard]] double natural_log(double x) noexcept;

}  // namespace palpate::engine
