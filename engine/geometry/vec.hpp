#pragma once

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

/// Points and vectors of the haptic core: double precision, SI.
///
/// GLM_FORCE_EXPLICIT_CTOR comes from the build, so that a float vector never turns up by accident.
/// Write `Vec2 p{};`, since a bare `Vec2 p;` holds rubbish. glm::normalize(0) is NaN: test the length.
namespace palpate::engine {

template <int D>
using Vec = glm::vec<D, double, glm::defaultp>;
using Vec2 = Vec<2>;
using Vec3 = Vec<3>;

/// `v` turned by +90 degrees: the outward normal of a unit tangent (object on the right of travel).
[[nodiscard]] constexpr Vec2 perp(const Vec2& v) noexcept {
    return Vec2{-v.y, v.x};
}

/// z component of the 3-D cross product: > 0 when `b` lies to the left of `a`.
[[nodiscard]] constexpr double cross(const Vec2& a, const Vec2& b) noexcept {
    return a.x * b.y - a.y * b.x;
}

}  // namespace palpate::engine
