#include "data/report/objects.hpp"

#include <cmath>
#include <numbers>

namespace palpate::data {

using engine::Vec2;

Polygons narrow_arch() {
    return {{{-0.05, 0.0}, {0.02, 0.06}, {-0.02, 0.06}, {0.05, 0.0}}};
}

Polygons three_curves() {
    const Vec2 left{-0.042, -0.026};
    const Vec2 top{-0.004, 0.044};
    const Vec2 right{0.044, -0.020};
    return {{left, {-0.050, 0.006}, {-0.030, 0.036}, top},
            {top, {0.024, 0.038}, {0.046, 0.012}, right},
            {right, {0.022, -0.040}, {-0.018, -0.042}, left}};
}

Polygons two_curves() {
    constexpr double kHalfTurn = 11.0 * std::numbers::pi / 180.0;
    const double fall = 0.02 * std::tan(kHalfTurn);
    const Vec2 top{0.0, 0.032};
    return {{{-0.05, 0.0}, {-0.042, 0.012}, {-0.02, top.y - fall}, top},
            {top, {0.02, top.y - fall}, {0.042, 0.012}, {0.05, 0.0}}};
}

std::vector<engine::NurbsCurve<2>> curves_of(const Polygons& polygons) {
    std::vector<engine::NurbsCurve<2>> curves;
    for (const std::vector<Vec2>& polygon : polygons) {
        const std::vector<double> knots{0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0};
        curves.emplace_back(3, knots, polygon);
    }
    return curves;
}

}  // namespace palpate::data
