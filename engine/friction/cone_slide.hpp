#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "engine/friction/cone_forms.hpp"
#include "engine/friction/fall.hpp"

namespace palpate::engine {

/// How far outside its friction cone a god-object at a point of a curve is, times the curve's speed
/// |C'| (m^2 per unit of u): no root and no division, for the test that runs on every tick.
///
/// With r = HIP - GO: tangential r . C', load -r . perp(C'), both |C'| times what Stretch says.
struct Drive {
    double tangential = 0.0;
    double load = 0.0;
    double rest = 0.0;  ///< what the last bits of u make of the tangential part

    /// |tangential| - mu max(load, 0); > 0: the GO has to move.
    template <bool HasFriction>
    [[nodiscard]] double excess(double mu) const noexcept {
        return (tangential < 0.0 ? -tangential : tangential) - cone_radius<HasFriction>(mu, load);
    }
    /// Which way it drives out of the cone: +1, -1, or 0 if the god-object stays. Without friction
    /// one within the last bits of its foot, in u, stays.
    template <bool HasFriction>
    [[nodiscard]] double direction(double mu) const noexcept {
        return excess<HasFriction>(mu) <= (HasFriction ? 0.0 : rest) ? 0.0
             : tangential < 0.0                                      ? -1.0
                                                                     : 1.0;
    }
};

/// By the derivative of a curve: times |C'|, and m^2.
[[nodiscard]] inline Drive drive_at(const Jet<2>& jet, const Vec2& h) noexcept {
    const Vec2 r = h - jet.point;
    return {.tangential = glm::dot(r, jet.first),
            .load = -cross(jet.first, r),
            .rest = 4.0 * kEpsilon * glm::dot(jet.first, jet.first)};
}
/// By the unit tangent of an arc, m.
[[nodiscard]] inline Drive drive_at(const Arc& arc, const Jet<2>& jet, const Vec2& h) noexcept {
    const Vec2 r = h - jet.point;
    return {.tangential = glm::dot(r, jet.first),
            .load = -cross(jet.first, r),
            .rest = 4.0 * kEpsilon * arc.chord()};
}

/// A place on the arc by u and 1 - u, with point and tangent; its second derivative is 0.
[[nodiscard]] inline Spot spot_at(const Arc& arc, double u, double rest) noexcept {
    const Arc::Point at = arc.at(u, rest);
    return {.u = u, .rest = rest, .jet = {.point = at.point, .first = at.tangent}};
}

/// Whether the square of a slope is that of a sharp root among these lengths, m: beside a centre
/// all places are feet, and the last bits of the span decide. Mostly without the root of `far2`:
/// (chord + far)^2 <= 2 (chord^2 + far^2), with room for rounding.
[[nodiscard]] inline bool is_sharp_root(double slope2, double chord, double far2) noexcept {
    constexpr double kSharp = 0x1p-10;  // share of the lengths
    constexpr double kAmple = 2.0 * (1.0 + 1e-9) * kSharp * kSharp;
    if (slope2 >= kAmple * (chord * chord + far2)) {
        return true;
    }
    const double sharp = kSharp * (chord + std::sqrt(far2));
    return slope2 >= sharp * sharp;
}

/// How far ahead of d in direction `dir` a form of the arc that is > 0 there first vanishes;
/// infinity: nowhere; NaN: unclear.
/// @param far2   squared distance of HIP, m^2
[[nodiscard, gnu::always_inline]] inline double way_to_root(
    const Arc& arc, const Arc::Form& f, double d, double dir, double far2) noexcept {
    const double here = f.value(d);
    const double slope = dir * (f.c1 + 2.0 * d * f.c2);
    const double under = slope * slope - 4.0 * f.c2 * here;
    if (!is_sharp_root(std::fabs(under), arc.chord(), far2)) {
        return std::numeric_limits<double>::quiet_NaN();
    }
    if (under < 0.0) {
        return std::numeric_limits<double>::infinity();
    }
    const double root = std::sqrt(under);
    if (slope < 0.0) {
        return std::max(2.0 * here / (root - slope), 0.0);
    }
    const double way = (slope + root) / (-2.0 * f.c2);
    return way >= 0.0 ? way : std::numeric_limits<double>::infinity();
}

/// A budget of `left` m is enough for the way along an arc between two places, whatever the angle
/// between them. @param straight  from one to the other, m
[[nodiscard]] inline bool surely_pays(const Vec2& straight, double left) noexcept {
    return Arc::kMaxWay * Arc::kMaxWay * glm::dot(straight, straight) <= left * left;
}

/// Over a part of a span, whole pieces, the excess is known to fall, for every HIP near this one.
struct FallProof {
    std::size_t span = static_cast<std::size_t>(-1);  ///< none yet
    std::size_t piece = 0;                            ///< where it was found
    double lo = 0.0;
    double hi = 0.0;
    Vec2 h{};
    double slack2 = 0.0;  ///< m^2, how far HIP may be from h; 0: nothing is known
    Bend bend{};          ///< of the excess over u, at the last slide

    /// What was found for h is proven for this HIP too, m.
    [[nodiscard]] bool holds(const Vec2& hip) const noexcept {
        const Vec2 moved = hip - h;
        return glm::dot(moved, moved) < slack2;
    }
};

/// What a slide needs to know.
struct SlideTask {
    const ConeForms& forms;
    std::size_t span = 0;
    Vec2 h{};
    double mu = 0.0;
    double dir = 0.0;     ///< +1 or -1
    double budget = 0.0;  ///< m, may be infinite
};

/// Where a slide ended.
enum class SlideEnd : std::uint8_t {
    in_cone,  ///< at the first place where the stretch fits the cone
    at_end,   ///< at the end of the span, still outside
    out_of_budget,
    unclear,  ///< of an arc: its closed form cannot tell; the place is where it was
};

/// Drive::direction() by the forms, for spans that are not tame. `dir` and `budget` are not read.
template <bool HasFriction>
[[nodiscard]] double direction_by_forms(const SlideTask& task, const Spot& spot) noexcept;

/// Moves the god-object along its span to the FIRST place in direction `dir` where
/// dir tau <= mu max(nu, 0), at most `budget` m and not over the end of the span.
///
/// Piece by piece. While a proof holds that the excess falls over the piece, its root is the first,
/// and Newton's iteration
///
///     ds = (dir tau - mu nu) / (1 - kappa (nu + mu |tau|))
///
/// finds it, on the form times |C'|, where it needs neither the unit frame nor the curvature. Its
/// first step goes along a parabola, bent as the excess was bent in the last slide.
/// Elsewhere first_root() isolates it, in doubles, and in twice the digits where these do not tell.
/// The end is the root to rounding, on its inner side.
/// @param used  m of the budget; what was travelled is added where there is a budget
/// @pre the drive at the spot is in direction dir
template <bool HasFriction>
[[nodiscard]] SlideEnd slide_to_cone(const SlideTask& task,
                                     Spot& spot,
                                     FallProof& proof,
                                     double& used) noexcept;

/// The same on an arc or a line, whose forms are quadratics in u: their first root is one square
/// root. The spot's jet is the point and the unit tangent.
/// @param used  where the slide ends in the cone and the budget is ample, nothing is added
template <bool HasFriction>
[[nodiscard]] SlideEnd slide_on_arc(const Arc& arc,
                                    const SlideTask& task,
                                    Spot& spot,
                                    double& used) noexcept;

}  // namespace palpate::engine
