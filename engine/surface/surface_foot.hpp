#pragma once

#include "engine/surface/nurbs_surface.hpp"

namespace palpate::engine {

class SurfaceObject;

/// A foot of a point h on a surface: where |S - h| is smallest among its neighbours.
struct SurfaceFoot {
    SurfacePlace place{};
    SurfaceJet jet{};        ///< there, per unit of the patch's parameters, relative to origin()
    double distance2 = 0.0;  ///< |S - h|^2, m^2
    bool on_border = false;  ///< on an open border (or a limit), and h pulls it outwards
};

/// First and second derivatives of |S - h|^2 / 2 at one place.
struct FootSlope {
    double u = 0.0;
    double v = 0.0;
    double uu = 0.0;
    double uv = 0.0;
    double vv = 0.0;

    /// @param r  S(u, v) - h, m
    FootSlope(const SurfaceJet& jet, const Vec3& r) noexcept
        : u(glm::dot(r, jet.du)),
          v(glm::dot(r, jet.dv)),
          uu(glm::dot(jet.du, jet.du) + glm::dot(r, jet.duu)),
          uv(glm::dot(jet.du, jet.dv) + glm::dot(r, jet.duv)),
          vv(glm::dot(jet.dv, jet.dv) + glm::dot(r, jet.dvv)) {}

    /// The second derivatives are those of a bowl, by more than rounding.
    [[nodiscard]] bool bowl() const noexcept {
        return uu > 0.0 && vv > 0.0 && uu * vv - uv * uv > 1e-12 * (uu * vv);
    }
};

/// A part of a patch: lo <= u, v <= hi.
struct PatchPart {
    double lo_u = 0.0;
    double hi_u = 1.0;
    double lo_v = 0.0;
    double hi_v = 1.0;
};

/// Goes downhill from `start` to a local foot of h, over patch borders where there are neighbours
/// and along open borders.
///
///     Newton's step on (S - h) . Su = (S - h) . Sv = 0, with bounds; The NURBS Book, 6.1
///
/// Where the second derivatives are no bowl, with both eigenvalues made positive. Every step that
/// is not tiny lowers the distance, so that it ends. The distance is the local minimum to rounding:
/// 4e-16 of the size.
/// @param h     relative to surface.origin(), m
/// @param work  counted down; below 0 the descent ends where it is
[[nodiscard]] SurfaceFoot descend(const SurfaceObject& surface,
                                  const Vec3& h,
                                  const SurfacePlace& start,
                                  Work& work) noexcept;

/// The same inside one part of a patch.
[[nodiscard]] SurfaceFoot descend_within(const SurfaceObject& surface,
                                         const Vec3& h,
                                         const SurfacePlace& start,
                                         const PatchPart& part,
                                         Work& work) noexcept;

}  // namespace palpate::engine
