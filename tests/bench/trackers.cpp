#include "tests/bench/trackers.hpp"

#include "tests/figures/thesis/curve_tracker.hpp"

namespace palpate::bench {
namespace {

using engine::NurbsCurve;
using figures::CurveTracker;
using figures::TrackedFoot;
using figures::TrackerKind;
using figures::TrackerSpec;
using figures::TrackerState;

constexpr double kTick = 1e-3;

struct Tracking {
    std::vector<CurveTracker> trackers{};
    std::vector<TrackerState> states{};

    void reset(const Vec2& first) {
        states.clear();
        for (const CurveTracker& tracker : trackers) {
            states.push_back(tracker.start(first));
        }
    }
    Answer<2> answer(const Vec2& hip) {
        Answer<2> best{.foot = {}, .distance = 1e300};
        for (std::size_t i = 0; i < trackers.size(); ++i) {
            const TrackedFoot foot = trackers[i].step(states[i], hip, kTick);
            const double distance = glm::length(foot.point - hip);
            if (distance < best.distance) {
                best = {foot.point, distance};
            }
        }
        return best;
    }
};

/// `loop_gain` is K max|f'|^2 T, and K T for the linearised law.
std::unique_ptr<Method<2>> tracker(const Object& object,
                                   const std::string& name,
                                   TrackerSpec spec,
                                   double loop_gain = 1.0) {
    Tracking tracking;
    for (const auto& data : object.curves) {
        NurbsCurve<2> curve(data.degree, data.knots, data.points, data.weights);
        spec.gain = spec.kind == TrackerKind::feedback_linearised
                      ? loop_gain / kTick
                      : figures::feedback_gain(curve, loop_gain, kTick);
        tracking.trackers.emplace_back(std::move(curve), spec);
    }
    return make_method<2>(name, Kind::tracker, std::move(tracking));
}

}  // namespace

Methods<2> tracker_methods(const Object& object) {
    Methods<2> all;
    for (const double kappa : {0.1, 1.0, 1.5}) {
        std::string name = "feedback, kappa " + std::to_string(kappa).substr(0, 3);
        all.push_back(tracker(object, name, {.kind = TrackerKind::feedback}, kappa));
    }
    all.push_back(tracker(object, "feedback, kappa 4, 4 steps",
                          {.kind = TrackerKind::feedback, .sub_steps = 4}, 4.0));
    all.push_back(tracker(object, "feed-forward, kappa 1", {.kind = TrackerKind::feed_forward}));
    all.push_back(
        tracker(object, "linearised feedback, k 1", {.kind = TrackerKind::feedback_linearised}));
    all.push_back(tracker(object, "tangent plane at 100 Hz",
                          {.kind = TrackerKind::tangent_plane, .rate_hz = 100.0}));
    all.push_back(tracker(object, "tangent plane at 1 kHz",
                          {.kind = TrackerKind::tangent_plane, .rate_hz = 1000.0}));
    all.push_back(tracker(object, "Newton, 1 step", {.kind = TrackerKind::newton}));
    all.push_back(
        tracker(object, "Newton, 2 steps", {.kind = TrackerKind::newton, .iterations = 2}));
    return all;
}

}  // namespace palpate::bench
