#include "tests/figures/thesis/curve_tracker.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/thesis_objects.hpp"

using namespace palpate::engine;
using namespace palpate::figures;

namespace {

constexpr double kStep = 0.001;

}  // namespace

TEST_CASE("theorem 2.1.1 needs sub-steps: its gain holds the error in continuous time only") {
    constexpr double kReach = 0.05;
    constexpr double kSpeed = 0.5;
    constexpr double kEpsilon = 0.001;
    constexpr double kLength = 0.1;
    const double lambda = theorem_gain(kReach, kSpeed, kEpsilon);
    CHECK(lambda == Approx(5e4));
    const NurbsCurve<2> edge = line({0.0, 0.0}, {kLength, 0.0});
    // Euler's factor in the form in which the thesis writes it, with |f'| = 0.1: 5, above 2.
    CHECK(lambda * kLength * kStep == Approx(5.0));
    const auto worst = [&](int sub_steps) {
        const CurveTracker tracker(edge,
                                   {.gain = lambda / (kLength * kLength), .sub_steps = sub_steps});
        TrackerState state = tracker.start_at(0.5);
        double max = 0.0;
        for (int k = 0; k < 200; ++k) {
            const double x = 0.05 + 0.045 * std::sin(kSpeed / 0.045 * k * kStep);
            max = std::max(max, std::fabs(tracker.step(state, {x, 0.005}, kStep).psi));
        }
        return max;
    };
    CHECK(worst(100) < kEpsilon);
    CHECK(worst(26) < kEpsilon);  // factor 1.9
    CHECK(worst(1) > 0.05);       // factor 50: from one end of the edge to the other
}

TEST_CASE("on a convex curve the theorem's gain keeps the projection error below epsilon") {
    constexpr double kEpsilon = 0.001;
    constexpr double kSpeed = 0.3;
    constexpr double kReach = 0.01;  // |HIP - test point| here, checked below
    const NurbsCurve<2> curve = two_cubics()[0];
    double slowest2 = 1.0;
    for (int i = 0; i <= 1000; ++i) {
        const Vec2 first = curve.at(i / 1000.0).first;
        slowest2 = std::min(slowest2, glm::dot(first, first));
    }
    const double gain = theorem_gain(kReach, kSpeed, kEpsilon) / slowest2;
    const CurveTracker tracker(curve, {.gain = gain, .sub_steps = 40});
    TrackerState state = tracker.start(curve.at(0.5).point);
    Vec2 last = curve.at(0.5).point;
    double worst = 0.0;
    double reach = 0.0;
    double speed = 0.0;
    for (int k = 1; k <= 5000; ++k) {
        const double t = k * kStep;
        const Jet<2> jet = curve.at(0.5 + 0.45 * std::sin(8.0 * t));
        const double offset = 0.004 * std::sin(5.0 * t);
        const Vec2 hip = jet.point + offset * perp(glm::normalize(jet.first));
        const TrackedFoot foot = tracker.step(state, hip, kStep);
        worst = std::max(worst, std::fabs(foot.psi));
        reach = std::max(reach, glm::length(foot.point - hip));
        speed = std::max(speed, glm::length(hip - last) / kStep);
        last = hip;
    }
    CAPTURE(worst, reach, speed);
    REQUIRE(speed < kSpeed);
    REQUIRE(reach < kReach);
    CHECK(worst < kEpsilon);
}
