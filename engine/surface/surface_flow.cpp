#include "engine/surface/surface_flow.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/processor.hpp"

namespace palpate::engine {
namespace {

/// Of a step, as a share of the stretch or of the size.
constexpr double kFlowError = 2e-11;
constexpr double kBudgetError = 1e-8;  ///< without friction, where a budget alone ends the flow
/// A flow that asks for steps that are shorter than this, of the size, has no direction to speak
/// of.
constexpr double kMin = 1e-8;
constexpr double kEndless = 1e300;  ///< m
constexpr Work kStageWork = 150;    ///< besides the evaluation
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

bool on_patch(const Vec2& at) noexcept {
    return within(at.x, -kBorder) && within(at.y, -kBorder);
}

}  // namespace

void SurfaceFlow::look(const Vec2& at, FlowSpot& spot) noexcept {
    place_.u = at.x;
    place_.v = at.y;
    flow_spot(ground_.jet(place_, kStageWork), at, ground_.h(), ground_.mu(), spot);
}

bool SurfaceFlow::short_step(const FlowSpot& a, double h, Step& step) noexcept {
    const Vec2 to = a.at + h * (a.way + (0.5 * h) * a.bend);
    look(to, step.to);
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
    const auto regular = [this](const Vec2& at, FlowSpot& spot) {
        look(at, spot);
        return spot.regular;
    };
    FlowSpot p;
    FlowSpot q;
    step.error = 1e300;
    if (!regular(a.at + (0.2 * h) * a.way + (0.02 * h2) * a.bend, p) ||
        !regular(a.at + (2.0 / 3.0 * h) * a.way + (h2 / 27.0) * (7.0 * p.bend - a.bend), q)) {
        return false;
    }
    step.end = a.at + h * a.way + (h2 / 336.0) * (14.0 * a.bend + 100.0 * p.bend + 54.0 * q.bend);
    if (!regular(step.end, step.to)) {
        return false;
    }
    const FlowSpot& b = step.to;
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
        ground_.look(place_, spot);
        x = at;
        if (spot.excess <= 0.0) {
            if (spot.excess >= -spot.rounding) {
                return true;
            }
            best = spot;
            found = true;
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
    if (found) {
        spot = best;
    }
    return found;
}

void SurfaceFlow::end_at(const Vec2& at, double way, Arrival::End end, Arrival& to) noexcept {
    place_.u = std::clamp(at.x, 0.0, 1.0);
    place_.v = std::clamp(at.y, 0.0, 1.0);
    ground_.look(place_, to.spot);
    to.way = way;
    to.end = end;
}

/// Where no cone to speak of is left the steps of Newton's kind take over: there all ways lead to
/// the foot.
bool SurfaceFlow::near_foot() const noexcept {
    const double aside = std::fabs(at_.load);
    return at_.length < 1e-6 * aside && at_.excess > 0.999 * at_.length;
}

/// The length of the next step to try, m: to the cone, if the bend allows.
double SurfaceFlow::wanted() const noexcept {
    const double newton = at_.rate < 0.0 ? (at_.excess + 0.5 * rounding_) / -at_.rate : kEndless;
    const double first = longest_ < kEndless ? kEndless : 0.2 / at_.measure(at_.bend);
    const double h = std::min({newton, longest_, max_ - way_, first});
    // What is beside the way falls as |t| does: a step to a small part of it would not be stable.
    return std::max(at_.excess > 0.7 * at_.length ? std::min(h, 0.7 * at_.length) : h,
                    4.0 * noise_);
}

/// A step of length h, or a shorter one whose error is small enough. False if there is none.
bool SurfaceFlow::take(double h, Step& step) noexcept {
    const double slow = h * at_.measure(at_.bend);
    bool good = slow * slow * slow * h <= 12.0 * tolerance_ && short_step(at_, h, step);
    for (int k = 0; !good && k < 60 && !tired(); ++k) {
        good = long_step(at_, h, step);
        if (!good) {
            const double fits = std::sqrt(std::sqrt(tolerance_ / step.error));
            h *= std::clamp(0.9 * fits, 0.1, 0.7);
            if (h < least_) {
                return false;
            }
        }
    }
    return good;
}

/// How long the next step may be.
double SurfaceFlow::longest_after(const Step& step) const noexcept {
    const double rest = tolerance_ / (step.error + 1e-300);
    return step.h * (step.count == 2
                         ? 4.0
                         : std::clamp(0.9 * std::sqrt(std::sqrt(std::sqrt(rest))), 0.3, 4.0));
}

/// Where a step leaves its patch first.
SurfaceFlow::Exit SurfaceFlow::exit_of(const FlowArc& arc, const Step& step) const noexcept {
    const double bulge_u = 2.0 * std::fabs(step.h * step.h * at_.bend.x) + kBorder;
    const double bulge_v = 2.0 * std::fabs(step.h * step.h * at_.bend.y) + kBorder;
    Exit u{.in_u = true};
    Exit v{.in_u = false};
    if (!within(at_.at.x, bulge_u) || !within(step.end.x, bulge_u)) {
        u.x = leaves_at(arc, true, u.border);
    }
    if (!within(at_.at.y, bulge_v) || !within(step.end.y, bulge_v)) {
        v.x = leaves_at(arc, false, v.border);
    }
    return u.x <= v.x ? u : v;
}

/// The first place on a step, before share `out` of it, at which the excess is none.
bool SurfaceFlow::meets_cone(
    const FlowArc& arc, const Step& step, double out, SurfaceSpot& spot, double& x) noexcept {
    for (int i = 0; i + 1 < step.count; ++i) {
        const Node& low = step.nodes[i];
        const Node& high = step.nodes[i + 1];
        if (low.x >= out) {
            break;
        }
        Node to = high;
        bool maybe = high.excess <= 0.0;
        if (!maybe && low.rate < 0.0 && high.rate > 0.0) {  // it falls and rises again
            const Cubic model(low, high);
            to.x = model.lowest();
            to.excess = model.value(to.x);
            to.rate = -1e-300;
            maybe = to.excess <= 0.0;
        }
        // A little further on, where no edge comes first.
        const bool last = i + 2 == step.count;
        maybe = maybe || (last && high.rate < 0.0 && high.excess <= -(kBeyond - 1.0) * high.rate &&
                          out > 1.9 && way_ + kBeyond * step.h < max_);
        if (maybe && into_cone(arc, low, to, spot, x) && x <= out && on_patch(arc.at(x))) {
            return true;
        }
    }
    return false;
}

SurfaceFlow::Arrival SurfaceFlow::follow(const SurfaceSpot& from, double max) noexcept {
    const double size = ground_.surface().size();
    place_ = from.place;
    const double error = ground_.mu() > 0.0 ? kFlowError : kBudgetError;
    tolerance_ = std::max(error * std::min(std::sqrt(from.r2), size), from.noise);
    least_ = kMin * size;
    noise_ = from.noise;
    rounding_ = from.rounding;
    max_ = max;
    return as_this_processor_can([&] {
        flow_spot(from.jet, {from.place.u, from.place.v}, ground_.h(), ground_.mu(), at_);
        return walk();
    });
}

/// From at_ on.
SurfaceFlow::Arrival SurfaceFlow::walk() noexcept {
    using End = Arrival::End;
    int last_bits = 0;
    Step step;
    Arrival to;
    End end = End::failed;
    while (at_.regular) {
        if (near_foot()) {
            end = End::foot;
            break;
        }
        if (tired()) {
            break;
        }
        if (at_.excess <= 2.0 * rounding_ && ++last_bits > 3) {
            end = End::cone;
            break;
        }
        if (!take(wanted(), step)) {
            break;
        }
        const FlowArc arc(at_, step.to, step.end, step.h);
        const Exit out = exit_of(arc, step);
        double x = 0.0;
        if (meets_cone(arc, step, out.x, to.spot, x)) {
            to.way = way_ + x * step.h;
            to.end = End::cone;
            return to;
        }
        if (out.x < 1.5) {
            Vec2 edge = arc.at(out.x);
            (out.in_u ? edge.x : edge.y) = out.border;
            end_at(edge, way_ + out.x * step.h, End::edge, to);
            return to;
        }
        if (step.count == 2) {
            look(step.end, step.to);
        }
        if (step.to.excess < -4.0 * rounding_ && step.h > 64.0 * least_ * kMin) {
            longest_ = 0.5 * step.h;  // somewhere on the way, then
            continue;
        }
        longest_ = longest_after(step);
        way_ += step.h;
        at_ = step.to;
        if (way_ >= max_ * (1.0 - 1e-12)) {
            end = End::spent;
            break;
        }
        if (at_.excess <= 0.0) {  // by rounding
            end = End::cone;
            break;
        }
    }
    end_at(at_.at, way_, end, to);
    return to;
}

}  // namespace palpate::engine
