#include "engine/surface/surface_ground.hpp"

#include <algorithm>
#include <cmath>
#include <new>

#include "engine/base/processor.hpp"

namespace palpate::engine {
namespace {

constexpr Work kSpotWork = 450;  ///< besides the evaluation

/// The way into the patch leads off it: what is left is along its edge, if anything.
bool barred(const Footing& f) noexcept {
    return f.way != Footing::Way::open && f.way != Footing::Way::rests;
}

}  // namespace

void SurfaceGround::look(const SurfacePlace& place, SurfaceSpot& s) noexcept {
    work_ += surface_.patch(place).work() + kSpotWork;
    s.place = {.i = place.i,
               .j = place.j,
               .u = snapped(place.u),
               .v = snapped(place.v),
               .surface = place.surface};
    ::new (&s.jet) SurfaceJet(surface_.local_jet(s.place));  // where it stays: a copy would wait
    as_this_processor_can([&] { measure(s); });
}

void SurfaceGround::measure(SurfaceSpot& s) const noexcept {
    s.r = h_ - s.jet.point;
    s.r2 = glm::dot(s.r, s.r);
    s.noise = 4.0 * kEpsilon * (glm::length(s.jet.point) + std::sqrt(s.r2));
    feel(s, surface_.normal_at(s.place, s.jet), mu_);
}

void SurfaceGround::own_normal(Footing& at) const noexcept {
    if (at.crease) {
        at.crease = false;
        measure(at.spot);
    }
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

void SurfaceGround::on_patch(Footing& at) const noexcept {
    const SurfaceSpot& s = at.spot;
    at.excess = s.excess;
    if (settled(s)) {
        at.way = Footing::Way::rests;
        return;
    }
    const Vec2 way = parameters(s.jet, s.along);
    const bool out_u = leaves(s.place.u, way.x);
    const bool out_v = leaves(s.place.v, way.y);
    if (!out_u && !out_v) {
        at.way = Footing::Way::open;
        return;
    }
    const double still = 1e-9 * surface_.size();  // an edge that stands still leads nowhere
    const auto drive = [&s, still](const Vec3& edge, double t) {
        const double length = glm::length(edge);
        const double by = length > still ? glm::dot(s.r, edge) / length : 0.0;
        return leaves(t, by) ? 0.0 : std::fabs(by);
    };
    const double by_v = out_u ? drive(s.jet.dv, s.place.v) : 0.0;
    const double by_u = out_v ? drive(s.jet.du, s.place.u) : 0.0;
    at.excess = std::max(by_u, by_v) - s.cone;
    at.way = !(at.excess > s.rounding) ? Footing::Way::held
           : by_u > by_v               ? Footing::Way::along_u
                                       : Footing::Way::along_v;
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

void SurfaceGround::footing(Footing& best) noexcept {
    on_patch(best);
    const SurfacePlace p = best.spot.place;
    const bool rests = best.way == Footing::Way::rests;
    if (!(at_end(p.u) || at_end(p.v))) {
        return;
    }
    const bool on_one_edge = at_end(p.u) != at_end(p.v);
    const bool pole = surface_.on_pole(p);
    if (rests && mu_ > 0.0) {
        if (on_one_edge && !pole) {
            rest_in_crease(best);
        } else if (!pole) {
            at_corner(best, surface_.around(p));
        }
        return;
    }
    if (!pole && best.way == Footing::Way::open) {
        if (on_one_edge && mu_ > 0.0) {
            ask_beyond_crease(best);
        }
        return;
    }
    const SurfaceObject::Around all = surface_.around(p);
    if (pole || all.pole) {  // of a neighbour: from either side the same is found
        best = rests ? best : at_pole(p);
        return;
    }
    const Vec3 edge = edge_of(best.spot);
    bool crease = false;
    for (std::size_t k = 1; k < all.count; ++k) {
        Footing next{look(all.places[k])};
        on_patch(next);
        // Both barred: along their edge both are driven alike, and the one that carries more
        // brakes.
        const bool brakes = on_one_edge && barred(next) && barred(best);
        if (on_one_edge && barred(best) && leads_off(next.spot)) {
            const Between sides = between(best.spot, next.spot);
            if (sides == Between::tip) {
                best = next;
                best.way = Footing::Way::over;
                return;
            }
            crease = crease || sides == Between::crease;
        }
        const bool takes = brakes ? next.spot.load > best.spot.load : better(next, best);
        best = takes ? next : best;
    }
    if (crease && best.way != Footing::Way::open) {
        in_crease(best, edge);
    } else if (on_one_edge && mu_ > 0.0 && best.way == Footing::Way::rests) {
        rest_in_crease(best);
    } else if (!on_one_edge) {
        at_corner(best, all);
    }
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
Footing SurfaceGround::at_pole(const SurfacePlace& place) noexcept {
    double steepest = -1e301;
    SurfacePlace found = place;
    bool found_in_u = false;
    const SurfaceObject::Around all = surface_.around(place);
    round_pole(all, [&](const SurfacePlace& p, bool in_u) {
        const double match = way_off(p, in_u);
        if (match > steepest) {
            steepest = match;
            found = p;
            found_in_u = in_u;
        }
    });
    Footing best{look(found), Footing::Way::held, 0.0};
    best.excess = steepest - best.spot.cone;
    const Vec3 way = found_in_u ? best.spot.jet.du : best.spot.jet.dv;
    if (settled(best.spot)) {
        best.way = Footing::Way::rests;
    } else if (best.excess > best.spot.rounding) {
        best.way = found_in_u ? Footing::Way::along_u : Footing::Way::along_v;
    }
    for (std::size_t m = 0; m < all.count; ++m) {
        const SurfacePlace& p = all.places[m];
        const bool on_pole = surface_.on_pole(p);
        Footing next{look(p)};
        on_patch(next);
        if (!on_pole || next.way == Footing::Way::held) {
            best = better(next, best) ? next : best;
        }
    }
    if (best.way == Footing::Way::held && !all.open) {
        Vec3 outwards{};
        round_pole(all, [&](const SurfacePlace& p, bool) { outwards += look(p).normal; });
        if (glm::dot(best.spot.r, outwards) > 0.0) {
            best.way = Footing::Way::over;
        } else {
            in_crease(best, steepest > 0.0 ? way : Vec3{});
        }
    }
    return best;
}

/// Looks at places all round a pole.
template <class Ask>
void SurfaceGround::round_pole(const SurfaceObject::Around& all, const Ask& ask) const noexcept {
    constexpr int kPerPatch = 8;
    for (std::size_t m = 0; m < all.count; ++m) {
        const SurfacePlace& end = all.places[m];
        const bool in_u = surface_.pole(true, end);
        const bool begins = (in_u ? end.j : end.i) == 0 && (in_u ? end.v : end.u) == 0.0;
        if (!surface_.on_pole(end) || !begins) {
            continue;  // each pole once
        }
        const NurbsSurface& patches = surface_.surface_of(end);
        const std::size_t count = in_u ? patches.columns() : patches.rows();
        for (std::size_t k = 0; k < count; ++k) {
            for (int step = 0; step <= kPerPatch; ++step) {
                SurfacePlace p = end;
                (in_u ? p.j : p.i) = k;
                (in_u ? p.v : p.u) = static_cast<double>(step) / kPerPatch;
                ask(p, in_u);
            }
        }
    }
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

bool SurfaceGround::to_pole(SurfacePlace& p) const noexcept {
    for (const bool in_u : {true, false}) {
        SurfacePlace at = p;
        double& t = in_u ? at.u : at.v;
        t = t < 0.5 ? 0.0 : 1.0;
        if (surface_.pole(in_u, at)) {
            p = at;
            return true;
        }
    }
    return false;
}

}  // namespace palpate::engine
