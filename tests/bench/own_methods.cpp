#include "tests/bench/own_methods.hpp"

#include "engine/rendering/scene.hpp"
#include "tests/bench/polyline.hpp"
#include "tests/figures/thesis/curve_tracker.hpp"
#include "tests/support/outlines.hpp"

namespace palpate::bench {

namespace {

using engine::NurbsCurve;
using figures::CurveTracker;
using figures::TrackedFoot;
using figures::TrackerKind;
using figures::TrackerSpec;
using figures::TrackerState;
using tests::kStudyFriction;

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

/// Every tracker of the thesis, one on each curve of the object, the nearest of their feet: what
/// the thesis' switch between curves needs near a vertex.
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
namespace {

using namespace palpate::engine;

/// One evaluation of C, C' and C'', each waiting for the one before.
struct Evaluation {
    RationalBezier<2> curve;
    double u = 0.4;

    void reset(const Vec2& /*first*/) { u = 0.4; }
    Answer<2> answer(const Vec2& /*hip*/) {
        const Jet<2> jet = curve.at(u);
        keep(jet);
        u = 0.4 + 1e-30 * jet.point.x;
        return {jet.point, u};
    }
};

/// One Newton update of u, each waiting for the one before.
struct NewtonUpdate {
    RationalBezier<2> curve;
    double u = 0.4;

    void reset(const Vec2& /*first*/) { u = 0.4; }
    Answer<2> answer(const Vec2& hip) {
        const Jet<2> jet = curve.at(u);
        const Vec2 gap = jet.point - hip;
        const double g = glm::dot(gap, jet.first);
        const double h = glm::dot(jet.first, jet.first) + glm::dot(gap, jet.second);
        u = 0.4 + 1e-30 * (g / h);
        return {jet.point, u};
    }
};

/// Nearest of all features of the outline, anew each tick.
struct Global {
    std::shared_ptr<const engine::Outline> outline;
    engine::OutlineFeet feet;

    explicit Global(const Object& object, bool closed)
        : outline(std::make_shared<const engine::Outline>(outline_of(object, closed))),
          feet(*outline) {}
    void reset(const Vec2& /*first*/) {}
    Answer<2> answer(const Vec2& hip) {
        const engine::ClosestPoint found = feet.closest(hip);
        return {found.point, found.distance};
    }
};

/// The same followed from tick to tick, with the certificate.
struct Certified {
    std::shared_ptr<const engine::Outline> outline;
    std::shared_ptr<const engine::CertifiedTracker> tracker;
    engine::TrackState state{};

    Certified(const Object& object, bool closed)
        : outline(std::make_shared<const engine::Outline>(outline_of(object, closed))),
          tracker(std::make_shared<const engine::CertifiedTracker>(*outline)) {}
    void reset(const Vec2& /*first*/) { state = {}; }
    Answer<2> answer(const Vec2& hip) {
        const engine::ClosestPoint found = tracker->track(state, hip);
        return {found.point, found.distance};
    }
};

/// A whole tick of a scene: contact, friction, force; for a record the closest point, too.
struct Tick {
    std::shared_ptr<const engine::Outline> outline;
    std::shared_ptr<const engine::Scene> scene;
    bool closest = false;
    engine::ContactState state{};
    engine::TrackState track{};

    Tick(const Object& object, const engine::SceneSpec& spec, bool looks = false)
        : outline(std::make_shared<const engine::Outline>(outline_of(object, false))),
          scene(std::make_shared<const engine::Scene>(outline, spec)),
          closest(looks) {}
    Tick(std::shared_ptr<const engine::Outline> felt, const engine::SceneSpec& spec)
        : outline(std::move(felt)), scene(std::make_shared<const engine::Scene>(outline, spec)) {}
    void reset(const Vec2& /*first*/) {
        state = {};
        track = {};
    }
    Answer<2> answer(const Vec2& hip) {
        const engine::Contact contact = scene->tick(state, hip);
        keep(contact.force);
        if (!closest || contact.mode == engine::Mode::free) {
            return {contact.go, 0.0};
        }
        const engine::ClosestPoint found = scene->closest(track, hip);
        return {found.point, found.distance};
    }
};

/// The tick while HIP keeps out of reach: the same path, half a metre away.
struct FarTick {
    Tick tick;

    void reset(const Vec2& first) { tick.reset(first); }
    Answer<2> answer(const Vec2& hip) { return tick.answer(hip + Vec2{0.0, 0.5}); }
};

/// Nearest foot of all spans, ends included.
struct AllSpans {
    engine::PieceTree<2> tree;

    static engine::PieceTree<2> tree_of(const Object& object) {
        std::vector<RationalBezier<2>> spans;
        for (const RationalBezier<2>& span : spans_of(object)) {
            spans.push_back(engine::balanced<2>(span).curve);
        }
        return engine::PieceTree<2>(std::move(spans));
    }
    explicit AllSpans(const Object& object) : tree(tree_of(object)) {}
    void reset(const Vec2& /*first*/) {}
    Answer<2> answer(const Vec2& hip) {
        const engine::Foot<2> best = tree.closest(hip);
        return {best.point, std::sqrt(best.distance2)};
    }
};

}  // namespace

std::unique_ptr<Method<2>> newton_update() {
    return make_method<2>("one cubic Newton update", Kind::floor,
                          NewtonUpdate{spans_of(contact_objects().front()).front()});
}

Methods<2> own_methods(const Object& object) {
    Methods<2> methods;
    const RationalBezier<2> span = spans_of(object).front();
    methods.push_back(make_method<2>("one evaluation", Kind::floor, Evaluation{span}));
    methods.push_back(make_method<2>("one Newton update", Kind::floor, NewtonUpdate{span}));
    methods.push_back(make_method<2>("certified", Kind::global, Certified(object, false)));
    methods.push_back(make_method<2>("global, cold", Kind::global, Global(object, false)));
    methods.push_back(make_method<2>("polyline walk, n=1e3", Kind::mesh,
                                     PolylineWalk(polyline_of(object, 1000))));
    methods.push_back(make_method<2>("polyline walk, n=1e5", Kind::mesh,
                                     PolylineWalk(polyline_of(object, 100000))));
    for (auto& tracker : tracker_methods(object)) {
        methods.push_back(std::move(tracker));
    }
    return methods;
}

Methods<2> tick_methods(const Object& object) {
    Methods<2> methods;
    methods.push_back(newton_update());
    const auto add = [&](const char* name, const engine::SceneSpec& spec) {
        methods.push_back(make_method<2>(name, Kind::floor, Tick(object, spec)));
    };
    add("tick, friction and slew", {.friction = kStudyFriction, .slew = tests::kStudySlew});
    add("tick, friction", {.friction = kStudyFriction});
    methods.push_back(make_method<2>("tick, friction, and closest point", Kind::floor,
                                     Tick(object, {.friction = kStudyFriction}, true)));
    add("tick, friction and damper", {.damping = 0.2, .friction = kStudyFriction});
    add("tick, frictionless", {});
    methods.push_back(make_method<2>("tick, out of reach", Kind::floor,
                                     FarTick{Tick(object, {.friction = kStudyFriction})}));
    return methods;
}

Methods<2> soft_methods(const Object& object) {
    std::vector<RationalBezier<2>> spans = spans_of(object);
    if (object.name != "E") {
        return {};
    }
    spans.push_back(engine::make_line(spans[1].at(1.0).point, spans[0].at(0.0).point));
    const auto closed = std::make_shared<const engine::Outline>(std::move(spans), true);
    Methods<2> methods;
    const auto add = [&](const char* name, const engine::SceneSpec& spec) {
        methods.push_back(make_method<2>(name, Kind::floor, Tick(closed, spec)));
    };
    add("tick on a base line, friction", {.friction = kStudyFriction});
    add("the same, soft: 1 mm/N", {.friction = kStudyFriction, .compliance = 1e-3});
    return methods;
}

Methods<2> any_curve_methods(const Object& object) {
    Methods<2> methods;
    methods.push_back(make_method<2>("global, cold", Kind::global, AllSpans(object)));
    return methods;
}

Methods<2> scaling_methods(const Object& ring) {
    Methods<2> methods;
    methods.push_back(make_method<2>("certified", Kind::global, Certified(ring, true)));
    methods.push_back(make_method<2>("global, cold", Kind::global, Global(ring, true)));
    return methods;
}

}  // namespace palpate::bench
