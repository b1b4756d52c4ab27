#include "engine/surface/slide_step.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::engine {
namespace {

/// Sine of the angle between tangents, and their length by the size, below which a place is
/// singular.
constexpr double kSingular = 1e-7;

/// Way per step where it ends, m.
double speed(const SurfaceStep& step, const SurfaceSpot& end) noexcept {
    return glm::length(step.du * end.jet.du + step.dv * end.jet.dv);
}

}  // namespace

bool singular(const SurfaceJet& j, double size) noexcept {
    const double e = glm::dot(j.du, j.du);
    const double g = glm::dot(j.dv, j.dv);
    const Vec3 area = glm::cross(j.du, j.dv);
    const double tiny = kSingular * kSingular * size * size;
    return e < tiny || g < tiny || glm::dot(area, area) < kSingular * kSingular * (e * g);
}

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

double first_length(const Footing& at,
                    const SurfaceSteps& steps,
                    double mu,
                    double last,
                    double last_excess) noexcept {
    const SurfaceSpot& s = at.spot;
    const bool into = at.way == Footing::Way::open;
    if (into && steps.bowl() && s.cone <= 0.1 * s.length) {
        return steps.to(s.cone).length;
    }
    const double whole = at.excess + 0.5 * s.rounding;
    const bool slow = at.excess > 0.5 * last_excess;
    const Vec2 way = into                            ? SurfaceGround::parameters(s.jet, s.along)
                   : at.way == Footing::Way::along_u ? Vec2{1.0, 0.0}
                                                     : Vec2{0.0, 1.0};
    const double bend = normal_curvature(s.jet, s.normal, way.x, way.y);
    const double reach = s.load + (s.load > 0.0 ? mu * s.length : 0.0);
    const double rate = std::max(1.0 - bend * reach, into && steps.bowl() ? 1e-3 : 0.25);
    return std::max(whole / rate, slow ? 2.0 * last : 0.0);
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

double edge_way(const SurfaceSpot& a, const SurfaceSpot& b) noexcept {
    const SurfaceStep step{.du = b.place.u - a.place.u, .dv = b.place.v - a.place.v};
    const auto rise = [&step](const SurfaceJet& j) {
        const Vec3 way = step.du * j.du + step.dv * j.dv;
        const double length = glm::length(way);
        const Vec3 bend = step.du * step.du * j.duu + step.dv * step.dv * j.dvv;
        return length > 0.0 ? glm::dot(way, bend) / length : 0.0;
    };
    return 0.5 * (speed(step, a) + speed(step, b)) + (rise(a.jet) - rise(b.jet)) / 12.0;
}

double paid(const Footing& at,
            const SurfaceStep& step,
            const SurfaceSpot& end,
            double rest) noexcept {
    const double beyond = at.way == Footing::Way::open ? 0.0 : edge_way(at.spot, end) - rest;
    return beyond > 1e-9 * rest ? std::max(1.0 - beyond / speed(step, end), 0.25) : 1.0;
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

SurfaceSteps::SurfaceSteps(const SurfaceSpot& s, double size) noexcept {
    const SurfaceJet& j = s.jet;
    const double least = 1e-30 * size * size;
    const double f = glm::dot(j.du, j.dv);
    const double e = glm::dot(j.du, j.du);
    const double g = glm::dot(j.dv, j.dv);
    l11_ = std::sqrt(e + least);
    l21_ = f / l11_;
    l22_ = std::sqrt(std::max(g - l21_ * l21_, 1e-20 * g) + least);
    uu_ = e - glm::dot(s.r, j.duu);
    uv_ = f - glm::dot(s.r, j.duv);
    vv_ = g - glm::dot(s.r, j.dvv);
    const double w11 = uu_ / l11_;
    const double w12 = uv_ / l11_;
    const double w22 = (vv_ - l21_ * w12) / l22_;
    const double a = w11 / l11_;
    const double b = (w12 - l21_ * a) / l22_;
    const double c = (w22 - l21_ * b) / l22_;
    const double skew = 0.5 * (a - c);
    const double spread = std::sqrt(skew * skew + b * b);
    // The smaller of the two by their product, which does not cancel.
    const double mean = 0.5 * (a + c);
    const double product = a * c - b * b;
    high_ = mean > 0.0 ? mean + spread : product / (mean - spread);
    low_ = mean > 0.0 ? product / high_ : mean - spread;
    axis_ = skew > 0.0 ? Vec2{-b, skew + spread} : Vec2{spread - skew, -b};
    const double length = glm::length(axis_);
    axis_ = length > 0.0 ? axis_ / length : Vec2{1.0, 0.0};
    slope_ = Vec2{glm::dot(s.r, j.du), glm::dot(s.r, j.dv)};
    Vec2 t{slope_.x / l11_, 0.0};
    t.y = (slope_.y - l21_ * t.x) / l22_;
    c_low_ = glm::dot(t, axis_);
    c_high_ = glm::dot(t, perp(axis_));
}

Vec2 SurfaceSteps::at(double lambda) const noexcept {
    constexpr double kMin = 1e-290;  // nothing over nothing is nothing
    return Vec2{c_low_ / (low_ + lambda + kMin), c_high_ / (high_ + lambda + kMin)};
}

SurfaceStep SurfaceSteps::to(double rest) const noexcept {
    const double all = std::sqrt(c_low_ * c_low_ + c_high_ * c_high_);
    // What is left, lambda |x|, rises with lambda and bends down: Newton's steps never overshoot.
    double lambda = low_ * rest / (all - rest);
    for (int i = 0; i < 6 && rest > 0.0; ++i) {
        const Vec2 x = at(lambda);
        const double l2 = glm::dot(x, x);
        const double rise =
            x.x * x.x * low_ / (low_ + lambda) + x.y * x.y * high_ / (high_ + lambda);
        const double now = lambda * std::sqrt(l2);
        if (!(now < 0.999 * rest) || !(rise > 0.0)) {
            break;
        }
        lambda += (rest - now) * std::sqrt(l2) / rise;
    }
    return in_parameters(at(lambda), true);
}

SurfaceStep SurfaceSteps::of(double length) const noexcept {
    // 1 / |x| is nearly linear in lambda, and its tangent never overshoots from below.
    double lambda = std::max({std::fabs(c_low_) / length - low_,
                              std::fabs(c_high_) / length - high_, -low_ * (1.0 + 1e-9), 0.0});
    Vec2 x = at(lambda);
    for (int i = 0; i < 4; ++i) {
        const double l2 = glm::dot(x, x);
        const double fall = x.x * x.x / (low_ + lambda) + x.y * x.y / (high_ + lambda);
        const double now = std::sqrt(l2);
        if (!(now > length * 1.001) || !(fall > 0.0)) {
            break;
        }
        lambda += l2 / fall * (now - length) / length;
        x = at(lambda);
    }
    const double now = glm::length(x);
    if (low_ <= 0.0 && now < 0.5 * length) {  // down from a ridge, to either side
        x.x = c_low_ < 0.0 ? -length : length;
    } else if (now > length || low_ <= 0.0) {
        x = now > 0.0 && now < 1e300 ? (length / now) * x : Vec2{};
    }
    return in_parameters(x, lambda == 0.0);
}

SurfaceStep SurfaceSteps::in_parameters(const Vec2& x, bool newton) const noexcept {
    SurfaceStep step{.length = glm::length(x), .newton = newton};
    const Vec2 y = x.x * axis_ + x.y * perp(axis_);
    step.dv = y.y / l22_;
    step.du = (y.x - l21_ * step.dv) / l11_;
    return step;
}

SurfaceStep SurfaceSteps::straight(double length) const noexcept {
    const Vec2 t{c_low_, c_high_};
    const double bend = low_ * t.x * t.x + high_ * t.y * t.y;
    const double t2 = glm::dot(t, t);
    const double longest = length / std::sqrt(t2);
    return in_parameters((bend * longest > t2 ? t2 / bend : longest) * t, bend * longest > t2);
}

SurfaceStep SurfaceSteps::along(bool in_u, double length) const noexcept {
    const double speed = in_u ? l11_ : std::sqrt(l21_ * l21_ + l22_ * l22_);
    const double slope = in_u ? slope_.x : slope_.y;
    const double bend = in_u ? uu_ : vv_;
    const double longest = length / speed;
    const bool newton = bend > 0.0 && std::fabs(slope) <= bend * longest;
    const double by = newton ? slope / bend : slope < 0.0 ? -longest : longest;
    return {in_u ? by : 0.0, in_u ? 0.0 : by, std::fabs(by) * speed, newton};
}

}  // namespace palpate::engine
