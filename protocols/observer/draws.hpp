#pragma once

#include "engine/base/pcg32.hpp"

/// Random numbers of the simulated observer: the same to the bit on every IEEE-754 machine, since
/// they are made of + - * / and sqrt, and of the engine's own logarithm.
namespace palpate::protocols {

/// Uniform in [0, 1): 53 bits of two words, the first the upper one.
[[nodiscard]] double uniform_draw(Pcg32& random) noexcept;

/// Standard normal, by the polar method (G. Marsaglia and T. A. Bray, 1964); its second value is
/// not kept, so that a draw leaves no state behind.
[[nodiscard]] double normal_draw(Pcg32& random) noexcept;

/// Exponential with mean 1.
[[nodiscard]] double exponential_draw(Pcg32& random) noexcept;

}  // namespace palpate::protocols
