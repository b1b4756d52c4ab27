#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/friction/cone_slide.hpp"

namespace palpate::engine {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kUnclear = std::numeric_limits<double>::quiet_NaN();

/// Goes to the first place where the drive in direction task.dir is no more than mu times the load,
/// as if any load were positive. @return load there; infinity: at the end of the arc, still driven
/// on; NaN: unclear, and nothing moved
template <bool HasFriction>
double go_to(const Arc& arc, const SlideTask& task, double mu, Spot& spot) noexcept {
    const double start = spot.u - spot.rest;
    const Vec2 gap = task.h - spot.jet.point;
    const double way =
        way_to_root(arc, arc.excess(task.h, mu, task.dir), start, task.dir, glm::dot(gap, gap));
    if (std::isnan(way)) {
        return kUnclear;
    }
    double d = start + task.dir * way;
    double nudge = kEpsilon;
    for (int i = 0; i < falling::kMaxNudges && task.dir * d < 1.0; ++i) {
        spot = spot_at(arc, 0.5 + 0.5 * d, 0.5 - 0.5 * d);
        const Drive drive = drive_at(arc, spot.jet, task.h);
        if (drive.template direction<HasFriction>(mu) != task.dir) {
            return drive.load;
        }
        d += task.dir * nudge;
        nudge *= 4.0;
    }
    if (task.dir * d < 1.0) {
        return 0.0;
    }
    spot = task.dir > 0.0 ? spot_at(arc, 1.0, 0.0) : spot_at(arc, 0.0, 1.0);
    const Drive drive = drive_at(arc, spot.jet, task.h);
    return task.dir * drive.tangential > 0.0 ? kNever : drive.load;
}

/// Takes the way of a slide from the budget. @return false if the budget ends on it: the spot is
/// there then
bool pays(const Arc& arc, const SlideTask& task, const Spot& before, Spot& spot, double& used) {
    constexpr int kHalvings = 40;
    const auto way_to = [&](const Spot& to) {
        return arc.way(before.jet.point, to.jet.point);
    };
    const double left = std::max(task.budget - used, 0.0);
    const double way = way_to(spot);
    if (way <= left) {
        used += way;
        return true;
    }
    Spot near = before;
    Spot far = spot;
    for (int i = 0; i < kHalvings; ++i) {
        const Spot middle = spot_at(arc, 0.5 * (near.u + far.u), 0.5 * (near.rest + far.rest));
        (way_to(middle) <= left ? near : far) = middle;
    }
    spot = near;
    used = task.budget;
    return false;
}

}  // namespace

template <bool HasFriction>
SlideEnd slide_on_arc(const Arc& arc, const SlideTask& task, Spot& spot, double& used) noexcept {
    const bool limited = task.budget < kNever;
    Spot before;
    if (limited) {
        before = spot;
    }
    const double u = spot.u;
    const double rest = spot.rest;
    double load = go_to<HasFriction>(arc, task, HasFriction ? task.mu : 0.0, spot);
    if (HasFriction && load < 0.0) {  // without a load the drive alone decides: it ended before
        spot.u = u;
        spot.rest = rest;
        load = go_to<false>(arc, task, 0.0, spot);
    }
    if (std::isnan(load)) {
        spot.u = u;
        spot.rest = rest;
        return SlideEnd::unclear;
    }
    const SlideEnd end = load < kNever ? SlideEnd::in_cone : SlideEnd::at_end;
    if (limited && end == SlideEnd::in_cone &&
        surely_pays(spot.jet.point - before.jet.point, std::max(task.budget - used, 0.0))) {
        return end;  // the walk ends here: nobody asks how much is left
    }
    return limited && !pays(arc, task, before, spot, used) ? SlideEnd::out_of_budget : end;
}

template SlideEnd slide_on_arc<true>(const Arc&, const SlideTask&, Spot&, double&) noexcept;
template SlideEnd slide_on_arc<false>(const Arc&, const SlideTask&, Spot&, double&) noexcept;

}  // namespace palpate::engine
