#pragma once

#include <algorithm>
#include <cmath>

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
///
/// A bare `FlowSpot s;` holds rubbish.
struct FlowSpot {
    Vec2 at;        ///< u, v of the patch
    Vec2 way;       ///< d(u, v)/ds, per m
    Vec2 bend;      ///< d2(u, v)/ds2, per m^2
    double length;  ///< |t|, m
    double load;    ///< nu, m
    double excess;  ///< |t| - mu max(nu, 0), m
    double rate;    ///< d excess / ds
    double e;       ///< the metric: Su . Su
    double f;       ///< Su . Sv
    double g;       ///< Sv . Sv
    Vec2 turn;      ///< L f: n . d(Su)/ds, n . d(Sv)/ds
    bool regular;   ///< the surface has a tangent plane and the flow a direction

    /// Length of a small step (du, dv), m.
    [[nodiscard]] double measure(const Vec2& d) const noexcept {
        return std::sqrt(std::max(e * d.x * d.x + 2.0 * f * d.x * d.y + g * d.y * d.y, 0.0));
    }
    /// How the excess differs a small step (du, dv) from here, m.
    [[nodiscard]] double excess_by(const Vec2& d, double mu) const noexcept {
        // T . dS, and n . dn along the way.
        const double ahead = (e * way.x + f * way.y) * d.x + (f * way.x + g * way.y) * d.y;
        const double bends = turn.x * d.x + turn.y * d.y;
        return -ahead - (load + (load > 0.0 ? mu * length : 0.0)) * bends;
    }
};

/// What is not regular has no way, bend, turn and rate. Members are written one by one: what is put
/// together elsewhere, and copied by halves of 16 bytes, waits until all of it is in memory.
/// @param j  at (u, v), which may lie a little outside of the patch
/// @param h  HIP relative to surface.origin(), m
inline void flow_spot(
    const SurfaceJet& j, const Vec2& at, const Vec3& h, double mu, FlowSpot& spot) noexcept {
    spot.at = at;
    spot.excess = 0.0;
    spot.regular = false;
    const double e = glm::dot(j.du, j.du);
    const double f = glm::dot(j.du, j.dv);
    const double g = glm::dot(j.dv, j.dv);
    const Vec3 area = glm::cross(j.du, j.dv);
    const double area2 = glm::dot(area, area);
    spot.e = e;
    spot.f = f;
    spot.g = g;
    if (!(area2 > 1e-18 * e * g)) {
        return;
    }
    const Vec3 normal = (1.0 / std::sqrt(area2)) * area;
    const Vec3 r = h - j.point;
    const Stretch<3> parts = stretch<3>(r, normal);
    spot.length = parts.length;
    spot.load = parts.load;
    spot.excess = parts.length - cone_radius<true>(mu, parts.load);
    if (!(parts.length > 0.0)) {
        return;
    }
    const double inverse = 1.0 / area2;
    const auto raised = [&](double a, double b) {
        return Vec2{(g * a - f * b) * inverse, (e * b - f * a) * inverse};
    };
    const double per_length = 1.0 / parts.length;
    const Vec2 way =
        per_length * raised(glm::dot(parts.tangential, j.du), glm::dot(parts.tangential, j.dv));
    const double uu = glm::dot(normal, j.duu);
    const double uv = glm::dot(normal, j.duv);
    const double vv = glm::dot(normal, j.dvv);
    const Vec2 turn{uu * way.x + uv * way.y, uv * way.x + vv * way.y};
    const double bends = turn.x * way.x + turn.y * way.y;  // n . C
    const Vec3 c =
        (way.x * way.x) * j.duu + (2.0 * way.x * way.y) * j.duv + (way.y * way.y) * j.dvv;
    const double pull = parts.load * per_length;
    const Vec2 bend = (pull * bends) * way -
                      raised(pull * turn.x + glm::dot(j.du, c), pull * turn.y + glm::dot(j.dv, c));
    const double rate = -1.0 - bends * (parts.load + (parts.load > 0.0 ? mu * parts.length : 0.0));
    spot.way = way;
    spot.bend = bend;
    spot.turn = turn;
    spot.rate = rate;
    spot.regular = std::isfinite(bend.x + bend.y + rate);
}

/// One step of length h along the flow and the quintic through its ends, their directions and
/// bends; relative error of a smooth flow h^6 y''''''/46080.
class FlowArc {
public:
    /// @param end  u and v at `to`; @param h  m along the flow, > 0
    FlowArc(const FlowSpot& from, const FlowSpot& to, const Vec2& end, double h) noexcept
        : start_(from.at), first_(h * from.way), second_((0.5 * h * h) * from.bend) {
        // What the ends ask for beyond the second order.
        const Vec2 place = end - start_ - first_ - second_;
        const Vec2 slope = h * (to.way - from.way) - 2.0 * second_;
        const Vec2 bend = (h * h) * (to.bend - from.bend);
        third_ = 10.0 * place - 4.0 * slope + 0.5 * bend;
        fourth_ = 7.0 * slope - 15.0 * place - bend;
        fifth_ = 6.0 * place - 3.0 * slope + 0.5 * bend;
    }
    /// u and v after the share x of the step; also a little beyond 1.
    [[nodiscard]] Vec2 at(double x) const noexcept {
        return start_ + x * (first_ + x * (second_ + x * (third_ + x * (fourth_ + x * fifth_))));
    }

private:
    Vec2 start_, first_, second_, third_, fourth_, fifth_;
};

}  // namespace palpate::engine
