#include "engine/friction/cone_slide.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::engine {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// Newton's steps towards the root before giving up for this tick; 2 or 3 are usual.
constexpr int kMaxSteps = 64;

/// A step below this is finished by the curve's Taylor series, whose tangent is then right to 1e-16.
constexpr double kTaylor = 0x1p-27;

/// The last nudge over the root grows by 4 at a time: 2^19 last bits of u are 1e-10 of the span.
constexpr int kMaxNudges = 10;

/// Excess in the direction of the slide, and how fast it falls with u; both times |C'|.
struct Fall {
    double excess = 0.0;
    double slope = 0.0;
    double speed2 = 0.0;
};

template <bool HasFriction>
[[gnu::always_inline]] inline Fall fall_at(const Jet<2>& jet,
                                           const Vec2& h,
                                           double mu,
                                           double dir) noexcept {
    const Vec2 r = h - jet.point;
    const double load = -cross(jet.first, r);
    Fall fall{.excess = dir * glm::dot(r, jet.first) - cone_radius<HasFriction>(mu, load),
              .speed2 = glm::dot(jet.first, jet.first)};
    fall.slope = fall.speed2 - glm::dot(r, jet.second);
    if constexpr (HasFriction) {
        fall.slope -= load > 0.0 ? dir * mu * cross(jet.second, r) : 0.0;
    }
    fall.slope = std::max({fall.slope, 0.25 * fall.speed2, std::numeric_limits<double>::min()});
    return fall;
}

/// The last step, and then bit by bit over the root, so that a hand at rest finds the contact stuck.
/// False, and nothing moved, if that does not lead into the cone: close to a centre of curvature the
/// excess may not fall at first.
template <bool HasFriction>
bool finish(Slide& slide, const Vec2& h, double mu, double dir, double step) noexcept {
    const double u = slide.u;
    const Jet<2> jet = slide.jet;
    double nudge = 2.0 * kEpsilon;
    for (int i = 0; i < kMaxNudges; ++i) {
        const double next = std::clamp(u + dir * (step + nudge), 0.0, 1.0);
        slide.u = next;
        slide.jet = beside(jet, next - u);
        if (fall_at<HasFriction>(slide.jet, h, mu, dir).excess <= 0.0) {
            return true;
        }
        nudge *= 4.0;
    }
    slide.u = u;
    slide.jet = jet;
    return false;
}

}  // namespace

template <bool HasFriction>
Slide slide_to_cone(const RationalBezier<2>& curve,
                    const Vec2& h,
                    double mu,
                    double u,
                    const Jet<2>& jet,
                    double dir,
                    double budget) noexcept {
    Slide slide{.u = u, .jet = jet};
    double outside = u;      // the last place known to lie outside the cone
    double inside = u;       // and inside
    bool bracketed = false;  // there is one inside
    Fall at = fall_at<HasFriction>(jet, h, mu, dir);
    for (int i = 0; i < kMaxSteps; ++i) {
        double step = at.excess / at.slope;
        const double left = budget - slide.length;
        const bool limited = step > 0.0 && step * step * at.speed2 > left * left;
        if (i > 0 && std::fabs(step) <= kTaylor && !limited &&
            finish<HasFriction>(slide, h, mu, dir, step)) {
            slide.end = SlideEnd::in_cone;
            return slide;
        }
        if (limited) {
            step = left / std::sqrt(at.speed2);
        }
        double next = slide.u + dir * step;
        if (bracketed && !((next - outside) * (next - inside) < 0.0)) {
            next = 0.5 * (outside + inside);
        }
        const bool over_end = next >= 1.0 || next <= 0.0;
        next = std::clamp(next, 0.0, 1.0);
        slide.length += dir * (next - slide.u) * std::sqrt(at.speed2);
        slide.u = next;
        slide.jet = curve.at(next);
        at = fall_at<HasFriction>(slide.jet, h, mu, dir);
        if (at.excess <= 0.0) {
            inside = next;
            bracketed = true;
            continue;
        }
        outside = next;
        if (limited || over_end) {
            slide.end = over_end ? SlideEnd::at_end : SlideEnd::out_of_budget;
            return slide;
        }
    }
    slide.end = at.excess <= 0.0 ? SlideEnd::in_cone : SlideEnd::out_of_budget;
    return slide;
}

template Slide slide_to_cone<true>(
    const RationalBezier<2>&, const Vec2&, double, double, const Jet<2>&, double, double) noexcept;
template Slide slide_to_cone<false>(
    const RationalBezier<2>&, const Vec2&, double, double, const Jet<2>&, double, double) noexcept;

}  // namespace palpate::engine
