#pragma once

#include "engine/friction/friction_law.hpp"
#include "engine/surface/surface_fan.hpp"

namespace palpate::engine {

/// The god-object on a surface after a slide, with what the force needs to know.
struct SurfaceSlide {
    SurfacePlace place{};
    Vec3 point{};                ///< m, relative to surface.origin()
    Vec3 normal{0.0, 0.0, 1.0};  ///< unit, outward, of its patch, or between those of a crease
    Vec3 tangential{};           ///< r without its normal part, r = HIP - GO, m
    double length = 0.0;         ///< |tangential|, m
    double load = 0.0;           ///< nu = -r . n, m: > 0 inside
    double slid = 0.0;           ///< way of the GO, m: of the flow, or the sum of its chords
    bool outside_cone = false;   ///< stopped outside its cone: at an open border
    bool in_crease = false;      ///< in a concave crease, whose sides carry together
    bool out_of_budget = false;  ///< the vertex slew ended the walk, outside of the cone
    bool on_flow =
        true;  ///< false: the flow had no direction, or was left by more than 1e-8 of the size
    bool settled = true;  ///< false: the work limit ended the walk, mostly outside of the cone
};

/// What one slide of a tick may cost, some 0.1 ms; up to 7 evaluations of the surface are usual.
inline constexpr Work kSlideWork = 150'000;

/// Lets the god-object go down |r|, r = HIP - GO, until r fits the friction cone of its own normal:
///
///     dg/ds = t / |t|   to the first g where |t| <= mu max(nu, 0);   r = t - nu n
///
/// Along this flow |r| falls at the rate |t| / |r|, which is what passivity rests on. Inside a
/// patch it is followed by SurfaceFlow. Without friction it ends at a foot of HIP; there, along
/// edges, and where the flow has no direction, the walk goes in steps (SurfaceSteps) that begin
/// along t, each inside one patch, as long as Newton's on |t| - mu nu,
///
///     ds = (|t| - mu nu) / (1 - kappa (nu + mu |t|))    with kappa the normal curvature along t,
///
/// twice the one before where the cone lies further than that promises, and a quarter if |r| did
/// not fall, or without friction not as promised: then a foot may lie on the way. The end lies on
/// the cone, on its inner side, within 1e-14 mu nu + 1e-15 (|g| + |r|).
///
/// On an edge all patches that meet there are asked (SurfaceGround::footing): the GO goes on into
/// one of them, along the edge, or stays where every way is barred: at an open border, and in a
/// concave crease, whose cone is that of the normal between its sides' that lies nearest to the
/// force. Where every way is barred because HIP is in front of a convex edge, the contact ends. A
/// pole (an edge that is one point) is crossed. When `work` is used up the GO stays where it is
/// and says so; the next tick goes on from there.
/// @param h   HIP relative to surface.origin(), m
/// @param mu  >= 0, 0: without friction
/// @param work  what it may cost
[[nodiscard]] SurfaceSlide slide_on_surface(const SurfaceObject& surface,
                                            const SurfacePlace& from,
                                            const Vec3& h,
                                            double mu,
                                            Work work = kSlideWork) noexcept;

/// The same with a vertex slew: way and turns are paid from its budget, and a convex edge is gone
/// over through the fan of its normals (turn_in_fan). Without friction the flow is followed, too,
/// unless steps come to the foot with a budget to spare.
/// @param fan  where in one the god-object is; carried from tick to tick
[[nodiscard]] SurfaceSlide slide_on_surface(const SurfaceObject& surface,
                                            const SurfacePlace& from,
                                            const Vec3& h,
                                            double mu,
                                            const SurfaceSlew& slew,
                                            SurfaceFan& fan) noexcept;

}  // namespace palpate::engine
