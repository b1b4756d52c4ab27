#include "tests/figures/thesis/curve_tracker.hpp"
#include "tests/support/allocations.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/nurbs_oracle.hpp"
#include "tests/support/stability_limit.hpp"
#include "tests/support/thesis_objects.hpp"

using namespace palpate::engine;
using namespace palpate::figures;

namespace {

constexpr double kTrackerPeriod = 0.001;
constexpr TrackerKind kKinds[] = {TrackerKind::feedback, TrackerKind::feed_forward,
                                  TrackerKind::feedback_linearised, TrackerKind::tangent_plane,
                                  TrackerKind::newton};

/// A cubic without cusps: control points that go on to the right.
NurbsCurve<2> random_cubic(Random& random) {
    std::vector<Vec2> points;
    for (int i = 0; i < 4; ++i) {
        const double x = 0.03 * i + random.in(-0.01, 0.01);
        points.emplace_back(x, random.in(-0.02, 0.02));
    }
    return bezier(points);
}

/// HIP beside the two cubics: sweeps at up to 0.25 m/s, 3 mm out to 3 mm in, with tremor.
Vec2 sweep(const std::vector<NurbsCurve<2>>& curves, double t) {
    const double w = 1.0 + 0.97 * std::sin(2.0 * M_PI * 0.6 * t);
    const double offset = 0.003 * std::sin(2.0 * M_PI * 0.37 * t + 1.0);
    const auto& curve = curves[w < 1.0 ? 0 : 1];
    const Jet<2> jet = curve.at(w < 1.0 ? w : w - 1.0);
    const Vec2 tremor{5e-5 * std::sin(2.0 * M_PI * 9.0 * t), 5e-5 * std::cos(2.0 * M_PI * 9.0 * t)};
    return jet.point + offset * perp(glm::normalize(jet.first)) + tremor;
}

/// 99th percentile of | distance - true distance | over ten seconds, both curves tracked, m.
double p99(const TrackerSpec& spec) {
    const auto curves = two_cubics();
    const std::array<CurveTracker, 2> trackers{CurveTracker(curves[0], spec),
                                               CurveTracker(curves[1], spec)};
    std::array<TrackerState, 2> states{trackers[0].start(sweep(curves, 0.0)),
                                       trackers[1].start(sweep(curves, 0.0))};
    std::vector<double> errors;
    for (int k = 0; k < 10000; ++k) {
        const Vec2 hip = sweep(curves, k * kTrackerPeriod);
        double nearest = 1.0;
        for (std::size_t i = 0; i < 2; ++i) {
            const TrackedFoot foot = trackers[i].step(states[i], hip, kTrackerPeriod);
            nearest = std::min(nearest, glm::length(foot.point - hip));
        }
        errors.push_back(std::fabs(nearest - true_distance(two_polygons(), hip)));
    }
    std::nth_element(errors.begin(), errors.begin() + 9900, errors.end());
    return errors[9900];
}

}  // namespace

TEST_CASE("a tracker refuses numbers out of range, with value and remedy") {
    const NurbsCurve<2> curve = line({0.0, 0.0}, {1.0, 0.0});
    const auto make = [&](const TrackerSpec& spec) {
        return CurveTracker(curve, spec);
    };
    CHECK_THROWS_WITH(make({.gain = -2.5}), Has("-2.5", "1/(m^2 s)"));
    CHECK_THROWS_WITH(make({.gain = NAN}), Has("nan"));
    CHECK_THROWS_WITH(make({.sub_steps = 0}), Has("sub-steps is 0"));
    CHECK_THROWS_WITH(make({.kind = TrackerKind::tangent_plane, .rate_hz = 0.0}), Has("Hz"));
    CHECK_THROWS_WITH(make({.kind = TrackerKind::newton, .iterations = 101}), Has("101"));
    CHECK_NOTHROW(make({.kind = TrackerKind::newton, .gain = -1.0}));  // newton reads no gain
    CHECK_THROWS_AS(feedback_gain(curve, 0.0, kTrackerPeriod), std::invalid_argument);
    CHECK_THROWS_AS(theorem_gain(0.05, 0.5, 0.0), std::invalid_argument);
}

TEST_CASE(
    "the sampled stability limit of the feedback tracker is 2 over T times the second derivative") {
    SEEDED(random, 60U);
    const NurbsCurve<2> curve = random_cubic(random);
    const double u = random.in(0.2, 0.8);
    const Jet<2> jet = curve.at(u);
    const Vec2 hip = jet.point + random.in(-0.003, 0.003) * perp(glm::normalize(jet.first));
    const double formula = critical_gain(curve, u, hip, kTrackerPeriod);
    REQUIRE(formula > 0.0);
    CHECK(stability_limit_ratio(curve, u, hip, kTrackerPeriod) == Approx(1.0).margin(0.001));
}

TEST_CASE("beyond the centre of curvature no gain is stable") {
    const NurbsCurve<2> curve =
        bezier({{-0.01, 0.0}, {0.0, 0.02}, {0.01, 0.0}});  // radius 5 mm at 1/2
    const Vec2 centre{0.0, 0.005};
    CHECK(critical_gain(curve, 0.5, centre + Vec2{0.0, 1e-4}, kTrackerPeriod) > 0.0);
    CHECK(critical_gain(curve, 0.5, centre - Vec2{0.0, 1e-4}, kTrackerPeriod) == 0.0);
    // Outside a tip the limit falls below that of the speed alone: 1 + 3 mm / 5 mm.
    const double above = critical_gain(curve, 0.5, Vec2{0.0, 0.013}, kTrackerPeriod);
    CHECK(2.0 / (kTrackerPeriod * 0.02 * 0.02) / above == Approx(1.6).epsilon(1e-12));
}

TEST_CASE("one explicit Euler step of gain 1 over T and speed squared is one Gauss-Newton step") {
    SEEDED(random, 200U);
    const NurbsCurve<2> curve = random_cubic(random);
    const double u = random.in(0.2, 0.8);
    const Jet<2> jet = curve.at(u);
    const double speed2 = glm::dot(jet.first, jet.first);
    const Vec2 hip = jet.point + random.point(-0.004, 0.004);

    const CurveTracker euler(
        curve, {.kind = TrackerKind::feedback, .gain = 1.0 / speed2 / kTrackerPeriod});
    const CurveTracker plane(curve,
                             {.kind = TrackerKind::tangent_plane, .rate_hz = 1.0 / kTrackerPeriod});
    TrackerState a = euler.start_at(u);
    TrackerState b = plane.start_at(u);
    euler.step(a, hip, kTrackerPeriod);
    plane.step(b, hip, kTrackerPeriod);

    const double gauss_newton = u + glm::dot(hip - jet.point, jet.first) / speed2;
    CHECK(a.u == Approx(gauss_newton).margin(1e-14));
    CHECK(b.plane_u == Approx(gauss_newton).margin(1e-14));  // a refresh is the same step
}

TEST_CASE("the linearised law of gain 1 over T is one Newton step") {
    SEEDED(random, 200U);
    const NurbsCurve<2> curve = random_cubic(random);
    const double u = random.in(0.2, 0.8);
    const Vec2 hip = curve.at(u).point + random.point(-0.003, 0.003);
    const CurveTracker law(
        curve, {.kind = TrackerKind::feedback_linearised, .gain = 1.0 / kTrackerPeriod});
    const CurveTracker newton(curve, {.kind = TrackerKind::newton});
    TrackerState a = law.start_at(u);
    TrackerState b = newton.start_at(u);
    law.step(a, hip, kTrackerPeriod);
    newton.step(b, hip, kTrackerPeriod);
    CHECK(a.u == Approx(b.u).margin(1e-14));
}

TEST_CASE("on a straight edge the lag of feedback is v over loop gain, and feed-forward has none") {
    constexpr double kLength = 0.1;
    constexpr double kSpeed = 0.05;
    constexpr double kLambda = 40.0;  // 1/s
    const NurbsCurve<2> edge = line({0.0, 0.0}, {kLength, 0.0});
    const double gain = kLambda / (kLength * kLength);
    const CurveTracker feedback(edge, {.kind = TrackerKind::feedback, .gain = gain});
    const CurveTracker forward(edge, {.kind = TrackerKind::feed_forward, .gain = gain});
    TrackerState a = feedback.start_at(0.0);
    TrackerState b = forward.start_at(0.0);
    TrackedFoot lagging;
    TrackedFoot carried;
    for (int k = 0; k <= 1000; ++k) {
        const Vec2 hip{kSpeed * k * kTrackerPeriod, 0.002};
        lagging = feedback.step(a, hip, kTrackerPeriod);
        carried = forward.step(b, hip, kTrackerPeriod);
    }
    // Settled: (1 - lambda T)(lag + v T) = lag.
    const double lag = kSpeed / kLambda - kSpeed * kTrackerPeriod;
    CHECK(-lagging.psi == Approx(lag).epsilon(1e-9));
    CHECK(std::fabs(carried.psi) < 1e-15);
    CHECK(carried.depth == Approx(-0.002));
}

TEST_CASE("feedback errors fall with the loop gain until it leaves its limit") {
    const auto curves = two_cubics();
    const auto error = [&](double kappa) {
        return p99({.gain = feedback_gain(curves[0], kappa, kTrackerPeriod)});
    };
    const double slow = error(0.01);
    const double tenth = error(0.1);
    const double one = error(1.0);
    const double beyond = error(2.1);
    const double newton = p99({.kind = TrackerKind::newton, .iterations = 2});
    const double held = p99({.kind = TrackerKind::tangent_plane, .rate_hz = 100.0});
    CAPTURE(slow, tenth, one, beyond, newton, held);
    CHECK(slow > 1e-2);                           // work-precision table: 3.3e-2
    CHECK((tenth > 5e-4 && tenth < 6e-3));        // 2.8e-3
    CHECK((one > 1e-6 && one < 1e-4));            // 3.1e-5
    CHECK((beyond > 1e-3 && beyond > 50 * one));  // 6.1e-3
    CHECK(newton < 1e-9);
    CHECK((held > 1e-5 && held < 1e-3));  // 3.6e-5
}

TEST_CASE("trackers turn any finite input into finite output, and take nothing from the heap") {
    SEEDED(random, 60U);
    const NurbsData<2> data = random_nurbs<2>(random, 0.1, 1.0);
    const NurbsCurve<2> curve(data.degree, data.knots, data.points, data.weights);
    for (const TrackerKind kind : kKinds) {
        const CurveTracker tracker(
            curve, {.kind = kind, .gain = random.decade(-3.0, 12.0), .sub_steps = 3});
        TrackerState state = tracker.start(random.point(-0.1, 0.1));
        const std::size_t before = allocations();
        bool sane = true;
        for (int k = 0; k < 50; ++k) {
            const double far = k % 10 == 9 ? 1e9 : 0.1;
            Vec2 hip = random.point(-far, far);
            hip.x = k % 17 == 16 ? std::numeric_limits<double>::quiet_NaN() : hip.x;
            const TrackedFoot foot = tracker.step(state, hip, kTrackerPeriod);
            sane = sane && foot.u >= curve.front() && foot.u <= curve.back() &&
                   std::isfinite(foot.point.x) && std::isfinite(foot.point.y) &&
                   std::isfinite(foot.psi) && std::isfinite(foot.depth);
        }
        CHECK(sane);
        CHECK(allocations() == before);
    }
}
