#include "tests/support/catch.hpp"
#include "tests/support/surfaces.hpp"

using namespace palpate::engine;

namespace {

double gap(const Vec3& a, const Long3& b) {
    return length(b - Long3(a));
}

/// A point of the domain, on a knot now and then.
double parameter(Random& random, const std::vector<double>& knots) {
    if (random.below(4) == 0) {
        return knots[random.index(knots.size())];
    }
    return random.in(knots.front(), knots.back());
}

}  // namespace

TEST_CASE("a surface of any degree, spacing and weights is what its definition says") {
    SEEDED(random, 120U);
    const double size = random.decade(-6.0, 3.0);
    const SurfaceData data = random_surface(random, size, seed % 3U == 0U ? 0.0 : 3.0);
    const NurbsSurface surface = make_surface(data);
    const SurfaceOracle oracle(data);
    for (int k = 0; k < 20; ++k) {
        const double u = parameter(random, data.knots_u);
        const double v = parameter(random, data.knots_v);
        CHECK(1e15 * gap(surface.at(u, v).point, oracle.jet(u, v).s) / size < 8.0);
    }
}

TEST_CASE("derivatives of a surface are those of its definition") {
    SEED(120U);
    Random random(1000U + seed);
    const SurfaceData data = random_surface(random, 0.1, seed % 3U == 0U ? 0.0 : 0.5);
    const NurbsSurface surface = make_surface(data);
    const SurfaceOracle oracle(data);
    for (int k = 0; k < 10; ++k) {
        const double u = random.in(data.knots_u.front(), data.knots_u.back());
        const double v = random.in(data.knots_v.front(), data.knots_v.back());
        const SurfaceJet got = surface.at(u, v);
        const LongJet exact = oracle.jet(u, v);
        const double first = length(exact.su) + length(exact.sv) + 0.1;
        const double second = length(exact.suu) + length(exact.suv) + length(exact.svv) + first;
        CHECK(gap(got.du, exact.su) < 1e-13 * first);
        CHECK(gap(got.dv, exact.sv) < 1e-13 * first);
        CHECK(gap(got.duu, exact.suu) < 1e-12 * second);
        CHECK(gap(got.duv, exact.suv) < 1e-12 * second);
        CHECK(gap(got.dvv, exact.svv) < 1e-12 * second);
    }
}

TEST_CASE("a ball, a ring and a tube have their radius, normal and curvature everywhere") {
    const double r = 0.037;
    const NurbsSurface ball = make_surface(sphere(r));
    const NurbsSurface ring = make_surface(torus(0.06, 0.02));
    const NurbsSurface tube = make_surface(cylinder(r, 0.1));
    for (int i = 0; i <= 40; ++i) {
        for (int j = 0; j <= 40; ++j) {
            const double u = 0.1 * i;
            const double v = 0.05 * j;
            const SurfaceJet b = ball.at(u, v);
            const Vec3 up = ball.normal(u, v);
            CHECK(glm::length(b.point) == Approx(r).epsilon(2e-15));
            CHECK(glm::length(up - b.point / r) < 2e-13);  // poles and seams too
            if (j != 0 && j != 40) {
                const Curvatures k = principal_curvatures(b, up);
                CHECK(k.low == Approx(1.0 / r).epsilon(1e-11));
                CHECK(k.high == Approx(1.0 / r).epsilon(1e-11));
            }
            const SurfaceJet t = ring.at(u, 2.0 * v);
            const double axis = std::hypot(t.point.x, t.point.y);
            CHECK(std::hypot(axis - 0.06, t.point.z) == Approx(0.02).epsilon(4e-15));
            const Curvatures k = principal_curvatures(t, ring.normal(u, 2.0 * v));
            CHECK(k.high == Approx(1.0 / 0.02).epsilon(1e-11));
            CHECK(k.low == Approx((axis - 0.06) / 0.02 / axis).epsilon(1e-11).margin(1e-10));
            const SurfaceJet c = tube.at(u, 0.5 * v);
            CHECK(std::hypot(c.point.x, c.point.y) == Approx(r).epsilon(2e-15));
            const Curvatures kc = principal_curvatures(c, tube.normal(u, 0.5 * v));
            CHECK(kc.high == Approx(1.0 / r).epsilon(1e-12));
            CHECK(std::fabs(kc.low) < 1e-11);
            CHECK(normal_curvature(c, tube.normal(u, 0.5 * v), 1.0, 0.0) ==
                  Approx(1.0 / r).epsilon(1e-12));
        }
    }
    CHECK(ball.closed(true));
    CHECK_FALSE(ball.closed(false));  // its v edges are poles
    CHECK(ring.closed(true));
    CHECK(ring.closed(false));
    CHECK(tube.closed(true));
    CHECK_FALSE(tube.closed(false));
}

TEST_CASE("where the first derivatives vanish the normal is its limit from inside") {
    // A quarter of a cone-like dome: the edge v = 0 is one point, and control points repeat.
    SurfaceData d = plane(0.05);
    d.points[0][0] = d.points[1][0] = Vec3{0.0, -0.05, 0.0};
    const NurbsSurface fan = make_surface(d);
    CHECK(glm::length(fan.normal(0.3, 0.0) - Vec3{0, 0, 1}) < 1e-14);

    Random random(4);
    SurfaceData twice = bicubic_8x8(random, 0.0);
    for (auto& row : twice.points) {
        row[1] = row[2] = row[0];  // dS/dv and d2S/dv2 vanish at v = 0
    }
    const NurbsSurface stiff = make_surface(twice);
    const Vec3 limit = stiff.normal(2.5, 0.0);
    CHECK(glm::length(limit) == Approx(1.0).epsilon(1e-14));
    CHECK(glm::length(limit - stiff.normal(2.5, 1e-3)) < 2e-2);
}

TEST_CASE("an object a kilometre away keeps the digits of its coordinates") {
    Random random(8);
    SurfaceData data = bicubic_8x8(random, 0.7);
    for (auto& row : data.points) {
        for (Vec3& p : row) {
            p += Vec3{1000.0, -1000.0, 1000.0};
        }
    }
    const NurbsSurface surface = make_surface(data);
    const SurfaceOracle oracle(data);
    for (int k = 0; k < 50; ++k) {
        const double u = random.in(0.0, 5.0);
        const double v = random.in(0.0, 5.0);
        CHECK(gap(surface.at(u, v).point, oracle.jet(u, v).s) < 4e-13);  // two last bits of 1 km
    }
}

TEST_CASE("what is no surface is refused with the place, the value and the remedy") {
    const auto refused = [](const char* words, const auto& change) {
        SurfaceData d = plane(1.0);
        change(d);
        CHECK_THROWS_WITH(make_surface(d), Has(words));
    };
    refused("knots_u has 3 values", [](auto& d) { d.knots_u = {0, 0, 1}; });
    refused("knots_v[3] = 1 is below", [](auto& d) { d.knots_v = {0, 0, 2, 1}; });
    refused("points[1] has 1 points, points[0] 2", [](auto& d) { d.points[1].pop_back(); });
    refused("same length", [](auto& d) { d.points[1].pop_back(); });
    refused("1 rows of weights for 2", [](auto& d) { d.weights = {{1, 1}}; });
    refused("weights[1] has 1 values for 2", [](auto& d) { d.weights = {{1, 1}, {1}}; });
    refused("weights[3] is -3", [](auto& d) { d.weights = {{1, 1}, {1, -3}}; });
    refused("control point 1 has the coordinate", [](auto& d) { d.points[0][1].y = NAN; });
    refused("degree is 10", [](auto& d) { d.degree_u = 10; });
    CHECK_THROWS_WITH(BezierPatch(1, 1, {}, true), Has("needs 4 control points"));
}

TEST_CASE("a surface of which a span is a mere curve is refused, however it is turned") {
    SEEDED(random, 40U, 2907U);
    SurfaceData d{.degree_u = 1 + random.below(3), .degree_v = 1 + random.below(3)};
    const auto p = static_cast<std::size_t>(d.degree_u);
    const auto q = static_cast<std::size_t>(d.degree_v);
    d.knots_u = std::vector<double>(p + 1, 0.0);  // three spans between full knots
    for (const double knot : {0.3, 0.7}) {
        d.knots_u.insert(d.knots_u.end(), p, knot);
    }
    d.knots_u.insert(d.knots_u.end(), p + 1, 1.0);
    d.knots_v = std::vector<double>(q + 1, 0.0);
    d.knots_v.insert(d.knots_v.end(), q + 1, 1.0);
    for (std::size_t i = 0; i <= 3 * p; ++i) {
        d.points.emplace_back();
        d.weights.emplace_back();
        for (std::size_t j = 0; j <= q; ++j) {
            d.points.back().push_back(
                0.1 * Vec3{random.in(-1.0, 1.0), random.in(-1.0, 1.0), random.in(-1.0, 1.0)});
            d.weights.back().push_back(random.decade(-3.0, 3.0));
        }
    }
    REQUIRE_NOTHROW(make_surface(d));
    const auto first = p * random.index(3);  // of the span that collapses
    SurfaceData lines = d;                   // its rows are one
    for (std::size_t i = first + 1; i <= first + p; ++i) {
        lines.points[i] = lines.points[first];
        lines.weights[i] = lines.weights[first];
    }
    CHECK_THROWS_WITH(make_surface(lines), Has("is a mere curve"));
    const Vec3 aside =
        glm::normalize(Vec3{random.in(-1.0, 1.0), random.in(-1.0, 1.0), random.in(-1.0, 1.0)});
    for (const bool taken : {false, true}) {  // or apart by less than 1e-10 of the size, or more
        SurfaceData strip = lines;
        for (std::size_t i = first; i <= first + p; ++i) {
            for (Vec3& point : strip.points[i]) {
                point += (taken ? 1e-7 : 1e-12) * static_cast<double>(i - first) * aside;
            }
        }
        if (taken) {
            CHECK_NOTHROW(make_surface(strip));
        } else {
            CHECK_THROWS_WITH(make_surface(strip), Has("is a mere curve"));
        }
    }
    SurfaceData row = d;  // its points lie on one line
    const Vec3 along{random.in(-1.0, 1.0), random.in(-1.0, 1.0), random.in(-1.0, 1.0)};
    for (std::size_t i = first; i <= first + p; ++i) {
        for (Vec3& point : row.points[i]) {
            point = d.points[first][0] + random.in(-0.05, 0.05) * along;
        }
    }
    CHECK_THROWS_WITH(make_surface(row), Has("is a mere curve"));
    SurfaceData pole = d;  // a border of one point is none
    for (Vec3& point : pole.points[0]) {
        point = d.points[0][0];
    }
    CHECK_NOTHROW(make_surface(pole));
}
