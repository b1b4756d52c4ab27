#pragma once

#include <algorithm>
#include <cmath>

#include "engine/friction/god_object.hpp"
#include "engine/geometry/pair.hpp"

namespace palpate::engine {

/// Excess of a slide as fall_at() has it, and what it is made of.
template <bool HasFriction>
struct PairFall {
    Pair r;  ///< HIP - GO
    double load;
    double tangential;

    PairFall(const PairJet& jet, Pair h) noexcept
        : r(h - jet.point), load(-cross(jet.first, r)), tangential(dot(r, jet.first)) {}
    [[nodiscard]] double excess(double mu, double dir) const noexcept {
        return dir * tangential - cone_radius<HasFriction>(mu, load);
    }
    [[nodiscard]] double slope(const PairJet& jet, double mu, double dir) const noexcept {
        const double slope = dot(jet.first, jet.first) - dot(r, jet.second);
        return HasFriction && load > 0.0 ? slope - dir * mu * cross(jet.second, r) : slope;
    }
};

/// The walk ends at a jet, with the stretch r. @return false: it is no load, and the contact ends
[[nodiscard]] inline bool settles(const PairJet& jet, Pair r, Walk& walk) noexcept {
    const Pair tangent = jet.first * (1.0 / std::sqrt(dot(jet.first, jet.first)));
    put(jet.point, walk.point);
    put(tangent, walk.tangent);
    walk.normal = perp(walk.tangent);
    walk.tau = dot(r, tangent);
    walk.nu = -cross(tangent, r);
    return walk.nu > 0.0;
}

/// The walk as it nearly always is: on one cubic, stuck, or by one step and a last one to the root
/// of an excess that is known to fall there. Straight on, so that its numbers stay in registers.
/// @param cubic  the span of the god-object
/// @return false, and nothing moved, where it takes more than that
template <bool HasFriction, bool HasSlew>
[[nodiscard, gnu::always_inline]] inline bool walk_at_once(const Cubic& cubic,
                                                           GodObject& go,
                                                           const Vec2& hip,
                                                           double mu,
                                                           double budget,
                                                           Walk& walk) noexcept {
    const Pair h = pair(hip);
    PairJet jet(go.spot.jet);
    PairFall<HasFriction> fall(jet, h);
    const double dir = fall.tangential < 0.0 ? -1.0 : 1.0;
    const double outside = fall.excess(mu, dir);
    const double rest = HasFriction ? 0.0 : 4.0 * kEpsilon * dot(jet.first, jet.first);
    const bool slides = !(outside <= rest);
    double u = 0.0;
    Bend bend = go.proof.bend;
    if (slides) {
        const FallProof& proof = go.proof;
        const double start = go.spot.u;
        if (proof.span != go.place.index || !(start > proof.lo && start < proof.hi) ||
            !proof.holds(hip)) {
            return false;
        }
        const double slope = fall.slope(jet, mu, dir);
        const double near = start + bend.step(dir * (outside / slope));
        if (!(slope > 0.0 && near > proof.lo && near < proof.hi)) {
            return false;
        }
        const PairJet beside(cubic, near);
        const PairFall<HasFriction> left(beside, h);
        const double after = left.slope(beside, mu, dir);
        const double newton = dir * (left.excess(mu, dir) / after);
        if (!(std::fabs(newton) <= falling::kShort)) {
            return false;
        }
        u = std::clamp(near + (bend.step(newton) + dir * falling::kNudge), proof.lo, proof.hi);
        jet = PairJet(cubic, beside, u - near);
        fall = PairFall<HasFriction>(jet, h);
        const double excess = fall.excess(mu, dir);
        if (!(excess <= 0.0 && excess >= -falling::kRoot * slope)) {
            return false;
        }
        const Pair chord = jet.point - pair(go.spot.jet.point);
        if (HasSlew && !(4.0 * dot(chord, chord) <= budget * budget)) {
            return false;
        }
        bend.see(slope, after, near - start);
    }
    if (!settles(jet, fall.r, walk)) {
        return false;
    }
    if (slides) {
        walk.slid = u != go.spot.u;
        go.spot.u = u;
        go.spot.rest = 1.0 - u;
        jet.put(go.spot.jet);
        go.place.parameter = u;
        go.proof.bend = bend;
    }
    return true;
}

/// The same on an arc: stuck, or by the root of its closed form.
template <bool HasFriction, bool HasSlew>
[[nodiscard, gnu::always_inline]] inline bool walk_at_once(
    const Arc& arc, GodObject& go, const Vec2& h, double mu, double budget, Walk& walk) noexcept {
    Spot spot = go.spot;
    Drive drive = drive_at(arc, spot.jet, h);
    const double dir = drive.direction<HasFriction>(mu);
    if (dir != 0.0) {
        const Vec2 gap = h - spot.jet.point;
        const double start = spot.u - spot.rest;
        double d =
            start + dir * way_to_root(arc, arc.excess(h, mu, dir), start, dir, glm::dot(gap, gap));
        double nudge = kEpsilon;
        int nudges = 0;
        do {  // while the place is still on the outer side of the root
            if (!(dir * d < 1.0) || nudges == falling::kMaxNudges) {
                return false;
            }
            ++nudges;
            spot = spot_at(arc, 0.5 + 0.5 * d, 0.5 - 0.5 * d);
            drive = drive_at(arc, spot.jet, h);
            d += dir * nudge;
            nudge *= 4.0;
        } while (drive.direction<HasFriction>(mu) == dir);
        if constexpr (HasSlew) {
            const Vec2 way = spot.jet.point - go.spot.jet.point;
            if (!(budget > 0.0 && surely_pays(way, budget))) {
                return false;
            }
        }
    }
    if (!(drive.load > 0.0)) {
        return false;
    }
    walk.point = spot.jet.point;
    walk.tangent = spot.jet.first;
    walk.normal = perp(walk.tangent);
    walk.tau = drive.tangential;
    walk.nu = drive.load;
    if (dir != 0.0) {
        walk.slid = spot.u != go.spot.u || spot.rest != go.spot.rest;
        go.spot = spot;
        go.place.parameter = spot.u;
    }
    return true;
}

}  // namespace palpate::engine
