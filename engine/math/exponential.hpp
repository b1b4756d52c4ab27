#pragma once

/// Exponential and its kin from + - * / and exact scaling only: the same bits on every IEEE-754
/// machine built with -ffp-contract=off, as those of engine/math/elementary.hpp. Accuracy against
/// the true value, measured over 1e5 seeded arguments (tests/engine/exponential_test.cpp): 2 ulp of
/// the result, 4 for e^x - 1, 3 for tanh, 1e-13 relative for powers.
namespace palpate::engine {

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
