#pragma once

#include <cmath>

#include "engine/geometry/vec.hpp"

/// Circular arcs by trigonometry, independent of the rational curves of the engine.
namespace palpate::tests {

using engine::Vec2;

/// An arc or line from `from` to `to`; curvature > 0 bulges to the left of travel.
struct ArcOracle {
    Vec2 from{};
    Vec2 to{};
    double curvature = 0.0;

    [[nodiscard]] double radius() const { return 1.0 / std::fabs(curvature); }
    [[nodiscard]] Vec2 middle() const { return 0.5 * (from + to); }
    [[nodiscard]] Vec2 left() const { return engine::perp(to - from) / glm::length(to - from); }
    [[nodiscard]] Vec2 centre() const {
        const double half = 0.5 * glm::length(to - from);
        const double offset = std::sqrt(radius() * radius() - half * half);
        return middle() + (curvature > 0.0 ? -offset : offset) * left();
    }

    struct Foot {
        Vec2 point{};
        Vec2 normal{};  ///< outward, object on the right of travel
        double distance = 0.0;
        bool at_end = false;
    };

    [[nodiscard]] Foot closest(const Vec2& h) const {
        Foot foot;
        if (curvature == 0.0) {
            const Vec2 along = to - from;
            const double s = glm::dot(h - from, along) / glm::dot(along, along);
            foot.at_end = s <= 0.0 || s >= 1.0;
            foot.point = s <= 0.0 ? from : s >= 1.0 ? to : from + s * along;
            foot.normal = left();
        } else {
            const Vec2 c = centre();
            const Vec2 ray = h - c;
            const double half_angle =
                std::asin(std::fabs(curvature) * 0.5 * glm::length(to - from));
            const Vec2 axis = curvature > 0.0 ? left() : -left();
            const double angle = std::atan2(engine::cross(axis, ray), glm::dot(axis, ray));
            if (std::fabs(angle) <= half_angle) {
                foot.point = c + radius() * ray / glm::length(ray);
            } else {
                foot.at_end = true;
                foot.point = glm::length(h - from) < glm::length(h - to) ? from : to;
            }
            const Vec2 out = (foot.point - c) / radius();
            foot.normal = curvature > 0.0 ? out : -out;
        }
        foot.distance = glm::length(h - foot.point);
        return foot;
    }
};

/// The friction law on one arc or line, by plane trigonometry instead of iteration: where the cone
/// is left, the law of sines in the triangle (centre, HIP, GO) says where the god-object comes to
/// rest. Independent of the engine in geometry and method. Valid away from the ends of the curve.
class GosOracle {
public:
    struct Law {
        double stiffness = 1000.0;
        double mu_s = 0.0;
        double mu_d = 0.0;
        double tau_slip = 0.0;
        double tau_heal = 0.0;
        double period = 1e-3;
    };

    GosOracle(const ArcOracle& side, const Law& law) : side_(side), law_(law) {}

    /// Force on the user after HIP moved to `h`, N.
    Vec2 tick(const Vec2& h) {
        const ArcOracle::Foot foot = side_.closest(h);
        const double depth = -glm::dot(h - foot.point, foot.normal);
        if (!touching_) {
            theta_ = 1.0;
            if (depth <= 0.0) {
                return Vec2{};
            }
            touching_ = true;
            go_ = foot.point;
        }
        const double mu = law_.mu_d + (law_.mu_s - law_.mu_d) * theta_;
        if (depth <= 0.0) {  // the cone shrinks to nothing where the load does
            touching_ = false;
            return Vec2{};
        }
        const bool slipped =
            side_.curvature == 0.0 ? settle_on_line(h, depth, mu) : settle_on_circle(h, mu);
        const auto survive = [this](double tau) {
            return tau > 0.0 ? std::exp(-law_.period / tau) : 0.0;
        };
        theta_ = slipped ? theta_ * survive(law_.tau_slip)
                         : 1.0 + (theta_ - 1.0) * survive(law_.tau_heal);
        return law_.stiffness * (go_ - h);
    }

    [[nodiscard]] Vec2 go() const { return go_; }

private:
    bool settle_on_line(const Vec2& h, double depth, double mu) {
        const Vec2 along = (side_.to - side_.from) / glm::length(side_.to - side_.from);
        const double tau = glm::dot(h - go_, along);
        if (std::fabs(tau) <= mu * depth) {
            return false;
        }
        go_ += along * (tau - std::copysign(mu * depth, tau));
        return true;
    }

    bool settle_on_circle(const Vec2& h, double mu) {
        const Vec2 c = side_.centre();
        const double radius = side_.radius();
        const double d = glm::length(h - c);
        const double lag = std::atan2(engine::cross(h - c, go_ - c), glm::dot(h - c, go_ - c));
        const double sign = side_.curvature > 0.0 ? 1.0 : -1.0;
        const double load = sign * (radius - d * std::cos(lag));
        if (std::fabs(d * std::sin(lag)) <= mu * load) {
            return false;
        }
        const double phi = std::atan(mu);
        const double at_centre = sign * (std::asin(radius * std::sin(phi) / d) - phi);
        const double angle = std::atan2(h.y - c.y, h.x - c.x) + std::copysign(at_centre, lag);
        go_ = c + radius * Vec2{std::cos(angle), std::sin(angle)};
        return true;
    }

    ArcOracle side_;
    Law law_;
    bool touching_ = false;
    double theta_ = 1.0;
    Vec2 go_{};
};

}  // namespace palpate::tests
