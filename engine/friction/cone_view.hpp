#pragma once

#include <algorithm>
#include <cmath>

#include "engine/friction/friction_law.hpp"

namespace palpate::engine {

/// The stretch r = HIP - GO at a place of a curve, in the unit frame there.
struct ConeView {
    Vec2 tangent{};
    double tau = 0.0;     ///< r . t, m, signed
    double nu = 0.0;      ///< -r . n, m
    double excess = 0.0;  ///< |tau| - mu max(nu, 0), m; > 0: the GO has to move
};

/// Of a god-object at `point`, held by HIP at `h`, m. @param tangent  unit
template <bool HasFriction>
[[nodiscard]] ConeView cone_view(const Vec2& h,
                                 const Vec2& point,
                                 const Vec2& tangent,
                                 double mu) noexcept {
    const Vec2 r = h - point;
    ConeView v{.tangent = tangent, .tau = glm::dot(r, tangent), .nu = -cross(tangent, r)};
    v.excess = std::fabs(v.tau) - cone_radius<HasFriction>(mu, v.nu);
    return v;
}

/// By the normal that points away from HIP, m; where HIP is, that of a tangent.
[[nodiscard]] inline ConeView against_hip(const Vec2& h,
                                          const Vec2& point,
                                          const Vec2& tangent) noexcept {
    const Vec2 gap = point - h;
    const double length = glm::length(gap);
    const Vec2 normal = length > 0.0 ? gap / length : perp(tangent);
    return {.tangent = -perp(normal), .nu = length};
}

/// A concave vertex: two normals, two loads. F = K (V - h) is carried by both together, and in a
/// groove sharper than the angle of friction by one side alone against what pulls along the other.
struct Groove {
    ConeView before;  ///< by the tangent of the curve that ends here
    ConeView after;   ///< by that of the one that begins

    /// Along which of them it is left: +1 on, -1 back, 0 neither. Where both lead out, HIP is
    /// behind the one along which it pulls more.
    /// @param direction  of the walk so far, which does not turn back; 0: none
    template <bool HasFriction>
    [[nodiscard]] double way_out(double direction) const noexcept {
        const auto carries = [](const ConeView& side) {
            return HasFriction && side.nu > 0.0 && side.excess <= 0.0;
        };
        const bool on = after.tau > 0.0 && after.excess > 0.0 && !carries(before);
        const bool back = before.tau < 0.0 && before.excess > 0.0 && !carries(after);
        if (on && direction >= 0.0 && !(back && direction == 0.0 && -before.tau > after.tau)) {
            return 1.0;
        }
        return back && direction <= 0.0 ? -1.0 : 0.0;
    }

    /// By the normal of its internal fan that lies nearest to the force.
    [[nodiscard]] ConeView felt(const Vec2& h, const Vec2& vertex) const noexcept {
        if (after.tau >= 0.0 && !(before.tau <= 0.0 && before.nu > after.nu)) {
            return after;
        }
        return before.tau <= 0.0 ? before : against_hip(h, vertex, after.tangent);
    }
};

}  // namespace palpate::engine
