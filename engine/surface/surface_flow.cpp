#include "engine/surface/surface_flow.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::engine {
namespace {

/// Of a step, as a share of the stretch.
constexpr double kFlowError = 2e-11;
/// A flow that asks for steps that are shorter than this, of the size, has no direction to speak
/// of.
constexpr double kLeast = 1e-8;
constexpr Work kStageWork = 150;  ///< besides the evaluation
constexpr double kBorder = 8.0 * kEpsilon;
constexpr double kBeyond = 1.02;  ///< share of a step up to which its quintic is believed

/// A cubic between two nodes, with its slope.
struct Cubic {
    double x0, h, c0, c1, c2, c3;

    template <class Node>
    Cubic(const Node& a, const Node& b) noexcept
        : x0(a.x), h(b.x - a.x), c0(a.excess), c1(h * a.rate) {
        const double rise = b.excess - a.excess;
        c2 = 3.0 * rise - 2.0 * c1 - h * b.rate;
        c3 = c1 + h * b.rate - 2.0 * rise;
    }
    [[nodiscard]] double value(double x) const noexcept {
        const double t = (x - x0) / h;
        return c0 + t * (c1 + t * (c2 + t * c3));
    }
    [[nodiscard]] double slope(double x) const noexcept {
        const double t = (x - x0) / h;
        return (c1 + t * (2.0 * c2 + t * 3.0 * c3)) / h;
    }
    /// Where it is lowest between its ends, if it falls at the first and rises at the second.
    [[nodiscard]] double lowest() const noexcept {
        double lo = 0.0;
        double hi = 1.0;
        for (int i = 0; i < 30; ++i) {
            const double t = 0.5 * (lo + hi);
            (c1 + t * (2.0 * c2 + t * 3.0 * c3) < 0.0 ? lo : hi) = t;
        }
        return x0 + hi * h;
    }
};

/// The share of a step at which one parameter leaves [0, 1] first; 2 if it does not.
double leaves_at(const FlowArc& arc, bool in_u, double& border) noexcept {
    const auto value = [&arc, in_u](double x) {
        const Vec2 at = arc.at(x);
        return in_u ? at.x : at.y;
    };
    constexpr int kSamples = 8;
    double before = 0.0;
    for (int k = 1; k <= kSamples; ++k) {
        const double x = static_cast<double>(k) / kSamples;
        const double there = value(x);
        if (there >= -kBorder && there <= 1.0 + kBorder) {
            before = x;
            continue;
        }
        border = there < 0.5 ? 0.0 : 1.0;
        double lo = before;
        double hi = x;
        for (int i = 0; i < 60 && hi - lo > 1e-16; ++i) {
            const double middle = 0.5 * (lo + hi);
            const double at = value(middle);
            ((border == 0.0 ? at > 0.0 : at < 1.0) ? lo : hi) = middle;
        }
        return hi;
    }
    return 2.0;
}

bool within(double t, double bulge) noexcept {
    return t > bulge && t < 1.0 - bulge;
}

}  // namespace

FlowSpot SurfaceFlow::look(const Vec2& at) noexcept {
    place_.u = at.x;
    place_.v = at.y;
    return flow_spot(ground_.jet(place_, kStageWork), at, ground_.h(), ground_.mu());
}

bool SurfaceFlow::short_step(const FlowSpot& a, double h, Step& step) noexcept {
    const Vec2 to = a.at + h * (a.way + (0.5 * h) * a.bend);
    step.to = look(to);
    const FlowSpot& b = step.to;
    if (!b.regular) {
        return false;
    }
    const Vec2 by = (0.5 * h) * (b.way - a.way) - (h * h / 12.0) * (5.0 * a.bend + b.bend);
    const double off = b.measure(by);
    step.h = h;
    // The corrector's derivatives are those at the predictor's end.
    step.error = 0.5 * off * std::max(h * a.measure(a.bend), std::sqrt(6.0 * off / h));
    step.end = to + by;
    step.excess = b.excess + b.excess_by(by, ground_.mu());
    step.nodes[0] = {0.0, a.excess, h * a.rate};
    step.nodes[1] = {1.0, step.excess, h * b.rate};
    step.count = 2;
    return step.error <= tolerance_ && off < 1e-2 * h;
}

bool SurfaceFlow::long_step(const FlowSpot& a, double h, Step& step) noexcept {
    const double h2 = h * h;
    const FlowSpot p = look(a.at + (0.2 * h) * a.way + (0.02 * h2) * a.bend);
    if (!p.regular) {
        step.error = 1e300;
        return false;
    }
    const FlowSpot q = look(a.at + (2.0 / 3.0 * h) * a.way + (h2 / 27.0) * (7.0 * p.bend - a.bend));
    if (!q.regular) {
        step.error = 1e300;
        return false;
    }
    step.end = a.at + h * a.way + (h2 / 336.0) * (14.0 * a.bend + 100.0 * p.bend + 54.0 * q.bend);
    step.to = look(step.end);
    const FlowSpot& b = step.to;
    if (!b.regular) {
        step.error = 1e300;
        return false;
    }
    const Vec2 off =
        b.way - a.way -
        (h / 336.0) * (14.0 * a.bend + 125.0 * p.bend + 162.0 * q.bend + 35.0 * b.bend);
    step.h = h;
    step.error = 0.3 * h * b.measure(off);
    step.excess = b.excess;
    step.nodes[0] = {0.0, a.excess, h * a.rate};
    step.nodes[1] = {0.2, p.excess, h * p.rate};
    step.nodes[2] = {2.0 / 3.0, q.excess, h * q.rate};
    step.nodes[3] = {1.0, b.excess, h * b.rate};
    step.count = 4;
    return step.error <= tolerance_;
}

/// Closes in on the cone between a share of the step that lies outside of it and one within. False
/// if there is no place within after all; then `spot` is the last one.
bool SurfaceFlow::into_cone(
    const FlowArc& arc, Node low, Node high, SurfaceSpot& spot, double& x) noexcept {
    const Cubic model(low, high);
    double lo = 0.0;  // there the excess is known, at the stages nearly
    double hi = high.excess > 0.0 ? kBeyond : high.x;
    SurfaceSpot best;
    bool found = false;
    double at = high.excess > 0.0 ? high.x - high.excess / high.rate
              : low.excess > 0.0  ? low.x
                                  : high.x;
    if (high.excess <= 0.0 && low.excess > 0.0) {
        double a = low.x;
        double b = high.x;
        for (int i = 0; i < 20 && b - a > 1e-9; ++i) {
            const double newton = at - model.value(at) / model.slope(at);
            at = newton > a && newton < b ? newton : 0.5 * (a + b);
            const double value = model.value(at);
            (value > 0.0 ? a : b) = at;
            if (std::fabs(value) < 1e-15 * low.excess) {
                break;
            }
        }
    }
    double before = 2.0;
    double value_before = 0.0;
    while (!tired()) {
        const Vec2 y = arc.at(at);
        place_.u = std::clamp(y.x, 0.0, 1.0);
        place_.v = std::clamp(y.y, 0.0, 1.0);
        spot = ground_.look(place_);
        x = at;
        if (spot.excess <= 0.0) {
            best = spot;
            found = true;
            if (spot.excess >= -spot.rounding) {
                return true;
            }
        }
        const double value = spot.excess + 0.5 * spot.rounding;
        (value > 0.0 ? lo : hi) = at;
        // The model's slope at first, then the one that was met.
        double slope = model.slope(at);
        if (before < 2.0 && std::fabs(at - before) > 1e-6 && value != value_before) {
            slope = (value - value_before) / (at - before);
        }
        before = at;
        value_before = value;
        const double next = at - value / slope;
        at = next > lo && next < hi ? next : 0.5 * (lo + hi);
        if (at == lo || at == hi || hi - lo < 1e-16) {
            break;
        }
    }
    spot = found ? best : spot;
    return found;
}

SurfaceFlow::Arrival SurfaceFlow::follow(const SurfaceSpot& from, double max) noexcept {
    using End = Arrival::End;
    place_ = from.place;
    const double reach = std::sqrt(from.r2);
    tolerance_ = std::max(kFlowError * reach, from.noise);
    const double least = kLeast * ground_.surface().size();
    FlowSpot a = flow_spot(from.jet, {from.place.u, from.place.v}, ground_.h(), ground_.mu());
    Arrival result{.spot = from};
    double longest = 1e300;
    const auto end_at = [&](const Vec2& at, double way, End end) {
        place_.u = std::clamp(at.x, 0.0, 1.0);
        place_.v = std::clamp(at.y, 0.0, 1.0);
        result.spot = ground_.look(place_);
        result.way = way;
        result.end = end;
        return result;
    };
    double way = 0.0;
    int last_bits = 0;
    while (a.regular) {
        // Where no cone to speak of is left the steps of Newton's kind take over: there all ways
        // lead to the foot.
        const double aside = std::fabs(a.load);
        if ((a.load <= 0.0 && a.length < 1e-2 * aside) ||
            (a.length < 1e-6 * aside && a.excess > 0.999 * a.length)) {
            return end_at(a.at, way, End::foot);
        }
        if (tired()) {
            break;
        }
        const double newton = a.rate < 0.0 ? (a.excess + 0.5 * from.rounding) / -a.rate : 1e300;
        if (a.excess <= 2.0 * from.rounding && ++last_bits > 3) {
            return end_at(a.at, way, End::cone);
        }
        const double bend = a.measure(a.bend);
        double h = std::min({newton, longest, max - way, longest < 1e299 ? 1e300 : 0.2 / bend});
        // What is beside the way falls as |t| does: a step to a small part of it would not be
        // stable.
        h = a.excess > 0.7 * a.length ? std::min(h, 0.7 * a.length) : h;
        h = std::max(h, 4.0 * from.noise);
        Step step;
        const double slow = h * bend;
        bool good = slow * slow * slow * h <= 12.0 * tolerance_ && short_step(a, h, step);
        for (int k = 0; !good && k < 60 && !tired(); ++k) {
            good = long_step(a, h, step);
            if (!good) {
                const double fits = std::sqrt(std::sqrt(tolerance_ / step.error));
                h *= std::clamp(0.9 * fits, 0.1, 0.7);
                if (h < least) {
                    break;
                }
            }
        }
        if (!good) {
            break;
        }
        const double rest = tolerance_ / (step.error + 1e-300);
        const double grow = step.count == 2
                              ? 4.0
                              : std::clamp(0.9 * std::sqrt(std::sqrt(std::sqrt(rest))), 0.3, 4.0);
        longest = grow * h;
        const FlowArc arc(a, step.to, step.end, h);
        // The edge of the patch.
        const double bulge_u = 2.0 * std::fabs(h * h * a.bend.x) + kBorder;
        const double bulge_v = 2.0 * std::fabs(h * h * a.bend.y) + kBorder;
        double border_u = 0.0;
        double border_v = 0.0;
        const double out_u = within(a.at.x, bulge_u) && within(step.end.x, bulge_u)
                               ? 2.0
                               : leaves_at(arc, true, border_u);
        const double out_v = within(a.at.y, bulge_v) && within(step.end.y, bulge_v)
                               ? 2.0
                               : leaves_at(arc, false, border_v);
        const double out = std::min(out_u, out_v);
        // The cone: the first place at which the excess is none.
        SurfaceSpot spot;
        double x = 0.0;
        for (int i = 0; i + 1 < step.count; ++i) {
            Node& low = step.nodes[i];
            Node& high = step.nodes[i + 1];
            if (low.x >= out) {
                break;
            }
            const bool last = i + 2 == step.count;
            Node to = high;
            bool maybe = high.excess <= 0.0;
            if (!maybe && low.rate < 0.0 && high.rate > 0.0) {  // it falls and rises again
                const Cubic model(low, high);
                to.x = model.lowest();
                to.excess = model.value(to.x);
                to.rate = -1e-300;
                maybe = to.excess <= 0.0;
            }
            // A little further on.
            maybe =
                maybe || (last && high.rate < 0.0 && high.excess <= -(kBeyond - 1.0) * high.rate &&
                          out > 1.9 && way + kBeyond * h < max);
            if (!maybe) {
                continue;
            }
            if (into_cone(arc, low, to, spot, x) && x <= out) {
                result.spot = spot;
                result.way = way + x * h;
                result.end = End::cone;
                return result;
            }
        }
        if (out < 1.5) {
            Vec2 at = arc.at(out);
            (out_u <= out_v ? at.x : at.y) = out_u <= out_v ? border_u : border_v;
            return end_at(at, way + out * h, End::edge);
        }
        const FlowSpot end = step.count == 2 ? look(step.end) : step.to;
        if (end.excess < -4.0 * from.rounding && h > 64.0 * least * kLeast) {
            longest = 0.5 * h;  // somewhere on the way, then
            continue;
        }
        way += h;
        a = end;
        if (way >= max * (1.0 - 1e-12)) {
            return end_at(a.at, way, End::spent);
        }
        if (a.excess <= 0.0) {  // by rounding
            return end_at(a.at, way, End::cone);
        }
    }
    return end_at(a.at, way, End::failed);
}

}  // namespace palpate::engine
