#include "engine/surface/surface_fan.hpp"

#include <algorithm>
#include <cmath>

#include "engine/math/elementary.hpp"

namespace palpate::engine {
namespace {

constexpr int kAlongSteps = 12;

/// The normals between two of one edge, and the ways square to them and to it.
struct Normals {
    Vec3 first{};
    Vec3 onwards{};  ///< unit, square to `first`, towards the other patch
    double turn = 0.0;

    Normals(const Vec3& a, const Vec3& b) noexcept : first(a) {
        const double along = glm::dot(a, b);
        const Vec3 rest = b - along * a;
        const double across = glm::length(rest);
        onwards = across > 0.0 ? rest / across : Vec3{};
        turn = arc_tan2(across, along);
    }
    [[nodiscard]] Vec3 normal(double angle) const noexcept {
        const SinCos t = sin_cos(angle);
        return t.cos * first + t.sin * onwards;
    }
    [[nodiscard]] Vec3 way(double angle) const noexcept {
        const SinCos t = sin_cos(angle);
        return t.cos * onwards - t.sin * first;
    }
};

SurfaceSpot with_normal(SurfaceSpot s, const Vec3& normal, double mu) noexcept {
    feel(s, normal, mu);
    return s;
}

/// The edge of `place` over which `beyond` lies.
bool edge_between(const SurfaceObject& object,
                  const SurfacePlace& place,
                  const SurfacePlace& beyond,
                  SurfaceHeading& edge) noexcept {
    for (const bool in_u : {true, false}) {
        const double at = in_u ? place.u : place.v;
        if (at != 0.0 && at != 1.0) {
            continue;
        }
        SurfacePlace there = place;
        SurfaceHeading way{in_u, at == 1.0};
        if (object.cross(there, way) && there.surface == beyond.surface && there.i == beyond.i &&
            there.j == beyond.j) {
            edge = {in_u, at == 1.0};
            return true;
        }
    }
    return false;
}

/// Along the edge over the end of its patches, at the same share of the fan; false at a corner.
bool over_end(SurfaceGround& ground,
              SurfacePlace& place,
              SurfaceFan& fan,
              const SurfaceHeading& edge,
              SurfaceHeading way,
              double turn) noexcept {
    SurfacePlace next = place;
    const bool on = ground.surface().cross(next, way) && way.in_u != edge.in_u;
    SurfacePlace beyond = next;
    SurfaceHeading over = edge;
    if (!on || next.surface != place.surface || !ground.surface().cross(beyond, over)) {
        return false;  // a corner
    }
    const double share = fan.angle / turn;
    place = next;
    fan.beyond = beyond;
    fan.angle = share * Normals(ground.look(place).normal, ground.look(beyond).normal).turn;
    return true;
}

/// One step along the edge, or over the end of a patch of it; false when there is none.
bool step_along(SurfaceGround& ground,
                SurfacePlace& place,
                SurfaceFan& fan,
                SurfaceSlew& slew) noexcept {
    const SurfaceObject& object = ground.surface();
    SurfaceHeading edge;
    if (!edge_between(object, place, fan.beyond, edge)) {
        return false;
    }
    const SurfaceSpot own = ground.look(place);
    const Normals normals(own.normal, ground.look(fan.beyond).normal);
    const SurfaceSpot s =
        with_normal(own, normals.normal(std::min(fan.angle, normals.turn)), ground.mu());
    const Vec3 e = edge.in_u ? s.jet.dv : s.jet.du;
    const Vec3 bend = edge.in_u ? s.jet.dvv : s.jet.duu;
    const double speed2 = glm::dot(e, e);
    const double speed = std::sqrt(speed2);
    const double ahead = speed > 0.0 ? glm::dot(s.r, e) / speed : 0.0;
    // Of the excess, which has the direction of the stretch, the part along the edge.
    const double excess = s.length > 0.0 ? std::fabs(ahead) * (s.excess / s.length) : 0.0;
    if (!(excess > 4.0 * s.rounding) || slew.spent()) {
        return false;
    }
    const bool forward = ahead > 0.0;
    double& t = edge.in_u ? place.v : place.u;
    if (t == (forward ? 1.0 : 0.0)) {
        return over_end(ground, place, fan, edge, {!edge.in_u, forward}, normals.turn);
    }
    // The second derivative of |r|^2 / 2 along the edge, per m^2, with the friction that comes
    // along.
    const double rate = std::max(1.0 - glm::dot(s.r, bend) / speed2, 0.25);
    const double step = std::min(excess / rate, slew.budget - slew.used);
    SurfacePlace next = place;
    double& there = edge.in_u ? next.v : next.u;
    there = std::clamp(there + (forward ? step : -step) / speed, 0.0, 1.0);
    if (there == t) {
        return false;
    }
    const SurfaceSpot spot = ground.look(next);
    if (!(spot.r2 < s.r2)) {
        return false;
    }
    SurfacePlace beyond = spot.place;
    SurfaceHeading over = edge;
    if (!object.cross(beyond, over)) {
        return false;
    }
    slew.used += glm::length(spot.jet.point - s.jet.point);
    place = spot.place;
    fan.beyond = beyond;
    return true;
}

/// When what changes linearly from `then` to `now` is 0, as a share of the way.
double since(double then, double now) noexcept {
    return then < 0.0 ? then / (then - now) : 0.0;
}

}  // namespace

bool falls_away(const SurfaceSpot& a, const SurfaceSpot& b) noexcept {
    if (smooth(a.normal, b.normal)) {
        return false;
    }
    Vec3 into{};
    const auto add = [&into](double at, const Vec3& along) {
        into += at == 0.0 ? along : at == 1.0 ? -along : Vec3{};
    };
    add(b.place.u, b.jet.du);
    add(b.place.v, b.jet.dv);
    return glm::dot(into, a.normal) < 0.0;
}

FanTurn turn_in_fan(SurfaceGround& ground,
                    const SurfacePlace& from,
                    SurfaceFan& fan,
                    SurfaceSlew& slew) noexcept {
    SurfacePlace place = from;
    SurfaceSlew along =
        slew;  // a budget of its own: a hand along an edge does not keep it from turning
    for (int k = 0; k < kAlongSteps && step_along(ground, place, fan, along); ++k) {
    }
    const SurfaceSpot own = ground.look(place);
    const SurfaceSpot other = ground.look(fan.beyond);
    const Normals normals(own.normal, other.normal);
    fan.angle = std::min(fan.angle, normals.turn);
    const auto felt = [&] {
        return with_normal(own, normals.normal(fan.angle), ground.mu());
    };
    SurfaceSpot s = felt();
    const Vec3 way = normals.way(fan.angle);
    const double tau = glm::dot(s.r, way);
    const double dir = tau < 0.0 ? -1.0 : 1.0;
    if (SurfaceGround::settled(s) || (slew.direction != 0.0 && dir != slew.direction)) {
        return {FanTurn::End::rests, s};
    }
    slew.direction = dir;
    // Drive and excess are linear in the share of the tick: what the edge may use begins where both
    // are there.
    const Vec3 before = slew.from - s.jet.point;
    const double drive_then = dir * glm::dot(before, way);
    const Stretch<3> then = stretch<3>(before, s.normal);
    const double stretch_then = then.length - std::fabs(drive_then) + drive_then;
    slew.used =
        std::max(slew.used, slew.budget * std::max(since(drive_then, dir * tau),
                                                   since(stretch_then - ground.mu() * then.load,
                                                         s.length - ground.mu() * s.load)));
    if (slew.spent()) {
        return {FanTurn::End::spent, s};
    }
    const double to = dir > 0.0 ? normals.turn : 0.0;
    const double far_tau = glm::dot(s.r, normals.way(to));
    const double far_load = -glm::dot(s.r, normals.normal(to));
    const bool over_tip = dir * far_tau <= 0.0 && (s.load < 0.0 || far_load < std::fabs(far_tau));
    const double price = slew.radius * std::fabs(to - fan.angle);
    const bool pays = price <= slew.budget - slew.used;
    if (over_tip && (pays || s.load < 0.0)) {
        fan.on = false;
        s.load = -std::sqrt(s.r2);
        return {FanTurn::End::ended, s};
    }
    if (!pays) {
        fan.angle += dir * (slew.budget - slew.used) / slew.radius;
        slew.used = slew.budget;
        s = felt();
        const bool out = s.excess > 0.0 && dir * glm::dot(s.r, normals.way(fan.angle)) > 0.0;
        return {out ? FanTurn::End::spent : FanTurn::End::rests, s};
    }
    slew.used += price;
    fan.on = false;
    return dir > 0.0 ? FanTurn{FanTurn::End::beyond, other} : FanTurn{FanTurn::End::back, own};
}

}  // namespace palpate::engine
