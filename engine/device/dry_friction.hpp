#pragma once

#include "engine/geometry/vec.hpp"

namespace palpate::engine {

/// Rates of two coupled joints after a step with dry friction, taken implicitly:
///
///     A v = right + lambda,   lambda_i = -limit_i sgn v_i,   |lambda_i| <= limit_i where v_i = 0
///
/// A joint that `right` cannot break loose gets v_i = 0 exactly, whatever the step, so that nothing
/// creeps and nothing chatters. The nine cases (each joint stands, turns on or turns back) are
/// tried, the likeliest first; for a positive definite A exactly one of them holds.
///
/// @param row_1, row_2  of A, kg m^2; near symmetric, positive definite
/// @param right         impulse of everything else, N m s
/// @param limit         breakaway impulse of each joint, N m s, >= 0
/// @param before        rates before the step, rad/s: only say which case is likely
[[nodiscard]] Vec2 after_dry_friction(const Vec2& row_1,
                                      const Vec2& row_2,
                                      const Vec2& right,
                                      const Vec2& limit,
                                      const Vec2& before) noexcept;

/// What rubs on a linkage in one step.
struct StepFriction {
    Vec2 joints{};        ///< N m s, breakaway impulse of each joint, >= 0
    double handle = 0.0;  ///< N s, of the handle, against its velocity, >= 0
    Vec2 carry_1{};       ///< rows of J^T J, J the handle's Jacobian
    Vec2 carry_2{};
};

/// The same with dry friction at the handle too, against its velocity v = J q':
///
///     A q' = right + lambda - handle J^T v / |v|
///
/// For a given |v| that is damping by handle / |v|, so that one number is looked for: the speed
/// that its own damping leaves. Three rounds find it to 1e-3; below a thousandth of the speed
/// without it the handle stands still.
[[nodiscard]] Vec2 after_dry_friction(const Vec2& row_1,
                                      const Vec2& row_2,
                                      const Vec2& right,
                                      const StepFriction& friction,
                                      const Vec2& before) noexcept;

}  // namespace palpate::engine
