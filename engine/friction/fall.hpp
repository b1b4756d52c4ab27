#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "engine/friction/friction_law.hpp"
#include "engine/geometry/rational_bezier.hpp"
#include "engine/math/bend.hpp"

namespace palpate::engine {

/// A place on a span. 1 - u is kept too: beside a heavy last control point u has lost its digits.
struct Spot {
    double u = 0.0;
    double rest = 1.0;  ///< 1 - u
    Jet<2> jet{};       ///< of the curve there
};

/// A place on the curve by u and 1 - u, with point and two derivatives.
[[nodiscard]] inline Spot spot_at(const RationalBezier<2>& curve, double u, double rest) noexcept {
    return {.u = u, .rest = rest, .jet = curve.at(u, rest)};
}

/// Excess dir tau - mu max(nu, 0) in the direction of a slide, and how fast it falls with u; both
/// times |C'|.
struct Fall {
    double excess = 0.0;
    double slope = 0.0;
};

/// Of the god-object at `jet`, held by HIP at h (m). Load below 0 has no cone.
/// @param mu   >= 0, not read without friction
/// @param dir  +1: towards larger u, -1: towards smaller
template <bool HasFriction>
[[nodiscard, gnu::always_inline]] inline Fall fall_at(const Jet<2>& jet,
                                                      const Vec2& h,
                                                      double mu,
                                                      double dir) noexcept {
    const Vec2 r = h - jet.point;
    const double load = -cross(jet.first, r);
    Fall fall{.excess = dir * glm::dot(r, jet.first) - cone_radius<HasFriction>(mu, load),
              .slope = glm::dot(jet.first, jet.first) - glm::dot(r, jet.second)};
    if constexpr (HasFriction) {
        fall.slope -= load > 0.0 ? dir * mu * cross(jet.second, r) : 0.0;
    }
    return fall;
}

/// A slide over a part [lo, hi] of a span, in which the excess has one root at most.
struct FallingWay {
    const RationalBezier<2>& curve;
    double lo = 0.0;
    double hi = 1.0;
    Vec2 h{};
    double mu = 0.0;
    double dir = 0.0;  ///< +1 or -1

    /// The end that the slide goes to.
    [[nodiscard]] double end() const noexcept { return dir > 0.0 ? hi : lo; }
};

/// Where following an excess ended: at its root, at the end of the part, still outside, or nowhere:
/// nothing moved.
enum class FallEnd : std::uint8_t { root, end, lost };

namespace falling {

/// Newton's steps under a proof; 1 and a last one are usual.
inline constexpr int kMaxSteps = 24;

/// A step of u up to this is tried as the last on a curve that is its Taylor series.
inline constexpr double kShort = 0x1p-12;

/// And is the last if it ends no further from the root, in u.
inline constexpr double kRoot = 0x1p-46;

/// The last nudge over the root grows by 4 at a time: 2^19 last bits of u are 1e-10 of the span.
inline constexpr double kNudge = 2.0 * kEpsilon;
inline constexpr int kMaxNudges = 10;

/// The last step, and then bit by bit over the root, so that a hand at rest finds the contact
/// stuck. @param deepest  least excess in the cone that is still at the root
/// @return false, and nothing moved, if that does not lead there
template <bool HasFriction>
[[gnu::always_inline]] inline bool finish(const FallingWay& way,
                                          Spot& spot,
                                          double step,
                                          double deepest) noexcept {
    double nudge = kNudge;
    for (int i = 0; i < kMaxNudges; ++i) {
        const double next = std::clamp(spot.u + (step + way.dir * nudge), way.lo, way.hi);
        const Jet<2> jet = way.curve.beside(spot.jet, next - spot.u);
        const double excess = fall_at<HasFriction>(jet, way.h, way.mu, way.dir).excess;
        if (excess <= 0.0) {
            if (!(excess >= deepest)) {
                return false;
            }
            spot = {.u = next, .rest = 1.0 - next, .jet = jet};
            return true;
        }
        nudge *= 4.0;
    }
    return false;
}

}  // namespace falling

/// Newton's iteration to the one root that the way may have, its first steps bent as the excess was
/// bent when last followed.
/// @param at  of the spot
template <bool HasFriction>
[[nodiscard, gnu::always_inline]] inline FallEnd follow_fall(const FallingWay& way,
                                                             Spot& spot,
                                                             Bend& bend,
                                                             Fall at) noexcept {
    const double end = way.end();
    const double start = spot.u;
    const double rest = spot.rest;
    const Bend known = bend;
    double outside = start;
    double inside = end;
    bool bracketed = false;
    double next = start + known.step(way.dir * (at.excess / at.slope));
    for (int i = 0; i < falling::kMaxSteps && at.slope > 0.0; ++i) {
        if (bracketed) {
            const bool between = (next - outside) * (next - inside) < 0.0;
            next = between ? next : 0.5 * (outside + inside);
        } else if (way.dir > 0.0 ? next >= end : next <= end) {
            next = end;
        }
        const double slope = at.slope;
        spot = spot_at(way.curve, next, 1.0 - next);
        at = fall_at<HasFriction>(spot.jet, way.h, way.mu, way.dir);
        const double newton = way.dir * (at.excess / at.slope);
        if (i == 0) {
            bend.see(slope, at.slope, next - start);
            if (way.curve.is_its_taylor_series() && std::fabs(newton) <= falling::kShort &&
                falling::finish<HasFriction>(way, spot, known.step(newton),
                                             -falling::kRoot * slope)) {
                return FallEnd::root;
            }
        }
        if (at.excess > 0.0) {
            outside = next;
            if (next == end) {
                return FallEnd::end;
            }
        } else {
            inside = next;
            bracketed = true;
        }
        if (is_straight_step(spot.jet, newton) &&
            falling::finish<HasFriction>(way, spot, newton,
                                         -std::numeric_limits<double>::infinity())) {
            return FallEnd::root;
        }
        next = spot.u + newton;
    }
    spot = spot_at(way.curve, start, rest);
    return FallEnd::lost;
}

}  // namespace palpate::engine
