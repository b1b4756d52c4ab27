#pragma once

#include "engine/surface/surface_ground.hpp"

namespace palpate::engine {

/// The flow of a sliding god-object at one place, in the parameters of its patch:
///
///     dg/ds = t / |t|,   t = r + nu n,  r = HIP - g,  nu = -r . n       s: way on the surface, m
///
/// With M the metric, f = M^-1 (r . Su, r . Sv) / |t|, C = Suu fu^2 + 2 Suv fu fv + Svv fv^2 and
/// the second form L = n . Suu and so on, its derivative along itself is (do Carmo, Differential
/// Geometry, 4-4; Weingarten's equations)
///
///     f' = nu/|t| ((n . C) f - M^-1 L f) - M^-1 (Su . C, Sv . C)
///     |t|' = -1 - nu (n . C),   nu' = |t| (n . C)
struct FlowSpot {
    Vec2 at{};             ///< u, v of the patch
    Vec2 way{};            ///< d(u, v)/ds, per m
    Vec2 bend{};           ///< d2(u, v)/ds2, per m^2
    double length = 0.0;   ///< |t|, m
    double load = 0.0;     ///< nu, m
    double excess = 0.0;   ///< |t| - mu max(nu, 0), m
    double rate = 0.0;     ///< d excess / ds
    double e = 0.0;        ///< the metric: Su . Su
    double f = 0.0;        ///< Su . Sv
    double g = 0.0;        ///< Sv . Sv
    Vec2 turn{};           ///< L f: n . d(Su)/ds, n . d(Sv)/ds
    bool regular = false;  ///< the surface has a tangent plane and the flow a direction

    /// Length of a small step (du, dv), m.
    [[nodiscard]] double measure(const Vec2& d) const noexcept;
    /// How the excess differs a small step (du, dv) from here, m.
    [[nodiscard]] double excess_by(const Vec2& d, double mu) const noexcept;
};

/// @param jet  at (u, v), which may lie a little outside of the patch
/// @param h    HIP relative to surface.origin(), m
[[nodiscard]] FlowSpot flow_spot(const SurfaceJet& jet,
                                 const Vec2& at,
                                 const Vec3& h,
                                 double mu) noexcept;

/// One step of length h along the flow and the quintic through its ends, their directions and
/// bends; relative error of a smooth flow h^6 y''''''/46080.
class FlowArc {
public:
    /// @param end  u and v at `to`; @param h  m along the flow, > 0
    FlowArc(const FlowSpot& from, const FlowSpot& to, const Vec2& end, double h) noexcept;
    /// u and v after the share x of the step; also a little beyond 1.
    [[nodiscard]] Vec2 at(double x) const noexcept {
        return start_ + x * (first_ + x * (second_ + x * (third_ + x * (fourth_ + x * fifth_))));
    }

private:
    Vec2 start_, first_, second_, third_, fourth_, fifth_;
};

}  // namespace palpate::engine
