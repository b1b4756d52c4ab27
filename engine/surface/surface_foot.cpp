#include "engine/surface/surface_foot.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/surface/surface_object.hpp"

namespace palpate::engine {
namespace {

/// Narrow bent valleys (weights of 1e3) are followed in many short steps; 3 are usual.
constexpr int kFootSteps = 400;
constexpr int kMaxHalvings = 40;
constexpr Work kStepWork = 100;  ///< besides the evaluation

struct Descent {
    const SurfaceObject& surface_;
    Vec3 h_;
    PatchPart part_;
    bool cross_;
    Work& work_;
    SurfaceFoot foot_{};
    int hops_ = 0;
    int stalls_ = 0;
    double last_ = std::numeric_limits<double>::infinity();

    SurfaceFoot run(const SurfacePlace& start) noexcept {
        foot_.place = start;
        look(foot_);
        for (int i = 0; i < kFootSteps && work_ > 0; ++i) {
            if (!step()) {
                break;
            }
        }
        return foot_;
    }

    struct Step {
        double u = 0.0;
        double v = 0.0;
        bool newton = false;
    };

    void look(SurfaceFoot& foot) const noexcept {
        work_ -= surface_.patch(foot.place).work() + kStepWork;
        foot.jet = surface_.local_jet(foot.place);
        const Vec3 r = foot.jet.point - h_;
        foot.distance2 = glm::dot(r, r);
    }

    /// One step; false when there is nothing left to gain.
    bool step() noexcept {
        const FootSlope slope(foot_.jet, foot_.jet.point - h_);
        const SurfacePlace& p = foot_.place;
        // Downhill is over the edge: to the next patch, or along the border.
        const bool fix_u = leaves(p.u, -slope.u, part_.lo_u, part_.hi_u);
        const bool fix_v = leaves(p.v, -slope.v, part_.lo_v, part_.hi_v);
        if ((fix_u && hop(true, slope.u < 0.0)) || (fix_v && hop(false, slope.v < 0.0))) {
            return true;
        }
        foot_.on_border = fix_u || fix_v;
        Step d = direction(slope, fix_u, fix_v);
        // The step leaves where downhill does not: its other part goes first.
        if (leaves(p.u, d.u, part_.lo_u, part_.hi_u)) {
            d = direction(slope, true, fix_v);
        } else if (leaves(p.v, d.v, part_.lo_v, part_.hi_v)) {
            d = direction(slope, fix_u, true);
        }
        return advance(d);
    }

    static bool leaves(double at, double step, double lo, double hi) noexcept {
        return (step < 0.0 && at <= lo) || (step > 0.0 && at >= hi);
    }

    /// Newton's step, with the parameters at a bound kept.
    Step direction(const FootSlope& g, bool fix_u, bool fix_v) const noexcept {
        if (fix_u && fix_v) {
            return {};
        }
        const SurfaceJet& j = foot_.jet;
        if (fix_u) {
            return {0.0, along(g.v, g.vv, glm::dot(j.dv, j.dv)), g.vv > 0.0};
        }
        if (fix_v) {
            return {along(g.u, g.uu, glm::dot(j.du, j.du)), 0.0, g.uu > 0.0};
        }
        if (g.bowl()) {
            const double det = g.uu * g.vv - g.uv * g.uv;
            return within(g,
                          {(g.uv * g.v - g.vv * g.u) / det, (g.uv * g.u - g.uu * g.v) / det, true});
        }
        return out_of_saddle(g);
    }

    /// Where a bowl's lowest point lies over a bound: the lowest point on that bound. Cutting the
    /// step short instead would creep along a narrow valley.
    Step within(const FootSlope& g, Step d) const noexcept {
        const SurfacePlace& p = foot_.place;
        const bool at_bound = p.u <= part_.lo_u || p.u >= part_.hi_u || p.v <= part_.lo_v ||
                              p.v >= part_.hi_v;  // then step() decides what stays
        const double u = std::clamp(p.u + d.u, part_.lo_u, part_.hi_u) - p.u;
        const double v = std::clamp(p.v + d.v, part_.lo_v, part_.hi_v) - p.v;
        if (at_bound || (std::fabs(u) >= std::fabs(d.u) && std::fabs(v) >= std::fabs(d.v))) {
            return d;
        }
        if (std::fabs(u) < std::fabs(d.u)) {
            const double best = -(g.v + g.uv * u) / g.vv;
            d = {u, std::clamp(p.v + best, part_.lo_v, part_.hi_v) - p.v, true};
        } else {
            const double best = -(g.u + g.uv * v) / g.uu;
            d = {std::clamp(p.u + best, part_.lo_u, part_.hi_u) - p.u, v, true};
        }
        return d;
    }

    /// Newton's step with the sign of both eigenvalues made positive, which always leads downhill.
    /// In parameters scaled to equal speed.
    Step out_of_saddle(const FootSlope& g) const noexcept {
        const double tiny = 1e-30 * surface_.size() * surface_.size();
        const double by_u = 1.0 / std::sqrt(glm::dot(foot_.jet.du, foot_.jet.du) + tiny);
        const double by_v = 1.0 / std::sqrt(glm::dot(foot_.jet.dv, foot_.jet.dv) + tiny);
        const double a = by_u * by_u * g.uu;
        const double b = by_u * by_v * g.uv;
        const double c = by_v * by_v * g.vv;
        const double skew = 0.5 * (a - c);
        const double spread = std::sqrt(skew * skew + b * b);
        const double high = 0.5 * (a + c) + spread;
        const double low = 0.5 * (a + c) - spread;
        Vec2 axis{b, high - a};  // eigenvector of `high`, the better conditioned of two forms
        if (skew > 0.0) {
            axis = Vec2{high - c, b};
        }
        const double length = glm::length(axis);
        axis = length > 0.0 ? axis / length : Vec2{1.0, 0.0};
        const double floor = 1e-6 * std::max({std::fabs(high), std::fabs(low), 1e-6});
        const Vec2 slope{by_u * g.u, by_v * g.v};
        const Vec2 other = perp(axis);
        const Vec2 d = (-glm::dot(slope, axis) / std::max(std::fabs(high), floor)) * axis +
                       (-glm::dot(slope, other) / std::max(std::fabs(low), floor)) * other;
        return {by_u * d.x, by_v * d.y, false};
    }

    static double along(double slope, double bend, double metric) noexcept {
        const double by = bend > 0.0 ? bend : metric;
        return by > 0.0 ? -slope / by : 0.0;
    }

    /// To the next patch over the edge, unless the slope there points straight back (a crease).
    bool hop(bool in_u, bool forward) noexcept {
        if (!cross_ || hops_ >= 8) {
            return false;
        }
        SurfaceFoot next = foot_;
        SurfaceHeading way{in_u, forward};
        if (!surface_.cross(next.place, way)) {
            return false;
        }
        next.jet = surface_.local_jet(next.place);
        const Vec3 r = next.jet.point - h_;
        const double slope = glm::dot(r, way.in_u ? next.jet.du : next.jet.dv);
        if ((slope > 0.0) == way.forward && slope != 0.0) {
            return false;
        }
        foot_.place = next.place;
        foot_.jet = next.jet;
        ++hops_;
        return true;
    }

    /// Largest share of a step that stays between the bounds.
    static double share(double at, double step, double lo, double hi) noexcept {
        const double room = step > 0.0 ? hi - at : lo - at;
        return step != 0.0 && std::fabs(step) > std::fabs(room) ? room / step : 1.0;
    }

    /// Newton's steps that do not halve any more, twice: the bottom, to rounding.
    bool stalled(bool settling, double length) noexcept {
        stalls_ = settling && length > 0.5 * last_ ? stalls_ + 1 : 0;
        return stalls_ >= 2;
    }

    /// After steps a and b the next one is b^3 / a^2 long, if they converge quadratically as they
    /// should: no need to see it when it is below rounding.
    [[nodiscard]] bool bottom_after(double length) const noexcept {
        return last_ < 1e-2 * surface_.size() && length < 1e-2 * last_ &&
               length * length * length < 1e-18 * surface_.size() * last_ * last_;
    }

    bool advance(const Step& d) noexcept {
        const double full = std::min(share(foot_.place.u, d.u, part_.lo_u, part_.hi_u),
                                     share(foot_.place.v, d.v, part_.lo_v, part_.hi_v));
        const double length = glm::length(d.u * foot_.jet.du + d.v * foot_.jet.dv);
        const bool settling = d.newton && length <= 1e-6 * surface_.size();
        if (!(std::fabs(d.u) + std::fabs(d.v) > 0.25 * kEpsilon) || stalled(settling, length)) {
            return false;  // below the last bit, or no longer shrinking: rounding
        }
        const double rounding = 8.0 * kEpsilon * surface_.size() * std::sqrt(foot_.distance2);
        double t = full;
        for (int i = 0; i < kMaxHalvings; ++i) {
            SurfaceFoot next = foot_;
            next.place.u = moved(foot_.place.u, t * d.u, part_.lo_u, part_.hi_u);
            next.place.v = moved(foot_.place.v, t * d.v, part_.lo_v, part_.hi_v);
            if (next.place.u == foot_.place.u && next.place.v == foot_.place.v) {
                return false;
            }
            look(next);
            if (next.distance2 < foot_.distance2 ||
                (settling && i == 0 && next.distance2 <= foot_.distance2 + rounding)) {
                foot_ = next;
                hops_ = 0;
                const bool whole = d.newton && t == 1.0;
                const bool done = whole && settling && bottom_after(length);
                last_ = whole ? length : std::numeric_limits<double>::infinity();
                return !done;
            }
            t *= 0.5;
        }
        return false;
    }

    static double moved(double at, double step, double lo, double hi) noexcept {
        const double next = std::clamp(at + step, lo, hi);
        // A step cut at a bound ends on it, not some bits before.
        return step > 0.0 && hi - next <= kEpsilon ? hi
             : step < 0.0 && next - lo <= kEpsilon ? lo
                                                   : next;
    }
};

}  // namespace

SurfaceFoot descend(const SurfaceObject& surface,
                    const Vec3& h,
                    const SurfacePlace& start,
                    Work& work) noexcept {
    return Descent{surface, h, {}, true, work}.run(start);
}

SurfaceFoot descend_within(const SurfaceObject& surface,
                           const Vec3& h,
                           const SurfacePlace& start,
                           const PatchPart& part,
                           Work& work) noexcept {
    return Descent{surface, h, part, false, work}.run(start);
}

}  // namespace palpate::engine
