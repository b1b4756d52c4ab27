#pragma once

#include <limits>
#include <span>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

/// Points and vectors of the haptic core: double precision, SI.
///
/// GLM_FORCE_EXPLICIT_CTOR comes from the build, so that a float vector never turns up by accident.
/// Write `Vec2 p{};`, since a bare `Vec2 p;` holds rubbish. glm::normalize(0) is NaN: test the
/// length.
namespace palpate::engine {

/// A point or a direction of D coordinates.
template <int D>
using Vec = glm::vec<D, double, glm::defaultp>;
using Vec2 = Vec<2>;
using Vec3 = Vec<3>;

/// From 1 to the next double: twice the largest relative error of one operation.
inline constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// `v` turned by +90 degrees: the outward normal of a unit tangent (object on the right of travel).
[[nodiscard]] constexpr Vec2 perp(const Vec2& v) noexcept {
    return Vec2{-v.y, v.x};
}

/// z component of the 3-D cross product: > 0 when `b` lies to the left of `a`.
[[nodiscard]] constexpr double cross(const Vec2& a, const Vec2& b) noexcept {
    return a.x * b.y - a.y * b.x;
}

/// Axis-aligned box, m.
template <int D>
struct Box {
    Vec<D> low{};
    Vec<D> high{};

    /// Its centre, m.
    [[nodiscard]] Vec<D> middle() const noexcept { return low + 0.5 * (high - low); }
    /// Its edges, m, >= 0.
    [[nodiscard]] Vec<D> size() const noexcept { return high - low; }

    /// Squared distance from `h`, m^2: 0 inside.
    [[nodiscard]] double distance2(const Vec<D>& h) const noexcept {
        double sum = 0.0;
        for (int k = 0; k < D; ++k) {
            const double below = low[k] - h[k];
            const double above = h[k] - high[k];
            const double gap = below > 0.0 ? below : above > 0.0 ? above : 0.0;
            sum += gap * gap;
        }
        return sum;
    }

    /// Grows to hold `other` as well.
    void add(const Box& other) noexcept {
        low = glm::min(low, other.low);
        high = glm::max(high, other.high);
    }
};

/// Box of at least one point.
template <int D>
[[nodiscard]] Box<D> box_of(std::span<const Vec<D>> points) noexcept {
    Box<D> box{points[0], points[0]};
    for (const Vec<D>& p : points) {
        box.low = glm::min(box.low, p);
        box.high = glm::max(box.high, p);
    }
    return box;
}

}  // namespace palpate::engine
