#pragma once

#include "engine/friction/friction_law.hpp"
#include "engine/surface/surface_foot.hpp"

namespace palpate::engine {

/// The god-object on a surface after a slide, with what the force needs to know.
struct SurfaceSlide {
    SurfacePlace place{};
    Vec3 point{};                ///< m, relative to surface.origin()
    Vec3 normal{0.0, 0.0, 1.0};  ///< unit, outward, of the patch it sits on
    Vec3 tangential{};           ///< r without its normal part, r = HIP - GO, m
    double length = 0.0;         ///< |tangential|, m
    double load = 0.0;           ///< nu = -r . n, m: > 0 inside
    double slid = 0.0;           ///< way of the GO, m: sum of chords
    bool outside_cone = false;   ///< stopped outside its cone: at an open border or in a crease
    bool in_crease = false;      ///< in a concave crease, whose two sides carry together
};

/// Lets the god-object move until its stretch r fits the friction cone of its own normal:
///
///     while |t| > mu max(nu, 0):  move g in the direction of t, the tangential part of r, by
///         ds = (|t| - mu nu) / max(1 - kappa (nu + mu |t|), 1/4)
///
/// which is Newton's step: with kappa the normal curvature along t (> 0 convex), the derivative of
/// |t| - mu nu along the way is -(1 - kappa (nu + mu |t|)) in 3-D as in 2-D, since geodesic torsion
/// turns t without changing its length. Steps are taken in the tangent plane (2 x 2 metric) with
/// the second order of the surface; long ones, and those over an edge of a patch, by the foot of
/// the stepped point. No step raises |r|, which is what passivity rests on. A step over the cone is
/// closed in from both sides, so that the end lies on the cone, on its inner side, within
/// 1e-14 mu nu + 1e-15 (|g| + |r|).
///
/// At an open border, and in a concave crease, the GO stays; it slides along the edge while the
/// part of t along it exceeds mu nu. A pole (an edge that is one point) is crossed. Without
/// friction the GO goes to the local foot of HIP.
/// @param h   HIP relative to surface.origin(), m
/// @param mu  >= 0, not read without friction
template <bool HasFriction>
[[nodiscard]] SurfaceSlide slide_on_surface(const NurbsSurface& surface,
                                            const SurfacePlace& from,
                                            const Vec3& h,
                                            double mu) noexcept;

}  // namespace palpate::engine
