#include "engine/surface/surface_slide.hpp"

#include <algorithm>
#include <cmath>

#include "engine/surface/slide_step.hpp"
#include "engine/surface/surface_flow.hpp"

namespace palpate::engine {
namespace {

using Way = Footing::Way;

/// Way beside the flow that is reported, of the size.
constexpr double kAstray = 1e-8;

/// Share of a budget that is enough for the flow if it is for steps: in a bowl the flow to the foot
/// is no longer than its parts along both axes, sqrt(2) of the straight way.
constexpr double kSure = 0.7;

/// So often a step is shortened until it does as it promised.
constexpr int kDoubts = 8;

/// The walk of one tick.
struct Slider {
    SurfaceGround ground_;
    Work work_;
    SurfaceSlew slew_;
    SurfaceFan& fan_;
    bool flow_ = ground_.mu() > 0.0;  ///< is followed; else in steps to the foot
    double size_ = ground_.surface().size();
    bool spent_ = false;
    bool strays_ = false;       ///< the last step did not follow the flow
    bool lost_ = false;         ///< the flow has no direction, or costs too much
    bool singular_ = false;     ///< the walk went on from a place without tangents
    double astray_ = 0.0;       ///< way of such steps, m
    double last_ = 0.0;         ///< length of the last step, m
    double trust_ = 1e300;      ///< so long may the next one be, m
    double last_excess_ = 0.0;  ///< before it, m
    bool done_ = false;         ///< no step is left that gains anything
    bool crease_ = false;       ///< the step goes along a concave crease
    bool foot_ = false;         ///< since the surface has no way down from here: it folds back

    SurfaceSlide run(const SurfacePlace& from) noexcept {
        Footing at{ground_.look(from)};
        const Vec3 start = at.spot.jet.point;
        if (fan_.on) {
            at = turned(from);
        } else {
            onwards(at);
        }
        double slid = glm::length(at.spot.jet.point - start);  // along the edge of a fan
        while (!ends(at.way) && !done_ && !tired()) {
            if (late(at)) {
                spent_ = true;
                break;
            }
            singular_ = singular_ || (ground_.mu() > 0.0 && singular(at.spot.jet, size_));
            if (at.way == Way::open && flow_ && !lost_ && flows(at, slid)) {
                continue;
            }
            const SurfaceSpot next = advance(at);
            const double chord = glm::length(next.jet.point - at.spot.jet.point);
            slid += chord;
            slew_.used += at.way == Way::open ? chord : edge_way(at.spot, next);
            astray_ += at.way == Way::open && strays_ ? chord : 0.0;
            at.spot = next;
            if (done_) {
                if (at.way != Way::open && !at.crease) {
                    at = ground_.carrier(next);
                }
                break;
            }
            ground_.own_normal(at);
            onwards(at);
            slid += glm::length(at.spot.jet.point - next.jet.point);
        }
        // Newton's last bits are no slip: a hand at rest finds the contact stuck.
        const bool moved = glm::length(at.spot.jet.point - start) > 4.0 * at.spot.rounding;
        return result(at, moved ? slid : 0.0);
    }

    static bool ends(Way way) noexcept {
        return way == Way::rests || way == Way::held || way == Way::over;
    }

    /// The budget is spent; in steps: they are not sure to come to the foot within it.
    [[nodiscard]] bool late(const Footing& at) const noexcept {
        const bool steps = !flow_ && slew_.limited();
        const double to = steps && at.way == Way::open ? SurfaceSteps(at.spot, size_).reach() : 0.0;
        return steps ? !(slew_.used + to <= kSure * slew_.budget) : slew_.spent();
    }

    /// Along the flow to the cone, or over an edge of the patch. False where it has to go on in
    /// steps.
    bool flows(Footing& at, double& slid) noexcept {
        using End = SurfaceFlow::Arrival::End;
        const Vec3 from = at.spot.jet.point;
        const SurfaceFlow::Arrival to =
            SurfaceFlow(ground_, work_ / 2).follow(at.spot, slew_.budget - slew_.used);
        strays_ = to.end != End::foot;
        lost_ = to.end == End::failed;  // in steps from here on, and it is reported
        if (!(to.spot.r2 <= at.spot.r2 + 12.0 * std::sqrt(at.spot.r2) * at.spot.noise)) {
            return false;
        }
        slid += to.way;
        slew_.used += to.way;
        last_ = last_excess_ = 0.0;
        trust_ = 1e300;
        at.spot = to.spot;
        switch (to.end) {
            case End::cone:
            case End::spent:
                ground_.on_patch(at);
                done_ = to.end == End::cone;
                return true;
            case End::edge:
                onwards(at);
                slid += glm::length(at.spot.jet.point - to.spot.jet.point);
                return glm::length(to.spot.jet.point - from) > 4.0 * to.spot.noise;
            default:
                ground_.on_patch(at);
                return tired() || at.way != Way::open;
        }
    }

    /// Where the god-object goes on; over a convex edge, with a vertex slew, through its fan.
    void onwards(Footing& at) noexcept {
        if (!slew_.limited()) {
            ground_.footing(at);
            return;
        }
        const SurfaceSpot s = at.spot;
        ground_.footing(at);
        const SurfacePlace& to = at.spot.place;
        const bool stays = to.surface == s.place.surface && to.i == s.place.i && to.j == s.place.j;
        const bool leads = at.way != Way::held && !(at.way == Way::over && s.load <= 0.0);
        if (!stays && leads && falls_away(s, at.spot)) {
            fan_ = {.on = true, .beyond = to, .angle = 0.0};
            at = turned(s.place);
        }
    }

    Footing turned(const SurfacePlace& place) noexcept {
        const FanTurn turn = turn_in_fan(ground_, place, fan_, slew_);
        spent_ = turn.end == FanTurn::End::spent;
        if (turn.end == FanTurn::End::back || turn.end == FanTurn::End::beyond) {
            Footing at{turn.spot};
            ground_.on_patch(at);
            return at;
        }
        const bool rests = turn.end == FanTurn::End::rests;
        return {turn.spot, rests ? Way::rests : Way::held, turn.spot.excess};
    }

    /// The next spot; `done_` when there is nothing left to gain: where a walk that begins here
    /// would end at once, so that a hand at rest finds nothing to do.
    SurfaceSpot advance(const Footing& at) noexcept {
        crease_ = at.crease;
        const SurfaceSpot next = step_on(at);
        if (!done_ || last_ == 0.0) {
            return next;
        }
        last_ = last_excess_ = 0.0;
        trust_ = 1e300;
        done_ = foot_ = false;
        return step_on(at);
    }

    SurfaceSpot step_on(const Footing& at) noexcept {
        const SurfaceSpot& s = at.spot;
        const SurfaceSteps steps(s, size_);
        const double noise = 12.0 * std::sqrt(s.r2) * s.noise;  // of two evaluations
        const double whole = std::min(first_length(at, steps, ground_.mu(), last_, last_excess_),
                                      slew_.budget - slew_.used);
        double length = std::min(whole, trust_);
        last_excess_ = at.excess;
        bool tried = false;
        int doubts = 0;
        while (!tired()) {
            const SurfaceStep step = cut(s, step_of(at, steps, length));
            if (still(step)) {
                break;
            }
            const SurfaceSpot next = go(s, step, 1.0);
            if (const double share = paid(at, step, next, slew_.budget - slew_.used); share < 1.0) {
                length = share * step.length;
                continue;
            }
            const double fall = s.r2 - next.r2;
            // Lower by more than rounding, or as low and much nearer to the cone.
            if (fall > noise || (fall >= -noise && left(at, step, next) <= 0.5 * at.excess)) {
                // What does not as it promised may leap over a foot.
                const bool leaps = ground_.mu() == 0.0 && !steps.believed(step, next, fall, noise);
                if (leaps && doubts++ < kDoubts) {
                    length = 0.25 * std::min(length, step.length);
                    continue;
                }
                strays_ = leaps || (strays_ && ground_.mu() > 0.0);
                const SurfaceSpot end = over(at, next, step) ? close_in(at, step, next) : next;
                if (s.r2 - end.r2 >= -noise) {  // not so where the cone lies behind a rise
                    last_ = step.length;
                    trust_ = tried || doubts > 0 || trust_ < 1e299 ? 3.0 * length : trust_;
                    return end;
                }
                tried = true;
                length = 0.25 * std::min(length, step.length);
                continue;
            }
            if (fall >= -noise && length >= trust_ && length < whole) {
                length = whole;  // too careful to see anything
                trust_ = 1e300;
                continue;
            }
            if (fall >= -noise &&
                (last_bits(s) || (step.newton && 2.0 * steps.fall(step) <= noise))) {
                foot_ = step.newton;
                break;
            }
            SurfacePlace pole = s.place;
            if (!tried && ground_.to_pole(pole) && over_pole(s, length, pole)) {
                return ground_.look(pole);
            }
            tried = true;
            length = 0.25 * std::min(length, step.length);
        }
        done_ = true;
        return s;
    }

    /// Near a pole the parameters turn too fast to go past: over it, then.
    [[nodiscard]] bool over_pole(const SurfaceSpot& s,
                                 double length,
                                 const SurfacePlace& pole) noexcept {
        const SurfaceSpot there = ground_.look(pole);
        return there.r2 < s.r2 && glm::length(there.jet.point - s.jet.point) <= length;
    }

    [[nodiscard]] SurfaceSpot go(const SurfaceSpot& s,
                                 const SurfaceStep& step,
                                 double share) noexcept {
        SurfacePlace p = s.place;
        p.u = std::clamp(p.u + share * step.du, 0.0, 1.0);
        p.v = std::clamp(p.v + share * step.dv, 0.0, 1.0);
        if (!crease_) {
            return ground_.look(p);
        }
        SurfaceSpot there = ground_.look(p);
        ground_.against_hip(there, step.du != 0.0 ? there.jet.du : there.jet.dv);
        return there;
    }

    /// The step went into the cone by more than rounding, or past it.
    [[nodiscard]] bool over(const Footing& at,
                            const SurfaceSpot& next,
                            const SurfaceStep& step) const noexcept {
        return ground_.mu() > 0.0 &&
               (measure(at, step, next) < -next.rounding || ahead(step, next) < -next.cone);
    }

    [[nodiscard]] SurfaceSpot close_in(const Footing& at,
                                       const SurfaceStep& step,
                                       const SurfaceSpot& end) noexcept {
        double share = 1.0;
        const SurfaceSpot inside = measure(at, step, end) < 0.0 ? end : turn(at, step, end, share);
        return measure(at, step, inside) < 0.0 ? edge_of_cone(at, step, inside, share) : inside;
    }

    /// Where HIP is overtaken on the way of a step, which was too long: there |r| is smallest, and
    /// the cone is there, or this way misses it. `share` of the step. Regula falsi, roughly.
    [[nodiscard]] SurfaceSpot turn(const Footing& at,
                                   const SurfaceStep& step,
                                   const SurfaceSpot& end,
                                   double& share) noexcept {
        SurfaceSpot best = end;
        double before = 0.0;
        double after = 1.0;
        double f_before = ahead(step, at.spot);
        double f_after = ahead(step, end);
        while (!tired()) {
            const double x =
                std::clamp((before * f_after - after * f_before) / (f_after - f_before),
                           before + 0.1 * (after - before), after - 0.1 * (after - before));
            const SurfaceSpot spot = go(at.spot, step, x);
            const double f = ahead(step, spot);
            if (spot.r2 < best.r2 || spot.excess < 0.0) {
                best = spot;
                share = x;
            }
            if (spot.excess < 0.0 || std::fabs(f) <= 0.1 * spot.length || after - before < 1e-6) {
                break;
            }
            (f > 0.0 ? before : after) = x;
            (f > 0.0 ? f_before : f_after) = f;
        }
        return best;
    }

    /// Between a spot outside and one within, `share` of a step away, the one on the inner side of
    /// the cone: regula falsi with the Illinois rule.
    [[nodiscard]] SurfaceSpot edge_of_cone(const Footing& at,
                                           const SurfaceStep& step,
                                           const SurfaceSpot& inside,
                                           double share) noexcept {
        SurfaceSpot best = inside;
        double outer = 0.0;
        double inner = share;
        double f_outer = measure(at, step, at.spot) + 0.5 * at.spot.rounding;
        double f_inner = measure(at, step, inside) + 0.5 * inside.rounding;
        int last = 0;
        while (!tired()) {
            double x = (outer * f_inner - inner * f_outer) / (f_inner - f_outer);
            if (!(x > outer && x < inner)) {
                x = 0.5 * (outer + inner);
            }
            if (x == outer || x == inner) {
                break;
            }
            const SurfaceSpot spot = go(at.spot, step, x);
            const double excess = measure(at, step, spot);
            if (excess <= 0.0) {
                best = spot;
                if (excess >= -spot.rounding) {
                    break;
                }
            }
            const double f = excess + 0.5 * spot.rounding;
            const bool out = f > 0.0;
            (out ? outer : inner) = x;
            (out ? f_outer : f_inner) = f;
            (out ? f_inner : f_outer) *= last == (out ? 1 : -1) ? 0.5 : 1.0;
            last = out ? 1 : -1;
        }
        return best;
    }

    [[nodiscard]] bool tired() const noexcept { return ground_.work() >= work_; }

    [[nodiscard]] SurfaceSlide result(const Footing& at, double slid) const noexcept {
        const SurfaceSpot& s = at.spot;
        const bool barred = at.way == Way::held && !done_;
        const bool over = at.way == Way::over;
        const bool fine = barred ? s.excess <= 1e-13 * (size_ + std::sqrt(s.r2)) : last_bits(s);
        const bool outside = !over && !SurfaceGround::settled(s) && !fine;
        return {.place = s.place,
                .point = s.jet.point,
                .normal = s.normal,
                .tangential = s.along,
                .length = s.length,
                .load = over ? -std::sqrt(s.r2) : s.load,
                .slid = slid,
                .outside_cone = outside,
                .in_crease = at.crease,
                .out_of_budget = spent_,
                .on_flow = !singular_ && astray_ <= kAstray * size_,
                .settled = !tired() && (!outside || barred || foot_ || spent_)};
    }

    /// Newton's steps have come to where rounding decides, or soon will.
    [[nodiscard]] bool last_bits(const SurfaceSpot& s) const noexcept {
        return s.excess <= 3e-11 * (size_ + std::sqrt(s.r2)) || s.excess <= 4.0 * ground_.turn(s);
    }
};

}  // namespace

SurfaceSlide slide_on_surface(const SurfaceObject& surface,
                              const SurfacePlace& from,
                              const Vec3& h,
                              double mu,
                              Work work) noexcept {
    SurfaceFan none;
    return Slider{SurfaceGround(surface, h, mu), work, {}, none}.run(from);
}

SurfaceSlide slide_on_surface(const SurfaceObject& surface,
                              const SurfacePlace& from,
                              const Vec3& h,
                              double mu,
                              const SurfaceSlew& slew,
                              SurfaceFan& fan) noexcept {
    // Without friction all ways lead to the foot, and steps lead there soonest; but where a budget
    // may end on the way, its end lies on the flow, whatever the patches.
    const SurfaceFan before = fan;
    Slider walk{SurfaceGround(surface, h, mu), kSlideWork, slew, fan};
    const SurfaceSlide slide = walk.run(from);
    if (walk.flow_ || (!slide.out_of_budget && walk.slew_.used <= kSure * slew.budget)) {
        return slide;
    }
    fan = before;
    const Work rest = kSlideWork - walk.ground_.work();
    return Slider{SurfaceGround(surface, h, mu), rest, slew, fan, true}.run(from);
}

}  // namespace palpate::engine
