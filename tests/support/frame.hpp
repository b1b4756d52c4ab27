#pragma once

#include "engine/geometry/rational_bezier.hpp"

namespace palpate::engine {

/// Tangent, normal and curvature of a plane curve at one point.
struct Frame {
    Vec2 point{};
    Vec2 tangent{1.0, 0.0};  ///< unit, direction of travel
    Vec2 normal{0.0, 1.0};   ///< unit, outward: the tangent turned by +90 degrees
    double speed = 0.0;      ///< |C'|, m per unit of u
    double curvature = 0.0;  ///< 1/m, > 0 where the object bulges (convex)
};

/// Frame of `curve` at u.
[[nodiscard]] inline Frame frame_at(const RationalBezier<2>& curve, double u) noexcept {
    const Jet<2> jet = curve.at(u);
    Frame frame;
    frame.point = jet.point;
    frame.speed = glm::length(jet.first);
    if (frame.speed > 0.0) {
        const double inverse = 1.0 / frame.speed;
        frame.tangent = jet.first * inverse;
        frame.curvature = -cross(jet.first, jet.second) * (inverse * inverse * inverse);
    }
    frame.normal = perp(frame.tangent);
    return frame;
}

}  // namespace palpate::engine
