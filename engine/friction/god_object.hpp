#pragma once

#include "engine/contact/closest_point.hpp"
#include "engine/friction/cone_slide.hpp"
#include "engine/friction/cone_view.hpp"

namespace palpate::engine {

/// Budget of one tick's walk and the price of a vertex, the "vertex slew".
struct Slew {
    /// v_r, m/s: travel allowed beyond what HIP's own motion needs; 0: no slew
    double speed = 0.0;
    double radius = 0.0;  ///< rho_v, m of budget per radian of a convex vertex's fan

    /// There is no vertex slew.
    [[nodiscard]] bool none() const noexcept { return speed == 0.0; }
};

/// Where the god-object is. On a span it keeps the curve's jet, so that a tick in which it stays
/// costs no evaluation, and a proof that spares the next ticks the search.
struct GodObject {
    Place place{};
    Spot spot{};  ///< the same on a span, with all digits; unused on a seam
    FallProof proof{};
};

/// A god-object at `place`. @pre the place is one of `outline`
[[nodiscard]] GodObject god_object_at(const Outline& outline, const Place& place) noexcept;

/// The god-object after a walk, with what the force needs to know.
struct Walk {
    Vec2 point{};
    Vec2 normal{0.0, 1.0};  ///< unit: of the span, of the fan at phi, or of the internal fan
    Vec2 tangent{1.0, 0.0};
    double tau = 0.0;           ///< r . t, m
    double nu = 0.0;            ///< -r . n, m
    bool slid = false;          ///< the GO moved along a span, or turned in a fan
    bool outside_cone = false;  ///< stopped outside its cone: the budget ran out, or at an open end
    bool out_of_budget = false;
    bool unproven = false;     ///< broken off: rounding led the walk in a circle
    bool in_corner = false;    ///< rests in a concave vertex, whose two normals carry together
    bool met_corner = false;   ///< came by a concave vertex
    bool lost_beyond = false;  ///< in a fan for lack of budget alone: beyond, the contact ends

    /// The stretch and its frame, where the walk ends.
    void see(const ConeView& v) noexcept {
        tangent = v.tangent;
        normal = perp(v.tangent);
        tau = v.tau;
        nu = v.nu;
    }
};

/// Lets the god-object move along the outline to the first place where its stretch fits the
/// friction cone.
///
/// Along a span it slides (slide_to_cone). A convex vertex is a fan of normals from the end of one
/// span to the start of the next, turned through at `vertex_radius` of budget per radian; contact
/// ends where the normal that points at HIP lies in the fan. The budget flows evenly while HIP goes
/// from `from` to `h` in a straight line, so that what a vertex may spend begins at the moment at
/// which HIP drives the god-object over it: a corner feels the same at every rate. Where the
/// outline turns back beyond the vertex, as a step does, the way costs only the turn between its
/// two ends. A concave vertex is left only along a span whose drive exceeds mu times that span's
/// own load, while the other span alone does not hold the GO in its cone. An open end holds the GO
/// until HIP leaves. The direction never reverses within a walk, and on the way the stretch only
/// falls: each span is visited once.
///
/// @param from    HIP one tick ago, m
/// @param budget  travel allowed in this tick, m; infinite without slew
template <bool HasFriction>
[[nodiscard]] Walk walk_god_object(const ConeForms& forms,
                                   GodObject& go,
                                   const Vec2& from,
                                   const Vec2& h,
                                   double mu,
                                   double budget,
                                   double vertex_radius) noexcept;

/// The same where it nearly always goes: no further than within one free-form span, to the root of
/// an excess that is known to fall there.
/// @return false, and nothing moved, where it does not
template <bool HasFriction>
[[nodiscard, gnu::always_inline]] inline bool walk_on_span(const ConeForms& forms,
                                                           GodObject& go,
                                                           const Vec2& h,
                                                           double mu,
                                                           double budget,
                                                           Walk& walk) noexcept {
    const std::size_t span = go.place.index;
    if (go.place.on_seam || !forms.tame(span) || forms.outline().arc(span) != nullptr) {
        return false;
    }
    const double dir = drive_at(go.spot.jet, h).direction<HasFriction>(mu);
    if (dir != 0.0) {
        const FallProof& proof = go.proof;
        const double u = go.spot.u;
        if (proof.span != span || !(u > proof.lo && u < proof.hi) || !proof.holds(h)) {
            return false;
        }
        const Vec2 before = go.spot.jet.point;
        const FallingWay way{.curve = forms.outline().spans()[span],
                             .lo = proof.lo,
                             .hi = proof.hi,
                             .h = h,
                             .mu = mu,
                             .dir = dir};
        const FallEnd end = follow_fall<HasFriction>(way, go.spot, go.proof.bend,
                                                     fall_at<HasFriction>(go.spot.jet, h, mu, dir));
        const Vec2 chord = go.spot.jet.point - before;
        if (end != FallEnd::root || !(4.0 * glm::dot(chord, chord) <= budget * budget)) {
            go.spot = spot_at(way.curve, u, 1.0 - u);
            return false;
        }
        walk.slid = go.spot.u != u;
        go.place.parameter = go.spot.u;
    }
    const Vec2& along = go.spot.jet.first;
    const Vec2 tangent = along * (1.0 / std::sqrt(glm::dot(along, along)));
    const Vec2 r = h - go.spot.jet.point;
    walk.point = go.spot.jet.point;
    walk.tangent = tangent;
    walk.normal = perp(tangent);
    walk.tau = glm::dot(r, tangent);
    walk.nu = -cross(tangent, r);
    return true;
}

/// A contact that begins: the god-object stays at the closest point of HIP, where the stretch is
/// all load. @pre `place` is that point's, and HIP is inside
[[nodiscard]] Walk touch_down(const Outline& outline,
                              GodObject& go,
                              const Place& place,
                              const Vec2& h) noexcept;

}  // namespace palpate::engine
