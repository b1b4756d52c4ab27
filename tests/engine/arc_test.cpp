#include "engine/geometry/outline.hpp"
#include "tests/support/arc_oracle.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

TEST_CASE("every point of a rational quadratic arc lies on its circle, with the circle's curvature",
          "[geometry]") {
    SEEDED(random, std::uint64_t{500});
    const Vec2 from = random.point(-0.1, 0.1);
    const Vec2 to = random.point(-0.1, 0.1);
    const double chord = glm::length(to - from);
    const double curvature = random.in(-1.9, 1.9) / chord;
    if (std::fabs(curvature) * chord < 1e-3) {
        return;
    }
    const RationalBezier<2> arc = make_arc(from, to, curvature);
    const ArcOracle oracle{from, to, curvature};
    const Vec2 centre = oracle.centre();
    double off = 0.0;
    double bend = 0.0;
    for (int i = 0; i <= 64; ++i) {
        const Frame frame = frame_at(arc, i / 64.0);
        off = std::max(off, std::fabs(glm::length(frame.point - centre) - oracle.radius()));
        bend = std::max(bend, std::fabs(frame.curvature / curvature - 1.0));
    }
    CHECK(off <= 1e-15 * (1.0 + oracle.radius() / chord));
    CHECK(bend <= 1e-11);
}

TEST_CASE("what is not a curve is refused with the value and the remedy", "[geometry]") {
    const Vec2 a{0.0, 0.0};
    const Vec2 b{0.1, 0.0};
    CHECK_THROWS_WITH(make_line(a, a), Has("apart"));
    CHECK_THROWS_WITH(make_arc(a, b, 20.0), Has("curvature 20 1/m", "below 19.8"));
    CHECK_THROWS_WITH(make_arc(a, b, std::numeric_limits<double>::quiet_NaN()), Has("nan"));
    const std::vector<Vec2> points{a, b};
    CHECK_THROWS_WITH(RationalBezier<2>(points, std::vector{1.0, 0.0}), Has("weight 1", "above 0"));
    CHECK_THROWS_WITH(RationalBezier<2>(points, std::vector{1.0}), Has("one weight"));
    CHECK_THROWS_WITH(RationalBezier<2>(std::vector{a}, std::vector{1.0}), Has("2 to 10"));
    CHECK_THROWS_WITH(
        RationalBezier<2>(std::vector{a, Vec2{1.0 / 0.0, 0.0}}, std::vector{1.0, 1.0}),
        Has("control point 1 has the coordinate inf"));
}
