#include "engine/surface/surface_step.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::engine {

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
    constexpr double kLeast = 1e-290;  // nothing over nothing is nothing
    return Vec2{c_low_ / (low_ + lambda + kLeast), c_high_ / (high_ + lambda + kLeast)};
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
