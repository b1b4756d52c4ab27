#pragma once

#include "engine/surface/nurbs_surface.hpp"
#include "tests/figures/drawing.hpp"

namespace palpate::figures {

/// What an eye far away sees of a place in space, m: right and up in the view.
struct Eye {
    double turn = 0.0;  ///< round z, degrees
    double rise = 0.0;  ///< above the plane, degrees

    engine::Vec2 operator()(const engine::Vec3& p) const {
        const double t = turn * std::numbers::pi / 180.0;
        const double r = rise * std::numbers::pi / 180.0;
        const engine::Vec3 right{-std::sin(t), std::cos(t), 0.0};
        const engine::Vec3 up{-std::cos(t) * std::sin(r), -std::sin(t) * std::sin(r), std::cos(r)};
        return {glm::dot(p, right), glm::dot(p, up)};
    }
};

/// So many lines of constant u and as many of constant v, each of so many pieces.
inline Series surface_net(std::string name,
                          const engine::NurbsSurface& surface,
                          const Eye& eye,
                          int lines,
                          int pieces,
                          Ink ink) {
    const auto at = [](const engine::KnotVector& knots, int i, int of) {
        return knots.front() + static_cast<double>(i) / of * (knots.back() - knots.front());
    };
    std::vector<engine::Vec2> points;
    for (const bool along_u : {false, true}) {
        for (int i = 0; i < lines; ++i) {
            for (int k = 0; k <= pieces; ++k) {
                const double u = along_u ? at(surface.knots_u(), k, pieces)
                                         : at(surface.knots_u(), i, lines - 1);
                const double v = along_u ? at(surface.knots_v(), i, lines - 1)
                                         : at(surface.knots_v(), k, pieces);
                points.push_back(eye(surface.at(u, v).point));
            }
            points.push_back(gap());
        }
    }
    return path_mm(std::move(name), points, {ink, 0.7});
}

/// Panel of such a view.
inline Panel surface_panel(std::string title, double height) {
    return plane_mm(std::move(title), height, "right in the view", "up in the view");
}

}  // namespace palpate::figures
