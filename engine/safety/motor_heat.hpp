#pragma once

#include "engine/geometry/vec.hpp"

namespace palpate::engine {

/// Heat of the motors, as a share of what each can bear for ever: the I^2 t model, first order,
///
///     theta' = (load^2 - theta) / tau
///
/// by theta += a (load^2 - theta) with a = 1 - 1 / (1 + s + s^2/2), s = step / tau: 1 - exp(-s) to
/// s^3/6, and between 0 and 1 for any step. A load of 1 for ever never brings theta above 1.
/// @param heat  theta, >= 0   @param load  |torque| / torque_forever   @param step  time / tau, >=
///       0
[[nodiscard]] Vec3 heated(const Vec3& heat, const Vec3& load, double step) noexcept;

}  // namespace palpate::engine
