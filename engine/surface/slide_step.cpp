#include "engine/surface/slide_step.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::engine {
namespace {

bool leaves(double at, double by) noexcept {
    return (at == 0.0 && by < 0.0) || (at == 1.0 && by > 0.0);
}

}  // namespace

SurfaceStep step_of(const Footing& at, const SurfaceSteps& steps, double length) noexcept {
    if (at.way != Footing::Way::open) {
        return steps.along(at.way == Footing::Way::along_u, length);
    }
    const SurfacePlace& p = at.spot.place;
    SurfaceStep step = steps.of(length);
    if (steps.ridge() && (leaves(p.u, step.du) || leaves(p.v, step.dv))) {
        step = {-step.du, -step.dv, step.length, false};
    }
    const bool out_u = leaves(p.u, step.du);
    const bool out_v = leaves(p.v, step.dv);
    if (!out_u && !out_v) {
        return step;
    }
    // The lowest place lies beyond an edge: on it, or straight away from it.
    const SurfaceStep edge = steps.along(out_v, length);
    const SurfaceStep straight = steps.straight(length);
    const bool on = !leaves(p.u, edge.du) && !leaves(p.v, edge.dv) && !(out_u && out_v);
    return on && steps.fall(edge) > steps.fall(straight) ? edge : straight;
}

SurfaceStep cut(const SurfaceSpot& s, SurfaceStep step) noexcept {
    step.du = leaves(s.place.u, step.du) ? 0.0 : step.du;  // by rounding
    step.dv = leaves(s.place.v, step.dv) ? 0.0 : step.dv;
    const auto share = [](double at, double by) {
        const double room = by > 0.0 ? 1.0 - at : at;
        return std::fabs(by) > room ? room / std::fabs(by) : 1.0;
    };
    const double part = std::min(share(s.place.u, step.du), share(s.place.v, step.dv));
    return {part * step.du, part * step.dv, part * step.length, step.newton && part == 1.0};
}

bool still(const SurfaceStep& step) noexcept {
    return std::fabs(step.du) < 0.25 * kEpsilon && std::fabs(step.dv) < 0.25 * kEpsilon;
}

double ahead(const SurfaceStep& step, const SurfaceSpot& s) noexcept {
    const Vec3 way = step.du * s.jet.du + step.dv * s.jet.dv;
    const double length = glm::length(way);
    return length > 0.0 ? glm::dot(s.r, way) / length : 0.0;
}

double measure(const Footing& at, const SurfaceStep& step, const SurfaceSpot& s) noexcept {
    return at.way == Footing::Way::open ? s.excess : ahead(step, s) - s.cone;
}

double left(const Footing& at, const SurfaceStep& step, const SurfaceSpot& s) noexcept {
    return at.way == Footing::Way::open ? s.excess : std::fabs(ahead(step, s)) - s.cone;
}

}  // namespace palpate::engine
