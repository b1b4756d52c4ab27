#include "engine/rendering/scene.hpp"
#include "tests/support/arc_oracle.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/frame.hpp"
#include "tests/support/outlines.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

TEST_CASE(
    "every point of a rational quadratic arc lies on its circle, with the circle's curvature") {
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

TEST_CASE("what is not a curve is refused with the value and the remedy") {
    const Vec2 a{0.0, 0.0};
    const Vec2 b{0.1, 0.0};
    CHECK_THROWS_WITH(make_line(a, a), Has("apart"));
    CHECK_THROWS_WITH(make_arc(a, b, 20.0), Has("curvature 20 1/m", "below 19.8"));
    CHECK_THROWS_WITH(make_arc(a, b, std::numeric_limits<double>::quiet_NaN()), Has("nan"));
    const std::vector<Vec2> points{a, b};
    CHECK_THROWS_WITH(RationalBezier<2>(points, std::vector{1.0, 0.0}),
                      Has("weights[1]", "above 0"));
    CHECK_THROWS_WITH(RationalBezier<2>(points, std::vector{1.0}), Has("one weight"));
    CHECK_THROWS_WITH(RationalBezier<2>(std::vector{a}, std::vector{1.0}), Has("2 to 10"));
    CHECK_THROWS_WITH(
        RationalBezier<2>(std::vector{a, Vec2{1.0 / 0.0, 0.0}}, std::vector{1.0, 1.0}),
        Has("control point 1 has the coordinate inf"));
}

// The closed forms of arcs and lines against the rational quadratic that they are (Piegl & Tiller,
// The NURBS Book, 7.3), against centre and radius, and against the same curve as a cubic, which no
// closed form knows.

namespace {

struct RandomArc {
    Vec2 from;
    Vec2 to;
    double curvature;
    RationalBezier<2> span;
};

RandomArc random_arc(Random& random) {
    const Vec2 from = random.point(-0.1, 0.1);
    const Vec2 to = from + random.decade(-3.0, -1.0) * random.point(-1.0, 1.0);
    const double chord = glm::length(to - from);
    const double sine = random.below(4) == 0 ? 0.0 : random.in(-0.98, 0.98);
    const double curvature = 2.0 * sine / chord;
    return {from, to, curvature, make_arc(from, to, curvature)};
}

/// The same curve with one control point more.
RationalBezier<2> raised(const RationalBezier<2>& span) {
    const auto n = static_cast<std::size_t>(span.degree());
    std::vector<Vec2> points;
    std::vector<double> weights;
    for (std::size_t i = 0; i <= n + 1; ++i) {
        const double share = static_cast<double>(i) / static_cast<double>(n + 1);
        const double before = i > 0 ? share * span.weight(i - 1) : 0.0;
        const double after = i <= n ? (1.0 - share) * span.weight(i) : 0.0;
        weights.push_back(before + after);
        const Vec2 sum = (i > 0 ? before * span.point(i - 1) : Vec2{}) +
                         (i <= n ? after * span.point(i) : Vec2{});
        points.push_back(sum / weights.back());
    }
    return {points, weights};
}

}  // namespace

TEST_CASE("an arc in closed form is the rational quadratic, point and tangent") {
    SEEDED(random, std::uint64_t{2000});
    const RandomArc one = random_arc(random);
    const auto arc = Arc::of(one.span);
    REQUIRE(arc);
    const double u = random.below(8) == 0 ? random.below(2) : random.in(0.0, 1.0);
    const Arc::Point at = arc->at(u, 1.0 - u);
    const Jet<2> jet = one.span.at(u);
    CHECK(glm::length(at.point - jet.point) <= 1e-16);
    CHECK(glm::length(at.tangent - jet.first / glm::length(jet.first)) <= 4e-14);
    CHECK(std::fabs(glm::length(at.tangent) - 1.0) <= 4e-14);
}

TEST_CASE("what is no arc is none") {
    const Vec2 a{-0.03, 0.01};
    const Vec2 b{0.02, 0.04};
    const RationalBezier<2> arc = make_arc(a, b, 12.0);
    const Vec2 middle = arc.point(1);
    const double weight = arc.weight(1);
    const auto of = [](const std::vector<Vec2>& points, const std::vector<double>& weights) {
        return Arc::of(RationalBezier<2>(points, weights)).has_value();
    };
    CHECK(of({a, middle, b}, {1.0, weight, 1.0}));
    CHECK_FALSE(of({a, middle, b}, {1.0, weight * (1.0 + 1e-9), 1.0}));
    CHECK_FALSE(of({a, middle + Vec2{1e-9, 0.0}, b}, {1.0, weight, 1.0}));
    CHECK_FALSE(of({a, middle, b}, {1.0, weight, 1.001}));
    CHECK_FALSE(of({a, middle, b}, {1.0, 1.0, 1.0}));  // a parabola
    CHECK_FALSE(of({a, b}, {1.0, 2.0}));               // a line whose u is uneven
    CHECK_FALSE(Arc::of(raised(arc)));
}

TEST_CASE("the foot on an arc lies towards the centre, at the radius") {
    SEEDED(random, std::uint64_t{2000});
    const RandomArc one = random_arc(random);
    const Arc arc = *Arc::of(one.span);
    const double chord = arc.chord();
    const Vec2 h = arc.at(0.5, 0.5).point + chord * random.point(-1.0, 1.0);
    const double u = arc.foot(h);
    if (!(std::fabs(u) < 10.0)) {
        return;  // beyond the centre, or beside it
    }
    const Arc::Point foot = arc.at(u, 1.0 - u);
    const Vec2 gap = h - foot.point;
    CHECK(std::fabs(glm::dot(gap, foot.tangent)) <= 1e-12 * chord);
    if (one.curvature != 0.0) {
        const Vec2 centre = foot.point - perp(foot.tangent) / one.curvature;
        const double radius = 1.0 / std::fabs(one.curvature);
        const double expected = std::fabs(glm::length(h - centre) - radius);
        CHECK(std::fabs(glm::length(gap) - expected) <= 1e-12 * (chord + radius));
    }
}

TEST_CASE("the cone's form of an arc is W times what it says") {
    SEEDED(random, std::uint64_t{2000});
    const RandomArc one = random_arc(random);
    const Arc arc = *Arc::of(one.span);
    const Vec2 h = random.point(-0.2, 0.2);
    const double mu = random.below(3) == 0 ? 0.0 : random.in(0.0, 2.0);
    const double dir = random.coin() ? 1.0 : -1.0;
    const double u = random.in(0.0, 1.0);
    const double v = 1.0 - u;
    const double cosine = one.span.weight(1) / one.span.weight(0);
    const double w = u * u + v * v + 2.0 * u * v * cosine;
    const Arc::Point at = arc.at(u, v);
    const Vec2 r = h - at.point;
    const double expected =
        w * (dir * glm::dot(r, at.tangent) + mu * glm::dot(r, perp(at.tangent)));
    CHECK(std::fabs(arc.excess(h, mu, dir).value(2.0 * u - 1.0) - expected) <= 1e-15);
}

TEST_CASE("arcs are felt as the same curves without a closed form are") {
    SEEDED(random, std::uint64_t{60});
    const Vec2 tip{random.in(-0.01, 0.01), random.in(-0.02, 0.02)};
    const std::vector<RationalBezier<2>> arcs{
        make_arc({-0.05, 0.0}, tip, random.in(-15.0, 15.0)),
        make_arc(tip, {0.05, 0.0}, random.below(4) == 0 ? 0.0 : random.in(-15.0, 15.0))};
    const std::vector<RationalBezier<2>> cubics{raised(arcs[0]), raised(arcs[1])};
    SceneSpec spec;
    if (seed % 3 != 0) {
        spec.friction = {.mu_s = 0.7, .mu_d = 0.5, .tau_slip = 0.02, .tau_heal = 0.1};
    }
    if (seed % 4 == 1) {
        spec.slew = {.speed = 0.2, .radius = 0.003};
    }
    const Scene closed(open_outline(arcs), spec);
    const Scene general(open_outline(cubics), spec);
    REQUIRE(closed.outline().arc(0) != nullptr);
    REQUIRE(general.outline().arc(0) == nullptr);
    ContactState a;
    ContactState b;
    const double phase = random.in(0.0, 6.0);
    double worst = 0.0;
    std::size_t touching = 0;
    std::size_t otherwise = 0;
    for (int i = 0; i < 4000; ++i) {
        const double t = 0.003 * i + phase;
        const Vec2 h{0.045 * std::sin(t), 0.004 + 0.012 * std::sin(3.7 * t)};
        const Contact x = closed.tick(a, h);
        const Contact y = general.tick(b, h);
        if ((x.mode == Mode::free) != (y.mode == Mode::free) ||
            (x.place.on_seam != y.place.on_seam)) {
            ++otherwise;  // one tick sooner or later, by the last bits
            continue;
        }
        touching += x.mode != Mode::free ? 1U : 0U;
        worst = std::max(worst, glm::length(x.force - y.force));
    }
    // A budget is paid by chords of pieces where there is no closed form.
    CHECK(worst <= (spec.slew.none() ? 1e-9 : 1e-5));
    CHECK(otherwise <= 2);
    CHECK(touching > 100);
}
