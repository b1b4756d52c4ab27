#include "engine/friction/god_object.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/math/elementary.hpp"

namespace palpate::engine {
namespace {

/// The budget without a vertex slew.
constexpr double kNever = std::numeric_limits<double>::infinity();

/// What happens after a step on one span or seam.
enum class Next : std::uint8_t { go_on, stop };

template <bool HasFriction>
struct Walker {
    const ConeForms& forms_;
    const Outline& outline_;
    GodObject& go_;
    Vec2 from_;
    Vec2 h_;
    double mu_;
    double budget_;
    double radius_;
    double used_ = 0.0;
    double direction_ = 0.0;  ///< of travel: +1, -1, or 0 before the first step
    Walk walk_{};

    Walk run() noexcept {
        // Each span and seam is passed once, for the stretch only falls. Rounding cannot cycle
        // either.
        const auto visits = [this] {
            return 2 * (outline_.spans().size() + outline_.seams().size() + 1);
        };
        for (std::size_t i = 0; i == 0 || i < visits(); ++i) {
            if (step() == Next::stop) {
                return walk_;
            }
        }
        settle_at(cone(go_));
        walk_.outside_cone = true;
        walk_.unproven = true;
        return walk_;
    }

    Next step() noexcept {
        if (!go_.place.on_seam) {
            return on_span();
        }
        const Seam& seam = outline_.seams()[go_.place.index];
        return seam.kind == SeamKind::concave ? in_corner(seam) : on_fan(seam);
    }

    [[nodiscard]] ConeView cone(const Vec2& point, const Vec2& tangent) const noexcept {
        return cone_view<HasFriction>(h_, point, tangent, mu_);
    }
    [[nodiscard]] ConeView cone(const GodObject& go) const noexcept {
        if (go.place.on_seam) {
            const Seam& seam = outline_.seams()[go.place.index];
            return cone(seam.point, fan_tangent(seam, go.place.parameter));
        }
        if (outline_.arc(go.place.index) != nullptr) {
            return cone(go.spot.jet.point, go.spot.jet.first);
        }
        const Vec2 along = forms_.tame(go.place.index)
                             ? go.spot.jet.first
                             : forms_.heading(go.place.index, go.spot.u, go.spot.rest);
        return cone(go.spot.jet.point, along * (1.0 / std::sqrt(glm::dot(along, along))));
    }

    /// The walk ends here, with this stretch.
    Next settle_at(const ConeView& s) noexcept {
        walk_.point =
            go_.place.on_seam ? outline_.seams()[go_.place.index].point : go_.spot.jet.point;
        walk_.see(s);
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
        const double drive = direction();
        if (drive == 0.0 || !goes(drive)) {
            return settle_at(cone(go_));
        }
        if (used_ >= budget_) {
            settle_at(cone(go_));
            return stop_outside(true);
        }
        return slide();
    }

    [[nodiscard]] SlideTask task() const noexcept {
        return {.forms = forms_,
                .span = go_.place.index,
                .h = h_,
                .mu = mu_,
                .dir = direction_,
                .budget = budget_};
    }

    /// Of the drive: by the jet where the span is tame, by the forms elsewhere.
    [[nodiscard]] double direction() const noexcept {
        if (const Arc* arc = outline_.arc(go_.place.index)) {
            return drive_at(*arc, go_.spot.jet, h_).direction<HasFriction>(mu_);
        }
        return forms_.tame(go_.place.index) ? drive_at(go_.spot.jet, h_).direction<HasFriction>(mu_)
                                            : direction_by_forms<HasFriction>(task(), go_.spot);
    }

    Next slide() noexcept {
        const double u = go_.spot.u;
        const double rest = go_.spot.rest;
        const SlideEnd end = slide(task(), go_.spot);
        walk_.slid = walk_.slid || go_.spot.u != u || go_.spot.rest != rest;
        go_.place.parameter = go_.spot.u;
        if (end == SlideEnd::at_end) {
            return over_end(go_.place.index);
        }
        settle_at(cone(go_));
        return end == SlideEnd::out_of_budget ? stop_outside(true) : Next::stop;
    }

    SlideEnd slide(const SlideTask& way, Spot& spot) noexcept {
        const Arc* arc = outline_.arc(way.span);
        if (arc == nullptr) {
            return slide_to_cone<HasFriction>(way, spot, go_.proof, used_);
        }
        SlideEnd end = slide_on_arc<HasFriction>(*arc, way, spot, used_);
        if (end == SlideEnd::unclear) {
            spot = spot_at(outline_.spans()[way.span], spot.u, spot.rest);
            end = slide_to_cone<HasFriction>(way, spot, go_.proof, used_);
            spot = spot_at(*arc, spot.u, spot.rest);
        }
        return end;
    }

    Next over_end(std::size_t span) noexcept {
        const bool forward = direction_ > 0.0;
        const auto seam = outline_.seam_beyond(span, forward);
        if (!seam) {  // an open end holds the GO
            settle_at(cone(go_));
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
        const ConeView s = cone(go_);
        if (s.excess <= 0.0 || !goes(s.tau)) {
            return settle_at(s);
        }
        if (budget_ < kNever && seam.kind == SeamKind::convex) {
            used_ = std::max(used_, driven_from(seam.point, s) * budget_);
        }
        if (used_ >= budget_) {
            settle_at(s);
            return stop_outside(true);
        }
        const ConeView far =
            cone(seam.point, direction_ > 0.0 ? seam.tangent_out : seam.tangent_in);
        const bool over_tip =
            direction_ * far.tau <= 0.0 && (s.nu < 0.0 || far.nu < std::fabs(far.tau));
        if (seam.kind == SeamKind::smooth && direction_ * far.tau <= 0.0 && s.nu > 0.0) {
            return settle_at(against_hip(h_, seam.point,
                                         s.tangent));  // hollow: each span drives it to the other
        }
        const double left = direction_ > 0.0 ? seam.turn - phi : phi;
        if (seam.kind == SeamKind::convex && steps_back(s, left)) {
            return Next::stop;
        }
        const double price = radius_ * left;
        const bool pays = price <= budget_ - used_;
        if (over_tip && (pays || s.nu < 0.0)) {  // the normal that points at HIP lies in the fan
            return settle_at({.tangent = s.tangent, .nu = -glm::length(h_ - seam.point)});
        }
        walk_.slid =
            walk_.slid || (budget_ < kNever && seam.kind == SeamKind::convex);  // a turn is no rest
        if (!pays) {
            phi += direction_ * (budget_ - used_) / radius_;
            used_ = budget_;
            const ConeView turned = cone(go_);
            settle_at(turned);
            return turned.excess > 0.0 && direction_ * turned.tau > 0.0 ? stop_outside(true)
                                                                        : Next::stop;
        }
        used_ += price;
        leave(seam, direction_);
        return Next::go_on;
    }

    /// Beyond the vertex the outline turns back, as a step does: the whole way to where the
    /// god-object is held again costs what the normal differs by at its end, and is gone at once.
    /// A step would else cost two turns that nobody could feel, and have no force meanwhile.
    /// @param s     in the fan, before
    /// @param left  angle of the fan that is left, rad
    bool steps_back(const ConeView& s, double left) noexcept {
        if (budget_ == kNever) {
            return false;
        }
        GodObject go = go_;
        const Walk end = walk_god_object<HasFriction>(forms_, go, h_, h_, mu_, kNever, 0.0);
        const double net =
            direction_ * arc_tan2(-cross(s.tangent, end.tangent), glm::dot(s.tangent, end.tangent));
        walk_.lost_beyond = end.nu <= 0.0;
        if (walk_.lost_beyond || end.outside_cone || net >= left ||
            !(end.met_corner || net <= 0.0) || radius_ * net > budget_ - used_) {
            return false;
        }
        go_ = go;
        walk_ = end;
        walk_.slid = true;
        return true;
    }

    /// Share of the tick after which HIP, on its straight way to a stretch outside of the cone,
    /// drives the god-object on from here. Drive and excess are linear in it.
    [[nodiscard]] double driven_from(const Vec2& point, const ConeView& s) const noexcept {
        const ConeView before = cone_view<HasFriction>(from_, point, s.tangent, mu_);
        const double drive = direction_ * before.tau;
        const double excess = drive - (HasFriction ? mu_ * before.nu : 0.0);
        const auto from = [](double then, double now) {
            return then < 0.0 ? then / (then - now) : 0.0;
        };
        const double drive_now = direction_ * s.tau;
        return std::max(from(drive, drive_now),
                        from(excess, drive_now - (HasFriction ? mu_ * s.nu : 0.0)));
    }

    /// Concave vertex: held by the two sides, or out along one of them.
    Next in_corner(const Seam& seam) noexcept {
        walk_.met_corner = true;
        const Groove groove{.before = cone(seam.point, seam.tangent_in),
                            .after = cone(seam.point, seam.tangent_out)};
        const double out = groove.way_out<HasFriction>(direction_);
        if (out != 0.0 && used_ < budget_) {
            direction_ = out;
            leave(seam, direction_);
            return Next::go_on;
        }
        go_.place.parameter = 0.0;
        walk_.in_corner = true;
        settle_at(groove.felt(h_, seam.point));
        walk_.out_of_budget = out != 0.0;
        walk_.outside_cone = walk_.out_of_budget && walk_.nu <= 0.0;  // no curve carries a pull
        return Next::stop;
    }

    void leave(const Seam& seam, double direction) noexcept {
        go_ = god_object_at(outline_, direction > 0.0
                                          ? Place{.index = seam.after, .parameter = 0.0}
                                          : Place{.index = seam.before, .parameter = 1.0});
    }

    /// A smooth seam, which may be hollow, has the tangents of its two ends only.
    static Vec2 fan_tangent(const Seam& seam, double phi) noexcept {
        if (seam.kind == SeamKind::smooth) {
            return phi > 0.0 ? seam.tangent_out : seam.tangent_in;
        }
        const SinCos turn = sin_cos(phi);
        return turn.cos * seam.tangent_in - turn.sin * perp(seam.tangent_in);
    }
};

}  // namespace

GodObject god_object_at(const Outline& outline, const Place& place) noexcept {
    if (place.on_seam) {
        return {.place = place};
    }
    const double rest = 1.0 - place.parameter;
    const Arc* arc = outline.arc(place.index);
    return {.place = place,
            .spot = arc != nullptr ? spot_at(*arc, place.parameter, rest)
                                   : spot_at(outline.spans()[place.index], place.parameter, rest)};
}

Walk touch_down(const Outline& outline, GodObject& go, const Place& place, const Vec2& h) noexcept {
    go = god_object_at(outline, place);
    const Vec2 point = place.on_seam ? outline.seams()[place.index].point : go.spot.jet.point;
    const double depth = glm::length(point - h);
    const Vec2 normal = depth > 0.0 ? (point - h) * (1.0 / depth) : Vec2{0.0, 1.0};
    // tau = -0 gives a tangential force of +0.
    return {.point = point,
            .normal = normal,
            .tangent = -perp(normal),
            .tau = -0.0,
            .nu = depth,
            .in_corner = place.on_seam && outline.seams()[place.index].kind == SeamKind::concave};
}

template <bool HasFriction>
Walk walk_god_object(const ConeForms& forms,
                     GodObject& go,
                     const Vec2& from,
                     const Vec2& h,
                     double mu,
                     double budget,
                     double vertex_radius) noexcept {
    return Walker<HasFriction>{forms, forms.outline(), go, from, h, mu, budget, vertex_radius}
        .run();
}

template Walk walk_god_object<true>(
    const ConeForms&, GodObject&, const Vec2&, const Vec2&, double, double, double) noexcept;
template Walk walk_god_object<false>(
    const ConeForms&, GodObject&, const Vec2&, const Vec2&, double, double, double) noexcept;

}  // namespace palpate::engine
