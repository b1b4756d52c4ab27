#include "engine/friction/cone_slide.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::engine {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// Newton's steps towards the root before giving up for this tick; 3 or 4 are usual.
constexpr int kMaxSteps = 48;

/// Excess in the direction of the slide, and the length of Newton's step from here.
struct Drive {
    double excess = 0.0;
    double step = 0.0;   ///< m, signed like excess
    double speed = 0.0;  ///< m per unit of u
};

template <bool HasFriction>
Drive drive_at(
    const RationalBezier<2>& curve, const Vec2& h, double mu, double u, double dir) noexcept {
    const ConeState s = cone_state<HasFriction>(frame_at(curve, u), h, mu);
    const double along = dir * s.tau;
    Drive d{.excess = along - cone_radius<HasFriction>(mu, s.nu), .speed = s.frame.speed};
    double reach = s.nu;
    if constexpr (HasFriction) {
        reach += s.nu > 0.0 ? mu * along : 0.0;
    }
    d.step = d.excess / std::max(1.0 - s.frame.curvature * reach, 0.25);
    return d;
}

/// The root between `outside` (excess > 0) and `inside` (excess <= 0), returned on the inner side.
template <bool HasFriction>
double close_in(const RationalBezier<2>& curve,
                const Vec2& h,
                double mu,
                double dir,
                double outside,
                double inside,
                Drive at) noexcept {
    double u = inside;
    for (int i = 0; i < kMaxSteps; ++i) {
        double next = at.speed > 0.0 ? u + dir * at.step / at.speed : 0.5 * (outside + inside);
        const double lo = std::min(outside, inside);
        const double hi = std::max(outside, inside);
        if (!(next > lo && next < hi)) {
            next = 0.5 * (outside + inside);
        }
        const bool settled = std::fabs(next - u) <= 2.0 * kEpsilon;
        u = next;
        at = drive_at<HasFriction>(curve, h, mu, u, dir);
        (at.excess > 0.0 ? outside : inside) = u;
        if (settled || hi - lo <= 2.0 * kEpsilon) {
            break;
        }
    }
    // The last bits: step over the root, so that a hand at rest finds the contact stuck.
    double nudge = kEpsilon;
    for (int i = 0; i < 12 && at.excess > 0.0; ++i) {
        const double next = std::clamp(u + dir * nudge, 0.0, 1.0);
        at = drive_at<HasFriction>(curve, h, mu, next, dir);
        u = next;
        nudge *= 2.0;
    }
    return at.excess > 0.0 ? inside : u;
}

}  // namespace

template <bool HasFriction>
Slide slide_to_cone(const RationalBezier<2>& curve,
                    const Vec2& h,
                    double mu,
                    double u,
                    double dir,
                    double budget) noexcept {
    Slide slide{.u = u};
    Drive at = drive_at<HasFriction>(curve, h, mu, u, dir);
    for (int i = 0; i < kMaxSteps; ++i) {
        const double left = budget - slide.length;
        if (left <= 0.0) {
            slide.end = SlideEnd::out_of_budget;
            return slide;
        }
        const double ds = std::min(at.step, left);
        double next = slide.u + dir * ds / std::max(at.speed, std::numeric_limits<double>::min());
        const bool over_end = next >= 1.0 || next <= 0.0;
        next = std::clamp(next, 0.0, 1.0);
        if (next == slide.u && !over_end) {  // the step is below the last bit of u
            return slide;
        }
        const Drive ahead = drive_at<HasFriction>(curve, h, mu, next, dir);
        const double start = slide.u;
        if (ahead.excess <= 0.0) {
            slide.u = close_in<HasFriction>(curve, h, mu, dir, start, next, ahead);
            slide.length += std::fabs(slide.u - start) * at.speed;
            slide.end = SlideEnd::in_cone;
            return slide;
        }
        slide.length += over_end ? std::fabs(next - start) * at.speed : ds;
        slide.u = next;
        at = ahead;
        if (over_end) {
            slide.end = SlideEnd::at_end;
            return slide;
        }
    }
    slide.end = SlideEnd::out_of_budget;
    return slide;
}

template Slide slide_to_cone<true>(
    const RationalBezier<2>&, const Vec2&, double, double, double, double) noexcept;
template Slide slide_to_cone<false>(
    const RationalBezier<2>&, const Vec2&, double, double, double, double) noexcept;

}  // namespace palpate::engine
