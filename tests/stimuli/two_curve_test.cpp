#include "stimuli/two_curve.hpp"
#include "tests/support/arc_oracle.hpp"
#include "tests/support/catch.hpp"

using engine::Vec2;

namespace {

double off_the_outline(const stimuli::TwoCurve& object, const Vec2& p) {
    return std::min({ArcOracle{object.a, object.vertex, object.curvature}.closest(p).distance,
                     ArcOracle{object.vertex, object.b, object.curvature}.closest(p).distance,
                     ArcOracle{object.b, object.a, 0.0}.closest(p).distance});
}

}  // namespace

TEST_CASE("curvature bulges by the sagitta of its circle, outwards when positive",
          "[stimuli][law]") {
    EACH(kappa, -20.0, -10.0, -5.0, 5.0, 10.0, 20.0);
    const auto outline = stimuli::make_outline({.curvature = kappa});
    const double radius = 1.0 / std::fabs(kappa);
    const double half = 0.5 * std::hypot(0.040, 0.040);
    const double sagitta =
        radius - std::sqrt(radius * radius - half * half);  // 2 mm at 5, 4 mm at 10
    const Vec2 middle = outline->spans()[0].at(0.5).point;
    const Vec2 outward = Vec2{-1.0, 1.0} / std::sqrt(2.0);
    CHECK(std::fabs(glm::dot(middle - Vec2{-0.020, 0.020}, outward) -
                    std::copysign(sagitta, kappa)) < 1e-16);
}

TEST_CASE("the picture's polyline stays within its tolerance of the felt outline",
          "[stimuli][law]") {
    EACH(kappa, -20.0, -10.0, -5.0, 0.0, 5.0, 10.0, 20.0);
    EACH(tolerance, 200e-6, 20e-6, 2e-6);
    const stimuli::TwoCurve object{.curvature = kappa};
    const std::vector<Vec2> points = stimuli::silhouette(object, tolerance);
    double worst = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec2& from = points[i];
        const Vec2& to = points[(i + 1) % points.size()];
        for (int k = 0; k < 16; ++k) {
            worst = std::max(worst, off_the_outline(object, from + (to - from) * (k / 16.0)));
        }
    }
    CHECK(worst <= tolerance);
    CHECK(points.front() == object.a);
    CHECK(std::find(points.begin(), points.end(), object.vertex) != points.end());
    CHECK(points.back() == object.b);
}

TEST_CASE("the two sides mirror one another", "[stimuli][law]") {
    const double kappa = GENERATE(-10.0, 0.0, 10.0);
    const auto outline = stimuli::make_outline({.curvature = kappa});
    for (int i = 0; i <= 32; ++i) {
        const Vec2 left = outline->spans()[0].at(i / 32.0).point;
        const Vec2 right = outline->spans()[1].at(1.0 - i / 32.0).point;
        CHECK(glm::length(left - Vec2{-right.x, right.y}) < 1e-16);
    }
}
