#pragma once

#include <cstdint>

#include "engine/friction/friction_law.hpp"
#include "engine/geometry/outline.hpp"

namespace palpate::engine {

/// How far outside its friction cone a god-object at a point of a curve is, times the curve's speed
/// |C'| (m^2 per unit of u): no root and no division, for the test that runs on every tick.
///
/// With r = HIP - GO: tangential r . C', load -r . perp(C'), both |C'| times what Stretch says.
struct Drive {
    double tangential = 0.0;
    double load = 0.0;
    double speed2 = 0.0;  ///< |C'|^2

    /// |tangential| - mu max(load, 0); > 0: the GO has to move.
    template <bool HasFriction>
    [[nodiscard]] double excess(double mu) const noexcept {
        return (tangential < 0.0 ? -tangential : tangential) - cone_radius<HasFriction>(mu, load);
    }
};

[[nodiscard]] inline Drive drive_at(const Jet<2>& jet, const Vec2& h) noexcept {
    const Vec2 r = h - jet.point;
    return {.tangential = glm::dot(r, jet.first),
            .load = -cross(jet.first, r),
            .speed2 = glm::dot(jet.first, jet.first)};
}

/// Where a slide ended.
enum class SlideEnd : std::uint8_t {
    in_cone,  ///< at the first place where the stretch fits the cone
    at_end,   ///< at the end of the span, still outside
    out_of_budget,
};

struct Slide {
    double u = 0.0;
    Jet<2> jet{};         ///< of the curve at u
    double length = 0.0;  ///< arc length travelled, m, first order in each step
    SlideEnd end = SlideEnd::in_cone;
};

/// Moves the god-object from u in direction `dir` (+1 or -1) up to the first place where
/// dir tau <= mu max(nu, 0), at most `budget` m and not over the end of the span.
///
///     ds = (dir tau - mu nu) / max(1 - kappa (nu + mu |tau|), 1/4)
///
/// is Newton's step, since d(dir tau - mu nu)/ds = -(1 - kappa (nu + mu |tau|)) along a curve with
/// curvature kappa; the floor keeps it finite near a centre of curvature. Here it is taken in u on
/// the form times |C'|, where it needs neither the unit frame nor the curvature. A step past the
/// root is closed in between brackets, and the end is the root to rounding, on its inner side.
/// @param jet  of the curve at u
/// @pre the excess is > 0 at u, in direction dir
template <bool HasFriction>
[[nodiscard]] Slide slide_to_cone(const RationalBezier<2>& curve,
                                  const Vec2& h,
                                  double mu,
                                  double u,
                                  const Jet<2>& jet,
                                  double dir,
                                  double budget) noexcept;

}  // namespace palpate::engine
