#include "engine/surface/surface_ground.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::engine {
namespace {

constexpr Work kSpotWork = 450;  ///< besides the evaluation

/// The way into the patch leads off it: what is left is along its edge, if anything.
bool barred(const Footing& f) noexcept {
    return f.way != Footing::Way::open && f.way != Footing::Way::rests;
}

}  // namespace

SurfaceSpot SurfaceGround::look(SurfacePlace place) noexcept {
    work_ += surface_.patch(place).work() + kSpotWork;
    place.u = snapped(place.u);
    place.v = snapped(place.v);
    const SurfaceJet jet = surface_.local_jet(place);
    const Vec3 normal = surface_.normal_at(place, jet);
    const Vec3 r = h_ - jet.point;
    const Stretch<3> parts = stretch<3>(r, normal);
    const double r2 = glm::dot(r, r);
    const double cone = cone_radius<true>(mu_, parts.load);
    const double noise = 4.0 * kEpsilon * (glm::length(jet.point) + std::sqrt(r2));
    return {.place = place,  // every member is named, for else g++ clears them all first
            .jet = jet,
            .normal = normal,
            .r = r,
            .r2 = r2,
            .along = parts.tangential,
            .length = parts.length,
            .load = parts.load,
            .cone = cone,
            .excess = parts.length - cone,
            .noise = noise,
            .rounding = 1e-14 * cone + noise};
}

double SurfaceGround::turn(const SurfaceSpot& s) const noexcept {
    const SurfaceJet& j = s.jet;
    const double a = glm::length(j.du);
    const double b = glm::length(j.dv);
    const double area = glm::length(glm::cross(j.du, j.dv));
    return std::sqrt(s.r2) * std::min(kEpsilon * surface_.size() * (a + b) / (area + 1e-300), 1e-9);
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

Footing SurfaceGround::on_patch(const SurfaceSpot& s) const noexcept {
    if (settled(s)) {
        return {s, Footing::Way::rests, s.excess};
    }
    const Vec2 way = parameters(s.jet, s.along);
    const bool out_u = leaves(s.place.u, way.x);
    const bool out_v = leaves(s.place.v, way.y);
    if (!out_u && !out_v) {
        return {s, Footing::Way::open, s.excess};
    }
    const double still = 1e-9 * surface_.size();  // an edge that stands still leads nowhere
    const auto drive = [&s, still](const Vec3& edge, double at) {
        const double length = glm::length(edge);
        const double by = length > still ? glm::dot(s.r, edge) / length : 0.0;
        return leaves(at, by) ? 0.0 : std::fabs(by);
    };
    const double by_v = out_u ? drive(s.jet.dv, s.place.v) : 0.0;
    const double by_u = out_v ? drive(s.jet.du, s.place.u) : 0.0;
    const double excess = std::max(by_u, by_v) - s.cone;
    if (!(excess > s.rounding)) {
        return {s, Footing::Way::held, excess};
    }
    return {s, by_u > by_v ? Footing::Way::along_u : Footing::Way::along_v, excess};
}

/// Which of two patches decides: the one in whose cone the GO is, then the one into which its drive
/// leads, then the one that leads on along their edge, then the one that carries; of two in which
/// it rests that on which it is, or a sheet that lies on itself would turn over. Without friction
/// there is no cone to rest in while another leads on, by more than a foot looks different from the
/// other side.
int SurfaceGround::rank(const Footing& f) const noexcept {
    if (f.way == Footing::Way::held) {
        return 0;
    }
    const bool leads = mu_ == 0.0 && f.excess > 1e-9 * surface_.size();
    const bool flows = mu_ > 0.0 && f.way == Footing::Way::open;
    return f.way == Footing::Way::rests ? 3 : leads ? 4 : flows ? 2 : 1;
}

Footing SurfaceGround::footing(const SurfaceSpot& s) noexcept {
    Footing best = on_patch(s);
    const SurfacePlace& p = s.place;
    const bool rests = best.way == Footing::Way::rests;
    if ((rests && mu_ > 0.0) || !(at_end(p.u) || at_end(p.v))) {
        return best;
    }
    if (surface_.pole_u(p) || surface_.pole_v(p)) {
        return rests ? best : at_pole(s);
    }
    if (best.way == Footing::Way::open) {
        return best;
    }
    const SurfaceObject::Around all = surface_.around(p);
    if (all.pole) {  // of a neighbour: from either side the same is found
        return rests ? best : at_pole(s);
    }
    const bool on_one_edge = at_end(p.u) != at_end(p.v);
    for (std::size_t k = 1; k < all.count; ++k) {
        const Footing next = on_patch(look(all.places[k]));
        // Both barred: along their edge both are driven alike, and the one that carries more
        // brakes.
        const bool brakes = on_one_edge && barred(next) && barred(best);
        const bool takes = brakes ? next.spot.load > best.spot.load : better(next, best);
        best = takes ? next : best;
    }
    return best;
}

Footing SurfaceGround::carrier(const SurfaceSpot& s) noexcept {
    Footing best{s, Footing::Way::held, s.excess};
    const SurfaceObject::Around all = surface_.around(s.place);
    for (std::size_t k = 1; k < all.count; ++k) {
        const SurfaceSpot next = look(all.places[k]);
        if (next.load > best.spot.load) {
            best = {next, Footing::Way::held, next.excess};
        }
    }
    return best;
}

bool SurfaceGround::better(const Footing& next, const Footing& best) const noexcept {
    const int by = rank(next) - rank(best);
    return by > 0 || (by == 0 && best.way != Footing::Way::rests &&
                      (next.way == Footing::Way::held ? next.spot.load > best.spot.load
                                                      : next.excess > best.excess));
}

/// On an edge that is one point: the place on it from which the surface goes on along the stretch,
/// within 6 degrees, or one of the other patches that meet there.
Footing SurfaceGround::at_pole(const SurfaceSpot& s) noexcept {
    double steepest = -1e301;
    SurfacePlace found = s.place;
    bool found_in_u = false;
    constexpr int kPerPatch = 8;
    const SurfaceObject::Around all = surface_.around(s.place);
    for (std::size_t m = 0; m < all.count; ++m) {
        const SurfacePlace& end = all.places[m];
        const bool in_u = surface_.pole_u(end);
        if (!in_u && !surface_.pole_v(end)) {
            continue;
        }
        const NurbsSurface& patches = surface_.surface_of(end);
        const bool begins = (in_u ? end.j : end.i) == 0 && (in_u ? end.v : end.u) == 0.0;
        if (!begins) {
            continue;  // each pole once
        }
        const std::size_t count = in_u ? patches.columns() : patches.rows();
        for (std::size_t k = 0; k < count; ++k) {
            for (int step = 0; step <= kPerPatch; ++step) {
                SurfacePlace p = end;
                (in_u ? p.j : p.i) = k;
                (in_u ? p.v : p.u) = static_cast<double>(step) / kPerPatch;
                const double match = way_off(p, in_u);
                if (match > steepest) {
                    steepest = match;
                    found = p;
                    found_in_u = in_u;
                }
            }
        }
    }
    Footing best{look(found), Footing::Way::held, 0.0};
    best.excess = steepest - best.spot.cone;
    if (settled(best.spot)) {
        best.way = Footing::Way::rests;
    } else if (best.excess > best.spot.rounding) {
        best.way = found_in_u ? Footing::Way::along_u : Footing::Way::along_v;
    }
    for (std::size_t m = 0; m < all.count; ++m) {
        const SurfacePlace& p = all.places[m];
        const bool on_pole = surface_.pole_u(p) || surface_.pole_v(p);
        const Footing next = on_patch(look(p));
        if (!on_pole || next.way == Footing::Way::held) {
            best = better(next, best) ? next : best;
        }
    }
    return best;
}

/// Part of the stretch along the way from an edge into the surface.
double SurfaceGround::way_off(const SurfacePlace& p, bool in_u) noexcept {
    work_ += surface_.patch(p).work();
    const SurfaceJet jet = surface_.local_jet(p);
    const double side = (in_u ? p.u : p.v) == 0.0 ? 1.0 : -1.0;
    const Vec3 inwards = side * (in_u ? jet.du : jet.dv);
    const double length = glm::length(inwards);
    return length > 0.0 ? glm::dot(inwards, h_ - jet.point) / length : -1e300;
}

bool SurfaceGround::enclosed(const SurfacePlace& p) const noexcept {
    return !surface_.around(p).open;
}

bool SurfaceGround::to_pole(SurfacePlace& p) const noexcept {
    SurfacePlace at = p;
    at.u = p.u < 0.5 ? 0.0 : 1.0;
    if (surface_.pole_u(at)) {
        p = at;
        return true;
    }
    at = p;
    at.v = p.v < 0.5 ? 0.0 : 1.0;
    if (surface_.pole_v(at)) {
        p = at;
        return true;
    }
    return false;
}

}  // namespace palpate::engine
