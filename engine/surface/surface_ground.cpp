#include "engine/surface/surface_ground.hpp"

#include <cmath>
#include <limits>

namespace palpate::engine {
namespace {

/// The last bits before an edge belong to it: there the next patch, or the border, takes over.
double snapped(double t) noexcept {
    return t < 8.0 * kEpsilon ? 0.0 : t > 1.0 - 8.0 * kEpsilon ? 1.0 : t;
}

bool collapsed(const NurbsSurface& surface, const Vec3& edge) noexcept {
    return glm::length(edge) <= 1e-9 * surface.size();
}

}  // namespace

SurfaceSpot SurfaceGround::look(SurfacePlace place) const noexcept {
    place.u = snapped(place.u);
    place.v = snapped(place.v);
    SurfaceSpot s;
    s.place = place;
    s.jet = surface_.local_jet(place);
    s.normal = surface_.normal_at(place, s.jet);
    const Vec3 r = h_ - s.jet.point;
    const Stretch<3> parts = stretch<3>(r, s.normal);
    s.r2 = glm::dot(r, r);
    s.along = parts.tangential;
    s.length = parts.length;
    s.load = parts.load;
    s.cone = cone_radius<true>(mu_, s.load);
    s.excess = s.length - s.cone;
    return s;
}

double SurfaceGround::tolerance(const SurfaceSpot& s) noexcept {
    return 1e-14 * s.cone + 4.0 * kEpsilon * (glm::length(s.jet.point) + std::sqrt(s.r2));
}

bool SurfaceGround::settled(const SurfaceSpot& s) noexcept {
    const double rounding = tolerance(s);
    return s.excess <= 0.0 || (s.cone <= rounding && s.length <= 2.0 * rounding);
}

Vec2 SurfaceGround::parameters(const SurfaceJet& j, const Vec3& t) noexcept {
    const double e = glm::dot(j.du, j.du);
    const double f = glm::dot(j.du, j.dv);
    const double g = glm::dot(j.dv, j.dv);
    const double a = glm::dot(j.du, t);
    const double b = glm::dot(j.dv, t);
    const double det = e * g - f * f;
    if (det > 1e-20 * e * g && det > 0.0) {
        return Vec2{(g * a - f * b) / det, (e * b - f * a) / det};
    }
    return Vec2{e > 0.0 ? a / e : 0.0, g > 0.0 ? b / g : 0.0};
}

bool SurfaceGround::blocked_u(const SurfaceSpot& s, double du) const noexcept {
    const SurfacePlace& p = s.place;
    SurfacePlace beyond = p;
    return ((p.u == 0.0 && du < 0.0) || (p.u == 1.0 && du > 0.0)) &&
           (!surface_.cross_u(beyond, du > 0.0) || pushes_back(s, beyond, true));
}
bool SurfaceGround::blocked_v(const SurfaceSpot& s, double dv) const noexcept {
    const SurfacePlace& p = s.place;
    SurfacePlace beyond = p;
    return ((p.v == 0.0 && dv < 0.0) || (p.v == 1.0 && dv > 0.0)) &&
           (!surface_.cross_v(beyond, dv > 0.0) || pushes_back(s, beyond, false));
}

bool SurfaceGround::pushes_back(const SurfaceSpot& here,
                                const SurfacePlace& beyond,
                                bool in_u) const noexcept {
    const SurfaceSpot s = look(beyond);
    if (glm::length(s.normal - here.normal) <= 1e-9) {
        return false;  // smooth: the slope is the same on both sides, to rounding
    }
    const Vec2 way = parameters(s.jet, s.along);
    return in_u ? (beyond.u == 0.0 ? way.x < 0.0 : way.x > 0.0)
                : (beyond.v == 0.0 ? way.y < 0.0 : way.y > 0.0);
}

bool SurfaceGround::between(SurfacePlace p) const noexcept {
    return ((p.u == 0.0 || p.u == 1.0) && surface_.cross_u(p, p.u == 1.0)) ||
           ((p.v == 0.0 || p.v == 1.0) && surface_.cross_v(p, p.v == 1.0));
}

bool SurfaceGround::turn_at_pole(SurfaceSpot& s) const noexcept {
    const bool in_u = (s.place.u == 0.0 || s.place.u == 1.0) && collapsed(surface_, s.jet.dv);
    const bool in_v = (s.place.v == 0.0 || s.place.v == 1.0) && collapsed(surface_, s.jet.du);
    if (!(in_u || in_v) || !(s.length > 0.0)) {
        return false;
    }
    double best = -1e301;
    SurfacePlace found = s.place;
    const std::size_t patches = in_u ? surface_.columns() : surface_.rows();
    constexpr int kPerPatch = 8;
    for (std::size_t k = 0; k < patches; ++k) {
        for (int step = 0; step <= kPerPatch; ++step) {
            SurfacePlace p = s.place;
            (in_u ? p.j : p.i) = k;
            (in_u ? p.v : p.u) = static_cast<double>(step) / kPerPatch;
            const double match = way_off(p, in_u, s.along);
            if (match > best) {
                best = match;
                found = p;
            }
        }
    }
    s = look(found);
    return true;
}

/// Part of the unit vector that leads from an edge into the surface along `t`.
double SurfaceGround::way_off(const SurfacePlace& p, bool in_u, const Vec3& t) const noexcept {
    const SurfaceJet jet = surface_.local_jet(p);
    const double side = (in_u ? p.u : p.v) == 0.0 ? 1.0 : -1.0;
    const Vec3 inwards = side * (in_u ? jet.du : jet.dv);
    const double length = glm::length(inwards);
    return length > 0.0 ? glm::dot(inwards, t) / length : -1e300;
}

}  // namespace palpate::engine
