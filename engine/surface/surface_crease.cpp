#include <cmath>

#include "engine/surface/surface_ground.hpp"

namespace palpate::engine {
namespace {

/// Patches whose normals differ by less are smooth, rad.
constexpr double kSmooth = 1e-6;

}  // namespace

bool smooth(const Vec3& a, const Vec3& b) noexcept {
    const Vec3 turn = glm::cross(a, b);
    return glm::dot(turn, turn) < kSmooth * kSmooth && glm::dot(a, b) > 0.0;
}

bool SurfaceGround::leads_off(const SurfaceSpot& s) noexcept {
    const Vec2 way = parameters(s.jet, s.along);
    return leaves(s.place.u, way.x) || leaves(s.place.v, way.y);
}

Vec3 SurfaceGround::edge_of(const SurfaceSpot& s) noexcept {
    return at_end(s.place.u) ? s.jet.dv : s.jet.du;
}

/// By the side on which HIP is of all normals between theirs. Of two that are nearly opposite
/// nobody can tell.
SurfaceGround::Between SurfaceGround::between(const SurfaceSpot& a, const SurfaceSpot& b) noexcept {
    const double out = glm::dot(a.r, a.normal + b.normal);
    if (out > 1e-12 * std::sqrt(a.r2)) {
        return Between::tip;
    }
    return smooth(a.normal, b.normal) ? Between::smooth : Between::crease;
}

/// The same point on the patch beyond the edge along which it goes, or on which it is.
bool SurfaceGround::look_beyond(const Footing& at, SurfaceHeading& over, SurfaceSpot& s) noexcept {
    SurfacePlace p = at.spot.place;
    const bool in_u =
        at.way == Footing::Way::along_v || (at.way != Footing::Way::along_u && at_end(p.u));
    over = {in_u, (in_u ? p.u : p.v) == 1.0};
    if (!surface_.cross(p, over)) {
        return false;
    }
    look(p, s);
    return true;
}

bool SurfaceGround::leads_over(const SurfaceSpot& s, bool in_u) noexcept {
    const Vec2 way = parameters(s.jet, s.along);
    return in_u ? leaves(s.place.u, way.x) : leaves(s.place.v, way.y);
}

/// Of a way along an edge: both its sides bar the way over it, and both carry.
bool SurfaceGround::crease_beyond(const Footing& at) noexcept {
    SurfaceSpot other;
    SurfaceHeading over;
    if (!look_beyond(at, over, other)) {
        return false;
    }
    const bool from_u = at.way == Footing::Way::along_v;
    return leads_over(at.spot, from_u) && leads_over(other, over.in_u) &&
           between(at.spot, other) == Between::crease;
}

bool SurfaceGround::look_over_crease(const Footing& at, SurfaceSpot& other) noexcept {
    SurfaceHeading over;
    if (!look_beyond(at, over, other) || smooth(at.spot.normal, other.normal)) {
        return false;
    }
    const bool high = (over.in_u ? other.place.u : other.place.v) == 1.0;
    const Vec3 into = (high ? -1.0 : 1.0) * (over.in_u ? other.jet.du : other.jet.dv);
    return glm::dot(into, at.spot.normal) > 0.0;
}

/// Where its own patch leads on: in the cone of the other side of a crease it rests all the same,
/// and where both lead out of the crease it goes along the one behind which HIP is.
void SurfaceGround::ask_beyond_crease(Footing& at) noexcept {
    Footing next;
    if (!look_over_crease(at, next.spot) || !(next.spot.load > 0.0)) {
        return;
    }
    on_patch(next);
    if (next.way == Footing::Way::rests) {
        at = next;
        rest_in_crease(at);
    } else if (next.way == Footing::Way::open && at.spot.load <= 0.0) {
        at = next;
    }
}

/// In the cone of one side: that counts on whose side of all normals between theirs HIP is.
void SurfaceGround::rest_in_crease(Footing& at) noexcept {
    SurfaceSpot other;
    if (!look_over_crease(at, other)) {
        return;
    }
    at.crease = true;
    if (leads_off(at.spot) && leads_off(other)) {
        in_crease(at, edge_of(at.spot));
    } else if (leads_off(at.spot)) {
        at.spot = other;
        at.excess = other.excess;
    }
}

void SurfaceGround::against_hip(SurfaceSpot& s, const Vec3& way) const noexcept {
    const double length2 = glm::dot(way, way);
    const Vec3 left = length2 > 0.0 ? s.r - (glm::dot(s.r, way) / length2) * way : s.r;
    const double load = glm::length(left);
    feel(s, load > 0.0 ? left * (-1.0 / load) : s.normal, mu_);
}

void SurfaceGround::in_crease(Footing& at, const Vec3& way) const noexcept {
    against_hip(at.spot, way);
    at.crease = true;
    at.excess = at.spot.excess;
    if (at.way != Footing::Way::rests && !(at.excess > at.spot.rounding)) {
        at.way = Footing::Way::held;
    }
}

/// Where several edges meet: along one of them, which may be a crease, or held in a pit, or let go
/// by a tip.
void SurfaceGround::at_corner(Footing& best, const SurfaceObject::Around& all) noexcept {
    using Way = Footing::Way;
    const auto along_crease = [&](Way way) {
        const bool crease = crease_beyond({best.spot, way});
        if (crease) {
            in_crease(best, way == Way::along_u ? best.spot.jet.du : best.spot.jet.dv);
        }
        return crease;
    };
    if (best.way == Way::along_u || best.way == Way::along_v) {
        along_crease(best.way);
        return;
    }
    const bool rests = best.way == Way::rests && mu_ > 0.0 && all.open;
    if (best.way != Way::held && !rests) {
        return;
    }
    if (all.open) {  // at the end of a crease both its sides still carry
        static_cast<void>(along_crease(Way::along_u) || along_crease(Way::along_v));
        return;
    }
    if (!surface_.behind_edge(best.spot.place, best.spot.r)) {
        best.way = Way::over;
        return;
    }
    Vec3 steepest{};
    for (std::size_t k = 0; k < all.count; ++k) {
        const SurfaceSpot s = look(all.places[k]);
        for (const bool in_u : {true, false}) {
            const Vec3& edge = in_u ? s.jet.du : s.jet.dv;
            const double length = glm::length(edge);
            const double by = length > 0.0 ? glm::dot(s.r, edge) / length : 0.0;
            if (!leaves(in_u ? s.place.u : s.place.v, by) &&
                std::fabs(by) > glm::length(steepest)) {
                steepest = (by / length) * edge;
            }
        }
    }
    in_crease(best, steepest);
}

}  // namespace palpate::engine
