#include "engine/friction/god_object.hpp"

#include <cmath>
#include <limits>

#include "engine/math/elementary.hpp"

namespace palpate::engine {
namespace {

/// Features visited in one tick before the walk gives up until the next: a guard against a cycle of
/// rounding errors, far above what a hand can cross in a millisecond.
constexpr int kMaxFeatures = 64;

/// What happens after a step on one feature.
enum class Next : std::uint8_t { go_on, stop };

template <bool HasFriction>
class Walker {
public:
    Walker(const Outline& outline,
           const Place& from,
           const Vec2& h,
           double mu,
           double budget,
           double radius) noexcept
        : outline_(outline), h_(h), mu_(mu), budget_(budget), radius_(radius) {
        walk_.place = from;
    }

    Walk run() noexcept {
        for (int i = 0; i < kMaxFeatures; ++i) {
            if (step() == Next::stop) {
                return walk_;
            }
        }
        walk_.held_outside = true;
        walk_.out_of_budget = true;
        return walk_;
    }

private:
    Next step() noexcept {
        if (!walk_.place.on_joint) {
            return on_segment();
        }
        const Joint& joint = outline_.joints()[walk_.place.index];
        return joint.kind == JointKind::concave ? in_corner(joint) : on_fan(joint);
    }

    /// Takes `s` as the outcome so far; true when the walk ends here inside the cone or turns back.
    bool settle(const ConeState& s) noexcept {
        walk_.point = s.frame.point;
        walk_.normal = s.frame.normal;
        walk_.tangent = s.frame.tangent;
        walk_.tau = s.tau;
        walk_.nu = s.nu;
        walk_.in_corner = false;
        if (s.excess <= 0.0) {
            return true;
        }
        const double sign = s.tau < 0.0 ? -1.0 : 1.0;
        if (direction_ != 0.0 && sign != direction_) {
            return true;
        }
        direction_ = sign;
        if (used_ >= budget_) {
            walk_.held_outside = true;
            walk_.out_of_budget = true;
            return true;
        }
        return false;
    }

    Next on_segment() noexcept {
        const std::size_t index = walk_.place.index;
        const RationalBezier<2>& curve = outline_.segments()[index];
        if (settle(cone_state<HasFriction>(frame_at(curve, walk_.place.parameter), h_, mu_))) {
            return Next::stop;
        }
        const Slide slide = slide_to_cone<HasFriction>(curve, h_, mu_, walk_.place.parameter,
                                                       direction_, budget_ - used_);
        walk_.place.parameter = slide.u;
        walk_.slid += slide.length;
        used_ += slide.length;
        if (slide.end == SlideEnd::at_end) {
            return over_end(index);
        }
        static_cast<void>(settle(cone_state<HasFriction>(frame_at(curve, slide.u), h_, mu_)));
        if (slide.end == SlideEnd::out_of_budget) {
            walk_.held_outside = true;
            walk_.out_of_budget = true;
        }
        return Next::stop;
    }

    Next over_end(std::size_t segment) noexcept {
        const bool forward = direction_ > 0.0;
        const auto joint = outline_.joint_beyond(segment, forward);
        if (!joint) {  // an open end holds the GO
            static_cast<void>(settle(cone_state<HasFriction>(
                frame_at(outline_.segments()[segment], forward ? 1.0 : 0.0), h_, mu_)));
            walk_.held_outside = true;
            return Next::stop;
        }
        walk_.place = {.on_joint = true,
                       .index = *joint,
                       .parameter = forward ? 0.0 : outline_.joints()[*joint].turn};
        return Next::go_on;
    }

    /// Convex (or smooth) vertex: turn the normal through the fan. While HIP drives the GO on, the
    /// excess only grows with the angle, so the fan is crossed whole unless the budget ends.
    Next on_fan(const Joint& joint) noexcept {
        double& phi = walk_.place.parameter;
        if (settle(cone_state<HasFriction>(fan_frame(joint, phi), h_, mu_))) {
            return Next::stop;
        }
        const double to_go = direction_ > 0.0 ? joint.turn - phi : phi;
        const double price = radius_ * to_go;
        if (price > budget_ - used_) {
            phi += direction_ * (budget_ - used_) / radius_;
            used_ = budget_;
            static_cast<void>(settle(cone_state<HasFriction>(fan_frame(joint, phi), h_, mu_)));
            return Next::stop;
        }
        used_ += price;
        leave(joint, direction_);
        return Next::go_on;
    }

    /// Concave vertex: two normals, two loads. F = K (V - h) is carried by both together.
    Next in_corner(const Joint& joint) noexcept {
        const ConeState after = cone_state<HasFriction>(start_of(joint), h_, mu_);
        const ConeState before = cone_state<HasFriction>(end_of(joint), h_, mu_);
        const bool drives_on = after.tau > 0.0 && after.excess > 0.0 && direction_ >= 0.0;
        const bool drives_back = before.tau < 0.0 && before.excess > 0.0 && direction_ <= 0.0;
        if ((drives_on || drives_back) && used_ < budget_) {
            direction_ = drives_on ? 1.0 : -1.0;
            leave(joint, direction_);
            return Next::go_on;
        }
        settle_corner(joint, before, after);
        walk_.out_of_budget = (drives_on || drives_back);
        return Next::stop;
    }

    /// The normal of a corner is the one of its internal fan that lies nearest to the force.
    void settle_corner(const Joint& joint,
                       const ConeState& before,
                       const ConeState& after) noexcept {
        walk_.place.parameter = 0.0;
        walk_.point = joint.point;
        walk_.in_corner = true;
        if (after.tau >= 0.0) {
            take(after);
        } else if (before.tau <= 0.0) {
            take(before);
        } else {
            const Vec2 gap = joint.point - h_;
            const double length = glm::length(gap);
            walk_.normal = length > 0.0 ? gap / length : after.frame.normal;
            walk_.tangent = -perp(walk_.normal);
            walk_.tau = 0.0;
            walk_.nu = length;
        }
    }

    void take(const ConeState& s) noexcept {
        walk_.normal = s.frame.normal;
        walk_.tangent = s.frame.tangent;
        walk_.tau = s.tau;
        walk_.nu = s.nu;
    }

    void leave(const Joint& joint, double direction) noexcept {
        walk_.place = direction > 0.0 ? Place{.index = joint.after, .parameter = 0.0}
                                      : Place{.index = joint.before, .parameter = 1.0};
    }

    static Frame fan_frame(const Joint& joint, double phi) noexcept {
        const SinCos turn = sin_cos(phi);
        Frame frame{.point = joint.point};
        frame.tangent = turn.cos * joint.tangent_in - turn.sin * perp(joint.tangent_in);
        frame.normal = perp(frame.tangent);
        return frame;
    }
    static Frame end_of(const Joint& joint) noexcept {
        return {
            .point = joint.point, .tangent = joint.tangent_in, .normal = perp(joint.tangent_in)};
    }
    static Frame start_of(const Joint& joint) noexcept {
        return {
            .point = joint.point, .tangent = joint.tangent_out, .normal = perp(joint.tangent_out)};
    }

    const Outline& outline_;
    Vec2 h_;
    double mu_;
    double budget_;
    double radius_;
    double used_ = 0.0;
    double direction_ = 0.0;  ///< of travel: +1, -1, or 0 before the first step
    Walk walk_{};
};

}  // namespace

template <bool HasFriction>
Walk walk_god_object(const Outline& outline,
                     const Place& from,
                     const Vec2& h,
                     double mu,
                     double budget,
                     double vertex_radius) noexcept {
    return Walker<HasFriction>(outline, from, h, mu, budget, vertex_radius).run();
}

template Walk walk_god_object<true>(
    const Outline&, const Place&, const Vec2&, double, double, double) noexcept;
template Walk walk_god_object<false>(
    const Outline&, const Place&, const Vec2&, double, double, double) noexcept;

}  // namespace palpate::engine
