#include "engine/friction/god_object.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/geometry/cusps.hpp"
#include "engine/math/elementary.hpp"

namespace palpate::engine {
namespace {

/// Spans and seams visited in one tick before the walk gives up until the next: a guard against a
/// cycle of rounding errors, far above what a hand can cross in a millisecond.
constexpr int kMaxVisits = 64;

/// From a still end the walk sets out with this step of u: 1e-9 of the span's length along the
/// curve.
constexpr double kSetOut = 0x1p-14;

/// Or with a step that takes it this share of the stretch away: beside heavy control points u is
/// coarse.
constexpr double kSetOutShare = 1e-3;
constexpr int kMaxSetOuts = 16;

/// A frictionless GO closer than this to its foot, in u, rests there.
constexpr double kRest = 4.0 * std::numeric_limits<double>::epsilon();

/// What happens after a step on one span or seam.
enum class Next : std::uint8_t { go_on, stop };

/// The stretch in a unit frame with tangent t.
struct ConeState {
    Vec2 tangent{};
    double tau = 0.0;     ///< r . t, m, signed
    double nu = 0.0;      ///< -r . n, m
    double excess = 0.0;  ///< |tau| - mu max(nu, 0), m; > 0: the GO has to move
};

template <bool HasFriction>
class Walker {
public:
    Walker(const Outline& outline,
           GodObject& go,
           const Vec2& h,
           double mu,
           double budget,
           double radius) noexcept
        : outline_(outline), go_(go), h_(h), mu_(mu), budget_(budget), radius_(radius) {}

    Walk run() noexcept {
        for (int i = 0; i < kMaxVisits; ++i) {
            if (step() == Next::stop) {
                return walk_;
            }
        }
        settle_at(cone(outline_, go_));
        walk_.outside_cone = true;
        walk_.out_of_budget = true;
        return walk_;
    }

private:
    Next step() noexcept {
        if (!go_.place.on_seam) {
            return on_span();
        }
        const Seam& seam = outline_.seams()[go_.place.index];
        return seam.kind == SeamKind::concave ? in_corner(seam) : on_fan(seam);
    }

    [[nodiscard]] ConeState cone(const Vec2& point, const Vec2& tangent) const noexcept {
        const Vec2 r = h_ - point;
        ConeState s{.tangent = tangent, .tau = glm::dot(r, tangent), .nu = -cross(tangent, r)};
        s.excess = std::fabs(s.tau) - cone_radius<HasFriction>(mu_, s.nu);
        return s;
    }

    [[nodiscard]] ConeState cone(const Outline& outline, const GodObject& go) const noexcept {
        if (go.place.on_seam) {
            const Seam& seam = outline.seams()[go.place.index];
            return cone(seam.point, fan_tangent(seam, go.place.parameter));
        }
        if (at_still_end(go)) {
            return cone(go.jet.point,
                        end_tangent(outline.spans()[go.place.index], go.place.parameter > 0.5));
        }
        const double speed2 = glm::dot(go.jet.first, go.jet.first);
        return cone(go.jet.point, go.jet.first * (1.0 / std::sqrt(speed2)));
    }

    /// At an end, that is. Inside of a span a hairpin may be as slow, but its tangent is its own.
    static bool at_still_end(const GodObject& go) noexcept {
        return stands_still(go.jet) &&
               (near_end(go.place.parameter) || glm::dot(go.jet.first, go.jet.first) == 0.0);
    }
    static bool near_end(double u) noexcept { return u < kStillEnd || u > 1.0 - kStillEnd; }

    /// The walk ends here, with this stretch.
    Next settle_at(const ConeState& s) noexcept {
        walk_.point = go_.place.on_seam ? outline_.seams()[go_.place.index].point : go_.jet.point;
        walk_.tangent = s.tangent;
        walk_.normal = perp(s.tangent);
        walk_.tau = s.tau;
        walk_.nu = s.nu;
        return Next::stop;
    }

    /// Whether a drive along t moves the GO on: not against the direction of the walk so far.
    bool goes(double tangential) noexcept {
        const double sign = tangential < 0.0 ? -1.0 : 1.0;
        if (direction_ != 0.0 && sign != direction_) {
            return false;
        }
        direction_ = sign;
        return true;
    }

    Next stop_outside(bool out_of_budget) noexcept {
        walk_.outside_cone = true;
        walk_.out_of_budget = out_of_budget;
        return Next::stop;
    }

    Next on_span() noexcept {
        const Drive drive = drive_at(go_.jet, h_);
        if (at_still_end(go_)) {
            return from_still_end();
        }
        const double rest = HasFriction ? 0.0 : kRest * drive.speed2;
        if (drive.excess<HasFriction>(mu_) <= rest) {
            return settle_at(cone(outline_, go_));
        }
        if (!goes(drive.tangential)) {
            settle_at(cone(outline_, go_));
            return stop_outside(false);
        }
        return slide();
    }

    Next slide() noexcept {
        const std::size_t index = go_.place.index;
        if (used_ >= budget_) {
            settle_at(cone(outline_, go_));
            return stop_outside(true);
        }
        const Slide slide =
            slide_to_cone<HasFriction>(outline_.spans()[index], h_, mu_, go_.place.parameter,
                                       go_.jet, direction_, budget_ - used_);
        // The length is of first order: where the speed changes by powers of ten it may come out as
        // nothing, or less. The chord is never too long.
        const double length = std::max(slide.length, glm::length(slide.jet.point - go_.jet.point));
        go_.place.parameter = slide.u;
        go_.jet = slide.jet;
        walk_.slid += length;
        used_ += length;
        if (slide.end == SlideEnd::at_end) {
            return over_end(index);
        }
        if (slide.end == SlideEnd::in_cone && at_still_end(go_)) {
            return Next::go_on;  // where C' = 0 the excess is nothing: the end's tangent decides
        }
        settle_at(cone(outline_, go_));
        return slide.end == SlideEnd::out_of_budget ? stop_outside(true) : Next::stop;
    }

    /// Where C' = 0 the drive in u says nothing: the end's tangent decides, and the first step is
    /// given.
    Next from_still_end() noexcept {
        const ConeState s = cone(outline_, go_);
        if (s.excess <= 0.0) {
            return settle_at(s);
        }
        if (!goes(s.tau)) {
            settle_at(s);
            return stop_outside(false);
        }
        double& u = go_.place.parameter;
        if (near_end(u) && (direction_ > 0.0 ? u > 0.5 : u <= 0.5)) {
            return over_end(go_.place.index);
        }
        return set_out();
    }

    /// From where the curve stands still to a place near by, measured by the stretch, where it does
    /// not.
    Next set_out() noexcept {
        const RationalBezier<2>& curve = outline_.spans()[go_.place.index];
        const double near = kSetOutShare * glm::length(h_ - go_.jet.point);
        const Vec2 here = go_.jet.point;
        double step = kSetOut;
        double u = go_.place.parameter;
        for (int i = 0; i < kMaxSetOuts; ++i) {
            u = go_.place.parameter + direction_ * step;
            go_.jet = curve.at(u);
            if (glm::length(go_.jet.point - here) <= near) {
                break;
            }
            step *= 0.25;
        }
        go_.place.parameter = u;
        const double length = glm::length(go_.jet.point - here);
        walk_.slid += length;
        used_ += length;
        return Next::go_on;
    }

    Next over_end(std::size_t span) noexcept {
        const bool forward = direction_ > 0.0;
        const auto seam = outline_.seam_beyond(span, forward);
        if (!seam) {  // an open end holds the GO
            settle_at(cone(outline_, go_));
            return stop_outside(false);
        }
        go_.place = {.on_seam = true,
                     .index = *seam,
                     .parameter = forward ? 0.0 : outline_.seams()[*seam].turn};
        return Next::go_on;
    }

    /// Convex (or smooth) vertex: turn the normal through the fan. While HIP drives the GO on, the
    /// excess only grows with the angle, so the fan is crossed whole unless the budget ends.
    Next on_fan(const Seam& seam) noexcept {
        double& phi = go_.place.parameter;
        const ConeState s = cone(outline_, go_);
        if (s.excess <= 0.0) {
            return settle_at(s);
        }
        if (!goes(s.tau)) {
            settle_at(s);
            return stop_outside(false);
        }
        if (used_ >= budget_) {
            settle_at(s);
            return stop_outside(true);
        }
        if (s.nu < 0.0) {  // HIP has left over the tip: its normal lies within the fan
            const ConeState far =
                cone(seam.point, direction_ > 0.0 ? seam.tangent_out : seam.tangent_in);
            if (direction_ * far.tau <= 0.0) {
                return settle_at(s);
            }
        }
        const double to_go = direction_ > 0.0 ? seam.turn - phi : phi;
        const double price = radius_ * to_go;
        if (price > budget_ - used_) {
            phi += direction_ * (budget_ - used_) / radius_;
            used_ = budget_;
            const ConeState turned = cone(outline_, go_);
            settle_at(turned);
            return turned.excess > 0.0 && direction_ * turned.tau > 0.0 ? stop_outside(true)
                                                                        : Next::stop;
        }
        used_ += price;
        leave(seam, direction_);
        return Next::go_on;
    }

    /// Concave vertex: two normals, two loads. F = K (V - h) is carried by both together.
    Next in_corner(const Seam& seam) noexcept {
        const ConeState after = cone(seam.point, seam.tangent_out);
        const ConeState before = cone(seam.point, seam.tangent_in);
        const bool drives_on = after.tau > 0.0 && after.excess > 0.0 && direction_ >= 0.0;
        const bool drives_back = before.tau < 0.0 && before.excess > 0.0 && direction_ <= 0.0;
        if ((drives_on || drives_back) && used_ < budget_) {
            direction_ = drives_on ? 1.0 : -1.0;
            leave(seam, direction_);
            return Next::go_on;
        }
        settle_corner(seam, before, after);
        walk_.out_of_budget = drives_on || drives_back;
        walk_.outside_cone = walk_.out_of_budget && walk_.nu <= 0.0;  // no curve carries a pull
        return Next::stop;
    }

    /// The normal of a corner is the one of its internal fan that lies nearest to the force.
    void settle_corner(const Seam& seam, const ConeState& before, const ConeState& after) noexcept {
        go_.place.parameter = 0.0;
        walk_.in_corner = true;
        if (after.tau >= 0.0) {
            settle_at(after);
        } else if (before.tau <= 0.0) {
            settle_at(before);
        } else {
            const Vec2 gap = seam.point - h_;
            const double length = glm::length(gap);
            const Vec2 normal = length > 0.0 ? gap / length : perp(after.tangent);
            settle_at({.tangent = -perp(normal), .nu = length});
        }
    }

    void leave(const Seam& seam, double direction) noexcept {
        go_ = god_object_at(outline_, direction > 0.0
                                          ? Place{.index = seam.after, .parameter = 0.0}
                                          : Place{.index = seam.before, .parameter = 1.0});
    }

    static Vec2 fan_tangent(const Seam& seam, double phi) noexcept {
        const SinCos turn = sin_cos(phi);
        return turn.cos * seam.tangent_in - turn.sin * perp(seam.tangent_in);
    }

    const Outline& outline_;
    GodObject& go_;
    Vec2 h_;
    double mu_;
    double budget_;
    double radius_;
    double used_ = 0.0;
    double direction_ = 0.0;  ///< of travel: +1, -1, or 0 before the first step
    Walk walk_{};
};

}  // namespace

GodObject god_object_at(const Outline& outline, const Place& place) noexcept {
    if (place.on_seam) {
        return {.place = place};
    }
    return {.place = place, .jet = outline.spans()[place.index].at(place.parameter)};
}

template <bool HasFriction>
Walk walk_god_object(const Outline& outline,
                     GodObject& go,
                     const Vec2& h,
                     double mu,
                     double budget,
                     double vertex_radius) noexcept {
    return Walker<HasFriction>(outline, go, h, mu, budget, vertex_radius).run();
}

template Walk walk_god_object<true>(
    const Outline&, GodObject&, const Vec2&, double, double, double) noexcept;
template Walk walk_god_object<false>(
    const Outline&, GodObject&, const Vec2&, double, double, double) noexcept;

}  // namespace palpate::engine
