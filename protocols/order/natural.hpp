#pragma once

#include <cstddef>
#include <vector>

#include <boost/multiprecision/cpp_int.hpp>

#include "engine/base/pcg32.hpp"

namespace palpate::protocols {

/// A whole number of any size. Orders are counted with it, and drawn below what was counted: no
/// rounding anywhere, and the same on every machine.
using Natural = boost::multiprecision::number<boost::multiprecision::cpp_int_backend<>,
                                              boost::multiprecision::et_off>;

/// Digits in base 2; 0 has none. @pre n >= 0
[[nodiscard]] std::size_t bits_of(const Natural& n);

/// part / whole to double precision, also where neither fits into a double. @pre part >= 0, whole >
/// 0
[[nodiscard]] double share_of(const Natural& part, const Natural& whole);

/// Uniform in 0 ... n - 1 without bias: as many random bits as n - 1 has, the highest first, until
/// they stay below n. n = 1 draws nothing. @pre n >= 1
[[nodiscard]] Natural draw_below(const Natural& n, Pcg32& random);

/// (sum of counts)! / product of counts!: the orders of things of which counts[i] are alike.
[[nodiscard]] Natural multinomial(const std::vector<std::size_t>& counts);

}  // namespace palpate::protocols
