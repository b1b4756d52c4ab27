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

}  // namespace palpate::tests
