#include "engine/geometry/outline.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/frame.hpp"
#include "tests/support/nurbs_oracle.hpp"

using namespace palpate::engine;

namespace {

template <int D>
NurbsCurve<D> make(const NurbsData<D>& data) {
    return NurbsCurve<D>(data.degree, data.knots, data.points, data.weights);
}

/// Largest distance from the definition over the whole curve, relative to `size`.
template <int D>
double worst_error(const NurbsData<D>& data, double size) {
    const NurbsCurve<D> curve = make(data);
    long double worst = 0.0L;
    for (const auto& span : curve.spans()) {
        for (int i = 0; i <= 8; ++i) {
            const double u = span.lo + (span.hi - span.lo) * i / 8.0;
            const auto exact = nurbs_point(data, u);
            const Vec<D> got = curve.at(u).point;
            for (int k = 0; k < D; ++k) {
                worst =
                    std::max(worst, std::fabs(got[k] - exact[static_cast<std::size_t>(k)]) / size);
            }
        }
    }
    return static_cast<double>(worst);
}

}  // namespace

TEST_CASE("a NURBS curve of any degree, spacing and weights is what its definition says") {
    SEEDED(random, 150U);
    const double size = random.decade(-6.0, 3.0);
    const double decades = seed % 3U == 0U ? 0.0 : 3.0;
    // Curve points of rational spans are quotients of sums of positive terms: 2 p + a few
    // roundings.
    CHECK(1e15 * worst_error(random_nurbs<2>(random, size, decades), size) < 4.0);
    CHECK(1e15 * worst_error(random_nurbs<3>(random, size, decades), size) < 4.0);
}

TEST_CASE("derivatives are those of the definition") {
    SEED(60U);
    Random random(1000U + seed);
    const NurbsData<2> data = random_nurbs<2>(random, 0.1, 0.5);
    const NurbsCurve<2> curve = make(data);
    for (const auto& span : curve.spans()) {
        const double width = span.hi - span.lo;
        const double u = span.lo + width * random.in(0.2, 0.8);
        const long double e = 1e-4L * static_cast<long double>(width);
        const auto before = nurbs_point(data, u - e);
        const auto middle = nurbs_point(data, static_cast<long double>(u));
        const auto after = nurbs_point(data, u + e);
        const Jet<2> jet = curve.at(u);
        for (int k = 0; k < 2; ++k) {
            const auto i = static_cast<std::size_t>(k);
            const double first = static_cast<double>((after[i] - before[i]) / (2.0L * e));
            const double second =
                static_cast<double>((after[i] - 2.0L * middle[i] + before[i]) / (e * e));
            // Central differences: error e^2 of the third and fourth derivative, far below 1e-4
            // here.
            CHECK(jet.first[k] * width == Approx(first * width).margin(2e-6));
            CHECK(jet.second[k] * width * width == Approx(second * width * width).margin(2e-4));
        }
    }
}

TEST_CASE(
    "a jet carried a step on is the curve's own: for polynomials up to degree 3 wherever the step "
    "leads") {
    Random random(GENERATE(range(0U, 150U)));
    const double size = random.decade(-3.0, 0.0);
    const int degree = 1 + random.below(5);
    std::vector<Vec2> points;
    std::vector<double> weights;
    const bool polynomial = random.below(3) != 0;
    for (int i = 0; i <= degree; ++i) {
        points.push_back(random.point(-size, size));
        weights.push_back(polynomial ? 1.0 : random.in(0.5, 2.0));
    }
    const RationalBezier<2> curve(points, weights);
    REQUIRE(curve.is_its_taylor_series() == (polynomial && degree <= 3));
    const double u = random.in(0.0, 1.0);
    const double far = curve.is_its_taylor_series() ? random.in(-1.0, 1.0) : 1e-5;
    const Jet<2> there = curve.at(u + far);
    const Jet<2> carried = curve.beside(curve.at(u), far);
    // Elsewhere the point errs by a sixth of the third derivative times far^3, C' by a half of it
    // times far^2.
    const double third = curve.is_its_taylor_series() ? 0.0 : 3000.0 * size;
    const double rounding = 5e-14 * size;
    CHECK(glm::length(carried.point - there.point) <= rounding + third * std::pow(far, 3.0));
    CHECK(glm::length(carried.first - there.first) <= rounding + third * far * far);
    if (curve.is_its_taylor_series()) {
        CHECK(glm::length(carried.second - there.second) <= 10.0 * rounding);
    }
}

TEST_CASE("nine points and square roots of a half make an exact circle") {
    const double r = 0.037;
    const double s = std::sqrt(0.5);  // Piegl & Tiller, example 7.1; clockwise, object inside
    const NurbsCurve<2> circle(
        2, {0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4},
        std::vector<Vec2>{Vec2{r, 0}, Vec2{r, -r}, Vec2{0, -r}, Vec2{-r, -r}, Vec2{-r, 0},
                          Vec2{-r, r}, Vec2{0, r}, Vec2{r, r}, Vec2{r, 0}},
        std::vector<double>{1, s, 1, s, 1, s, 1, s, 1});
    REQUIRE(circle.spans().size() == 4);
    for (int i = 0; i <= 400; ++i) {
        const double u = 0.01 * i;
        CHECK(glm::length(circle.at(u).point) == Approx(r).epsilon(1e-15));
        const auto& span = circle.spans()[circle.span_of(u)];
        const Frame frame = frame_at(span.curve, u - span.lo);
        CHECK(frame.curvature == Approx(1.0 / r).epsilon(1e-13));
        CHECK(glm::dot(frame.normal, frame.point) == Approx(r).epsilon(1e-14));
    }
}

TEST_CASE("what is no NURBS curve is refused with the place, the value and the remedy") {
    const std::vector<Vec2> four{Vec2{0, 0}, Vec2{1, 0}, Vec2{1, 1}, Vec2{0, 1}};
    const auto refuse = [&four](int degree, const std::vector<double>& knots) {
        return NurbsCurve<2>(degree, knots, four);
    };
    CHECK_THROWS_WITH(refuse(0, {}), Has("degree is 0: give 1 to 9"));
    CHECK_THROWS_WITH(refuse(10, {}), Has("degree is 10"));
    CHECK_THROWS_WITH(refuse(4, {}), Has("at least 5 control points, not 4"));
    CHECK_THROWS_WITH(refuse(3, {0, 0, 0, 0, 1, 1, 1}), Has("has 7 values", "need 8"));
    CHECK_THROWS_WITH(refuse(2, {0, 0, 0, 2, 1, 1, 1}), Has("knots[4] = 1 is below"));
    CHECK_THROWS_WITH(refuse(2, {0, 0, 0.1, 0.5, 1, 1, 1}), Has("repeat its first"));
    CHECK_THROWS_WITH(refuse(3, {2, 2, 2, 2, 2, 2, 2, 2}), Has("only the value 2"));
    CHECK_THROWS_WITH(refuse(1, {0, 0, 0.5, 0.5, 1, 1}), Has("inner knot 0.5 more than 1 times"));
    const double inf = std::numeric_limits<double>::infinity();
    CHECK_THROWS_WITH(refuse(2, {0, 0, 0, inf, 1, 1, 1}), Has("knots[3] is inf"));
    const std::vector<double> knots{0, 0, 0, 0, 1, 1, 1, 1};
    CHECK_THROWS_WITH(NurbsCurve<2>(3, knots, four, std::vector<double>{1, 1, 1}),
                      Has("3 weights for 4"));
    CHECK_THROWS_WITH(NurbsCurve<2>(3, knots, four, std::vector<double>{1, 1, -2, 1}),
                      Has("weights[2] is -2"));
}
