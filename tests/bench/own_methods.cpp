#include "tests/bench/own_methods.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "engine/contact/closest_point.hpp"
#include "engine/geometry/rational_bezier.hpp"
#include "tests/bench/polyline.hpp"
#include "tests/bench/trackers.hpp"

namespace palpate::bench {
namespace {

using engine::Jet;
using engine::RationalBezier;

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

/// Nearest foot of all spans, ends included.
struct AllSpans {
    std::vector<engine::SpanFeet> feet{};

    explicit AllSpans(const Object& object) {
        for (const RationalBezier<2>& span : spans_of(object)) {
            feet.emplace_back(span);
        }
    }
    void reset(const Vec2& /*first*/) {}
    Answer<2> answer(const Vec2& hip) {
        engine::SpanFeet::Foot best = feet.front().closest(hip);
        for (std::size_t i = 1; i < feet.size(); ++i) {
            const engine::SpanFeet::Foot foot = feet[i].closest(hip);
            best = foot.distance2 < best.distance2 ? foot : best;
        }
        return {best.point, std::sqrt(best.distance2)};
    }
};

}  // namespace

Methods<2> own_methods(const Object& object) {
    Methods<2> methods;
    const RationalBezier<2> span = spans_of(object).front();
    methods.push_back(make_method<2>("one evaluation", Kind::floor, Evaluation{span}));
    methods.push_back(make_method<2>("one Newton update", Kind::floor, NewtonUpdate{span}));
    // Seam: certified tracking, as Kind::global.
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

Methods<2> any_curve_methods(const Object& object) {
    Methods<2> methods;
    // Seam: certified tracking, asked cold.
    methods.push_back(make_method<2>("global, cold", Kind::global, AllSpans(object)));
    return methods;
}

Methods<2> scaling_methods(const Object& ring) {
    Methods<2> methods;
    // Seam: certified tracking.
    methods.push_back(make_method<2>("global, cold", Kind::global, Global(ring, true)));
    return methods;
}

}  // namespace palpate::bench
