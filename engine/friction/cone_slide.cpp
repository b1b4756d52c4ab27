#include "engine/friction/cone_slide.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::engine {
namespace {

/// Steps before a slide gives up for this tick; 2 or 3 are usual. Enough for 30 doublings and 60
/// halvings.
constexpr int kMaxSteps = 128;

/// Newton's steps before they are doubled each time, and before halvings take turns with them:
/// where the speed of the curve changes by powers of ten, Newton's iteration in u creeps.
constexpr int kPatience = 6;

/// A stretch squared that has grown by more than this share has grown; less may be rounding where
/// the stretch is 1e-9 of the coordinates.
constexpr double kGrown = 1e-6;

/// A step of u that turns the tangent by less than this is finished by the curve's Taylor series,
/// whose tangent is then right to 1e-16.
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

/// Whether Taylor's series finishes a step of u from here.
bool is_last(const Jet<2>& jet, double speed2, double step) noexcept {
    const double bend2 = glm::dot(jet.second, jet.second);
    return speed2 > kStill2 * bend2 &&
           step * step * std::max(speed2, bend2) <= kTaylor * kTaylor * speed2;
}

/// One slide: from the place known to lie outside the cone towards the first one that does not.
template <bool HasFriction>
class Slider {
public:
    Slider(const RationalBezier<2>& curve,
           const Vec2& h,
           double mu,
           double dir,
           double budget,
           double u,
           const Jet<2>& jet) noexcept
        : curve_(curve), h_(h), mu_(mu), dir_(dir), budget_(budget), outside_(u), beyond_(u) {
        slide_.u = u;
        slide_.jet = jet;
        at_ = fall_at<HasFriction>(jet, h, mu, dir);
        stretch2_ = stretch2();
    }

    Slide run() noexcept {
        for (int i = 0; i < kMaxSteps; ++i) {
            double step = at_.excess / at_.slope;
            if (i > 0 && newton_fits_ && is_last(slide_.jet, at_.speed2, step) && finish(step)) {
                return ended(SlideEnd::in_cone);
            }
            const SlideEnd end = bracketed_ ? narrow(i, step) : advance(i, step);
            if (end != SlideEnd::in_cone) {
                return ended(end);
            }
            if (bracketed_ && std::fabs(beyond_ - outside_) <= 4.0 * kEpsilon) {
                break;
            }
        }
        return close();
    }

private:
    [[nodiscard]] double stretch2() const noexcept {
        const Vec2 r = h_ - slide_.jet.point;
        return glm::dot(r, r);
    }

    Slide ended(SlideEnd end) noexcept {
        slide_.end = end;
        return slide_;
    }

    void move_to(double u) noexcept {
        slide_.length += dir_ * (u - slide_.u) * std::sqrt(at_.speed2);
        slide_.u = u;
        slide_.jet = curve_.at(u);
        at_ = fall_at<HasFriction>(slide_.jet, h_, mu_, dir_);
        // On the way to the first root the stretch only falls: where it has grown there is another
        // root.
        const double now2 = stretch2();
        newton_fits_ = now2 <= stretch2_ * (1.0 + kGrown);
        if (at_.excess <= 0.0 || !newton_fits_) {
            beyond_ = u;
            bracketed_ = true;
        } else {
            outside_ = u;
            stretch2_ = now2;
        }
    }

    /// No place beyond the root is known yet.
    SlideEnd advance(int i, double step) noexcept {
        if (i > kPatience) {
            step *= std::ldexp(1.0, i - kPatience);
        }
        const double left = budget_ - slide_.length;
        const bool limited = step * step * at_.speed2 > left * left;
        if (limited) {
            step = std::max(left, 0.0) / std::sqrt(at_.speed2);
        }
        const double wanted = slide_.u + dir_ * step;
        const double next = std::clamp(wanted, 0.0, 1.0);
        const bool stays = next == slide_.u;
        move_to(stays && !limited && next > 0.0 && next < 1.0 ? next + dir_ * kEpsilon : next);
        if (bracketed_) {
            return SlideEnd::in_cone;
        }
        if (dir_ > 0.0 ? wanted >= 1.0 : wanted <= 0.0) {
            return SlideEnd::at_end;
        }
        return limited ? SlideEnd::out_of_budget : SlideEnd::in_cone;
    }

    /// The root lies between `outside_` and `beyond_`.
    SlideEnd narrow(int i, double step) noexcept {
        const double next = slide_.u + dir_ * step;
        const bool between = (next - outside_) * (next - beyond_) < 0.0;
        const bool turn = i > kPatience && i % 2 == 0;
        move_to(newton_fits_ && between && !turn ? next : 0.5 * (outside_ + beyond_));
        return SlideEnd::in_cone;
    }

    /// The last step, and then bit by bit over the root, so that a hand at rest finds the contact
    /// stuck. False, and nothing moved, if that does not lead into the cone: close to a centre of
    /// curvature the excess may not fall at first.
    bool finish(double step) noexcept {
        const double u = slide_.u;
        const Jet<2> jet = slide_.jet;
        double nudge = 2.0 * kEpsilon;
        for (int i = 0; i < kMaxNudges; ++i) {
            const double next = std::clamp(u + dir_ * (step + nudge), 0.0, 1.0);
            slide_.u = next;
            slide_.jet = beside(jet, next - u);
            if (fall_at<HasFriction>(slide_.jet, h_, mu_, dir_).excess <= 0.0) {
                return true;
            }
            nudge *= 4.0;
        }
        slide_.u = u;
        slide_.jet = jet;
        return false;
    }

    /// The bracket is as narrow as doubles are, or the steps are used up: the side in the cone, if
    /// it is.
    Slide close() noexcept {
        if (bracketed_ && slide_.u != beyond_) {
            move_to(beyond_);
        }
        if (at_.excess <= 0.0) {
            return ended(SlideEnd::in_cone);
        }
        move_to(outside_);
        return ended(SlideEnd::out_of_budget);
    }

    const RationalBezier<2>& curve_;
    Vec2 h_;
    double mu_;
    double dir_;
    double budget_;
    double outside_;  ///< the last place known to lie outside the cone, before the first root
    double beyond_;   ///< a place beyond the first root
    bool bracketed_ = false;
    bool newton_fits_ = true;  ///< the excess where the slide is belongs to the root looked for
    double stretch2_ = 0.0;    ///< |HIP - GO|^2 at `outside_`: it only falls on the way to the root
    Fall at_{};
    Slide slide_{};
};

}  // namespace

template <bool HasFriction>
Slide slide_to_cone(const RationalBezier<2>& curve,
                    const Vec2& h,
                    double mu,
                    double u,
                    const Jet<2>& jet,
                    double dir,
                    double budget) noexcept {
    return Slider<HasFriction>(curve, h, mu, dir, budget, u, jet).run();
}

template Slide slide_to_cone<true>(
    const RationalBezier<2>&, const Vec2&, double, double, const Jet<2>&, double, double) noexcept;
template Slide slide_to_cone<false>(
    const RationalBezier<2>&, const Vec2&, double, double, const Jet<2>&, double, double) noexcept;

}  // namespace palpate::engine
