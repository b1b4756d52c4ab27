#include "engine/deformation/soft_walk.hpp"

#include <algorithm>
#include <cmath>

#include "engine/friction/friction_law.hpp"

namespace palpate::engine {
namespace {

constexpr double kMaxStep = 1.0 / 32;  ///< of u
constexpr int kMaxSteps = 80;          ///< 32 along a span, and what ends it
constexpr int kMaxVisits = 9;          ///< of spans and seams, there and not back
constexpr double kLastStep = 8.0 * kEpsilon;
constexpr double kRounding = 1e-15;  ///< m, of places within 1 m

class SoftWalker {
public:
    SoftWalker(const SoftShape& shape, const SoftState& state, const Vec2& hip, double mu) noexcept
        : shape_(shape), state_(state), hip_(hip), mu_(mu) {}

    Walk run(Place& place) noexcept {
        const Place start = place;
        const double before = length(place);
        for (int i = 0; i < kMaxVisits; ++i) {
            if (place.on_seam ? at_seam(place) : on_span(place)) {
                break;
            }
            walk_.unproven = i + 1 == kMaxVisits;
        }
        if (walk_.unproven || !(length(place) <= before + kRounding)) {
            place = start;
            settle(view(shape_.jet(state_, material_at(shape_.outline(), place))), place);
            walk_.slid = false;
            walk_.unproven = true;
        }
        // Within a thousandth of a micrometre of the cone it is rounding.
        walk_.outside_cone = !walk_.in_corner && walk_.nu > 0.0 &&
                             std::fabs(walk_.tau) > cone_radius<true>(mu_, walk_.nu) + 1e-12;
        return walk_;
    }

private:
    /// What happens at a step of u.
    struct Fall {
        double excess = 0.0;  ///< dir tau - mu max(nu, 0), times |C'|
        double slope = 0.0;   ///< how fast it falls in the direction of the walk
        double rest = 0.0;    ///< what the last bits of u make of it
    };

    [[nodiscard]] ConeView view(const Vec2& point, const Vec2& along) const noexcept {
        return cone_view<true>(hip_, point, along * (1.0 / glm::length(along)), mu_);
    }
    [[nodiscard]] ConeView view(const Jet<2>& jet) const noexcept {
        return view(jet.point, jet.first);
    }

    /// Of the stretch, m.
    [[nodiscard]] double length(const Place& place) const noexcept {
        return glm::length(shape_.jet(state_, material_at(shape_.outline(), place)).point - hip_);
    }

    [[nodiscard]] Fall fall(const Jet<2>& jet, double dir) const noexcept {
        const Vec2 r = hip_ - jet.point;
        const double speed2 = glm::dot(jet.first, jet.first);
        const double load = -cross(jet.first, r);
        Fall f{.excess = dir * glm::dot(r, jet.first) - cone_radius<true>(mu_, load),
               .slope = speed2 - glm::dot(r, jet.second),
               .rest = 4.0 * kEpsilon * speed2};
        if (load > 0.0) {
            f.slope -= dir * mu_ * cross(jet.second, r);
        }
        return f;
    }

    void settle(const ConeView& v, const Place& place) noexcept {
        walk_.point = shape_.jet(state_, material_at(shape_.outline(), place)).point;
        walk_.see(v);
    }

    /// True: the walk ends here.
    bool on_span(Place& place) noexcept {
        const Jet<2> jet = shape_.jet(state_, {place.index, place.parameter});
        const double tangential = glm::dot(hip_ - jet.point, jet.first);
        const double dir = tangential < 0.0 ? -1.0 : 1.0;
        const Fall start = fall(jet, dir);
        if (start.excess <= start.rest || (dir_ != 0.0 && dir != dir_)) {
            settle(view(jet), place);
            return true;
        }
        dir_ = dir;
        const double from = place.parameter;
        const bool ended = slide(place, start);
        walk_.slid = walk_.slid || place.parameter != from;
        if (ended) {
            place = {.on_seam = true,
                     .index = *shape_.outline().seam_beyond(place.index, dir > 0.0)};
            return false;
        }
        settle(view(shape_.jet(state_, {place.index, place.parameter})), place);
        return true;
    }

    /// To the first place in the cone; true: none up to the end of the span.
    bool slide(Place& place, Fall at) noexcept {
        const double end = dir_ > 0.0 ? 1.0 : 0.0;
        double u = place.parameter;
        double outside = u;
        double inside = end;
        bool bracketed = false;
        for (int i = 0; i < kMaxSteps; ++i) {
            if (!bracketed && outside == end) {
                return true;
            }
            const double newton = at.slope > 0.0 ? at.excess / at.slope : kMaxStep;
            double next = 0.0;
            if (bracketed) {
                if (std::fabs(inside - outside) <= kLastStep) {
                    break;
                }
                next = u + dir_ * newton;
                next = (next - outside) * (next - inside) < 0.0 ? next : 0.5 * (outside + inside);
            } else {
                next = outside + dir_ * std::clamp(newton, kLastStep, kMaxStep);
                next = dir_ > 0.0 ? std::min(next, end) : std::max(next, end);
            }
            u = next;
            at = fall(shape_.jet(state_, {place.index, u}), dir_);
            if (at.excess > at.rest) {
                outside = u;
            } else {
                inside = u;
                bracketed = true;
                if (at.excess >= -at.rest) {
                    break;
                }
            }
        }
        place.parameter = bracketed ? inside : outside;
        return false;
    }

    bool at_seam(Place& place) noexcept {
        const Seam& seam = shape_.outline().seams()[place.index];
        const Jet<2> in = shape_.jet(state_, {seam.before, 1.0});
        const Jet<2> out = shape_.jet(state_, {seam.after, 0.0});
        const ConeView before = view(in);
        const ConeView after = view(out.point, out.first);
        if (cross(before.tangent, after.tangent) >= 0.0) {
            const Groove groove{.before = before, .after = after};
            if (const double way = groove.way_out<true>(dir_); way != 0.0) {
                return leave(seam, place, way);
            }
            walk_.in_corner = true;
            settle(groove.felt(hip_, in.point), place);
            return true;
        }
        if (dir_ != 0.0) {
            // Over the tip: the normal that points at HIP lies in the fan.
            const ConeView& near = dir_ > 0.0 ? before : after;
            const ConeView& far = dir_ > 0.0 ? after : before;
            if (dir_ * far.tau <= 0.0 && (near.nu < 0.0 || far.nu < std::fabs(far.tau))) {
                return let_go(in.point, near.tangent);
            }
            return leave(seam, place, dir_);
        }
        const bool on = after.tau > 0.0 && after.excess > 0.0;
        if (on || (before.tau < 0.0 && before.excess > 0.0)) {
            return leave(seam, place, on ? 1.0 : -1.0);
        }
        if (std::max(before.nu, after.nu) <= 0.0 || std::min(before.excess, after.excess) > 0.0) {
            return let_go(in.point, before.tangent);
        }
        settle(before.excess <= after.excess ? before : after, place);
        return true;
    }

    bool leave(const Seam& seam, Place& place, double dir) noexcept {
        dir_ = dir;
        place = dir > 0.0 ? Place{.index = seam.after, .parameter = 0.0}
                          : Place{.index = seam.before, .parameter = 1.0};
        return false;
    }

    /// The contact ends over a tip.
    bool let_go(const Vec2& tip, const Vec2& tangent) noexcept {
        walk_.point = tip;
        walk_.tangent = tangent;
        walk_.normal = perp(tangent);
        walk_.nu = -glm::length(hip_ - tip);
        return true;
    }

    const SoftShape& shape_;
    const SoftState& state_;
    Vec2 hip_;
    double mu_;
    double dir_ = 0.0;  ///< of the walk: +1, -1, or 0 before its first step
    Walk walk_{};
};

}  // namespace

Walk walk_on_soft(const SoftShape& shape,
                  const SoftState& state,
                  Place& place,
                  const Vec2& hip,
                  double mu) noexcept {
    return SoftWalker(shape, state, hip, mu).run(place);
}

}  // namespace palpate::engine
