#include "stimuli/two_curve.hpp"

#include <algorithm>
#include <cmath>

#include "engine/geometry/arc.hpp"

namespace palpate::stimuli {
namespace {

using engine::RationalBezier;
using engine::Vec2;

/// Points along `curve` without its end. A chord of length c on curvature k is off by k c^2 / 8.
void append_polyline(std::vector<Vec2>& points,
                     const RationalBezier<2>& curve,
                     double curvature,
                     double tolerance) {
    const double chord = glm::length(curve.at(1.0).point - curve.at(0.0).point);
    const double longest = std::sqrt(8.0 * tolerance / std::max(std::fabs(curvature), 1e-12));
    // The arc is longer than its chord and u is not arc length: twice as many pieces are safe for
    // every arc that one span can hold.
    const int pieces = std::clamp(static_cast<int>(std::ceil(2.0 * chord / longest)), 1, 4096);
    for (int i = 0; i < pieces; ++i) {
        points.push_back(curve.at(static_cast<double>(i) / pieces).point);
    }
}

}  // namespace

std::shared_ptr<const engine::Outline> make_outline(const TwoCurve& object) {
    std::vector<RationalBezier<2>> segments{
        engine::make_arc(object.a, object.vertex, object.curvature),
        engine::make_arc(object.vertex, object.b, object.curvature),
        engine::make_line(object.b, object.a),
    };
    return std::make_shared<const engine::Outline>(std::move(segments), true);
}

std::vector<Vec2> silhouette(const TwoCurve& object, double tolerance) {
    const auto outline = make_outline(object);
    std::vector<Vec2> points;
    append_polyline(points, outline->spans()[0], object.curvature, tolerance);
    append_polyline(points, outline->spans()[1], object.curvature, tolerance);
    points.push_back(object.b);
    return points;
}

}  // namespace palpate::stimuli
