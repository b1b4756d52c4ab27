#pragma once

#include "engine/friction/friction_law.hpp"
#include "engine/surface/nurbs_surface.hpp"

namespace palpate::engine {

/// A place of the god-object on a surface with everything that is measured there.
struct SurfaceSpot {
    SurfacePlace place{};
    SurfaceJet jet{};     ///< relative to surface.origin()
    Vec3 normal{};        ///< unit, outward
    double r2 = 0.0;      ///< |r|^2, r = HIP - GO, m^2
    Vec3 along{};         ///< tangential part of r, m
    double length = 0.0;  ///< of it
    double load = 0.0;    ///< -r . normal, m
    double cone = 0.0;    ///< mu max(load, 0), m
    double excess = 0.0;  ///< length - cone, m; > 0: outside of the cone
};

/// What the god-object finds under its feet: its stretch and cone, borders, creases and poles.
class SurfaceGround {
public:
    /// @param h  HIP relative to surface.origin(), m
    SurfaceGround(const NurbsSurface& surface, const Vec3& h, double mu) noexcept
        : surface_(surface), h_(h), mu_(mu) {}

    [[nodiscard]] const NurbsSurface& surface() const noexcept { return surface_; }
    [[nodiscard]] const Vec3& h() const noexcept { return h_; }
    [[nodiscard]] double mu() const noexcept { return mu_; }

    [[nodiscard]] SurfaceSpot look(SurfacePlace place) const noexcept;

    /// Width of the shell inside the cone in which a slide ends, m: the rounding of a place.
    [[nodiscard]] static double tolerance(const SurfaceSpot& s) noexcept;
    /// Within its cone; where that is narrower than rounding (no load, no friction) at the local
    /// foot.
    [[nodiscard]] static bool settled(const SurfaceSpot& s) noexcept;
    /// Parameters of the way `t` in the tangent plane: the 2 x 2 metric.
    [[nodiscard]] static Vec2 parameters(const SurfaceJet& jet, const Vec3& t) noexcept;

    /// A way with this part in u (v) ends at once: at an open border, or in a concave crease, on
    /// whose other side HIP draws the GO back.
    [[nodiscard]] bool blocked_u(const SurfaceSpot& s, double du) const noexcept;
    [[nodiscard]] bool blocked_v(const SurfaceSpot& s, double dv) const noexcept;
    /// On an edge between two patches, not on an open border.
    [[nodiscard]] bool between(SurfacePlace p) const noexcept;

    /// On an edge that is one point: to the place on it from which the surface goes on along the
    /// stretch, within 6 degrees. The point stays the same. False elsewhere.
    [[nodiscard]] bool turn_at_pole(SurfaceSpot& s) const noexcept;

private:
    [[nodiscard]] bool pushes_back(const SurfaceSpot& here,
                                   const SurfacePlace& beyond,
                                   bool in_u) const noexcept;
    [[nodiscard]] double way_off(const SurfacePlace& p, bool in_u, const Vec3& t) const noexcept;

    const NurbsSurface& surface_;
    Vec3 h_;
    double mu_;
};

}  // namespace palpate::engine
