#include "tests/bench/objects.hpp"

#include "tests/support/frame.hpp"

namespace palpate::bench {
namespace {

using namespace palpate::engine;
using tests::NurbsData;

NurbsData<2> cubic(std::vector<Vec2> points) {
    return {.degree = 3,
            .knots = {0, 0, 0, 0, 1, 1, 1, 1},
            .points = std::move(points),
            .weights = {1, 1, 1, 1}};
}

NurbsData<2> mirrored(const NurbsData<2>& curve) {
    NurbsData<2> other = curve;
    std::reverse(other.points.begin(), other.points.end());
    for (Vec2& p : other.points) {
        p.x = -p.x;
    }
    return other;
}

Object two_convex() {
    const NurbsData<2> left = cubic({{-0.05, 0.0}, {-0.04, 0.02}, {-0.02, 0.035}, {0.0, 0.04}});
    return {"A", "two convex cubics joined at a vertex", {left, mirrored(left)}};
}

Object two_concave() {
    const NurbsData<2> left = cubic({{-0.05, 0.0}, {-0.03, 0.001}, {-0.005, 0.006}, {0.0, 0.05}});
    return {"B", "two concave cubics, a thin spike", {left, mirrored(left)}};
}

Object rational() {
    return {"C",
            "one rational cubic, 10 control points",
            {{.degree = 3,
              .knots = {0, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 7, 7, 7},
              .points = {{-0.05, 0.0},
                         {-0.045, 0.015},
                         {-0.035, 0.03},
                         {-0.02, 0.028},
                         {-0.008, 0.034},
                         {0.008, 0.045},
                         {0.02, 0.03},
                         {0.032, 0.034},
                         {0.045, 0.018},
                         {0.05, 0.0}},
              .weights = {1.0, 2.0, 0.5, 3.0, 1.0, 0.7, 2.5, 0.5, 1.5, 1.0}}}};
}

NurbsData<2> as_nurbs(const RationalBezier<2>& span) {
    NurbsData<2> data{.degree = span.degree(), .knots = {}, .points = {}, .weights = {}};
    const auto order = static_cast<std::size_t>(span.degree()) + 1;
    data.knots.assign(order, 0.0);
    data.knots.resize(2 * order, 1.0);
    for (std::size_t i = 0; i < order; ++i) {
        data.points.push_back(span.point(i));
        data.weights.push_back(span.weight(i));
    }
    return data;
}

/// As in the study of the thesis: legs of 40 mm at a right angle, bulging by 12/m.
Object two_arcs() {
    const double leg = 0.04 * std::numbers::sqrt2 / 2.0;
    const NurbsData<2> left = as_nurbs(engine::make_arc({-leg, 0.0}, {0.0, leg}, 12.0));
    return {"E", "two circular arcs joined at a vertex", {left, mirrored(left)}};
}

constexpr double kTipRadius = 0.63e-3;
constexpr double kSpeedRatio = 21.0;

/// (-a, 0), (b, H), (-b, H), (a, 0): 3 H / 4 = 0.1 m high. At the tip, u = 1/2,
///    C' = (1.5 (a - b), 0),  C'' = (0, -6 H),  radius = |C'|^2 / (6 H);   |C'(0)| = 3 |(a + b, H)|
/// which two equations give a + b and a - b.
Object sharp_tip() {
    const double height = 0.4 / 3.0;
    const double tip_speed = std::sqrt(6.0 * height * kTipRadius);
    const double difference = tip_speed / 1.5;
    const double end = kSpeedRatio * tip_speed / 3.0;
    const double sum = std::sqrt(end * end - height * height);
    const double a = 0.5 * (sum + difference);
    const double b = 0.5 * (sum - difference);
    Object object{"D",
                  "a cubic with a tip of 0.63 mm",
                  {cubic({{-a, 0.0}, {b, height}, {-b, height}, {a, 0.0}})}};

    double slowest = 1e9;
    double fastest = 0.0;
    double sharpest = 0.0;
    const RationalBezier<2> span = spans_of(object).front();
    for (int i = 0; i <= 2000; ++i) {
        const engine::Frame frame = engine::frame_at(span, i / 2000.0);
        slowest = std::min(slowest, frame.speed);
        fastest = std::max(fastest, frame.speed);
        sharpest = std::max(sharpest, frame.curvature);
    }
    if (std::fabs(fastest / slowest - kSpeedRatio) > 1e-9 ||
        std::fabs(1.0 / sharpest - kTipRadius) > 1e-12) {
        throw std::logic_error("object D is not what it says");
    }
    return object;
}

}  // namespace

std::vector<Object> contact_objects() {
    return {two_convex(), two_concave(), rational(), sharp_tip(), two_arcs()};
}

Object ring_of(std::size_t curves) {
    if (curves < 2) {
        throw std::invalid_argument("a ring has at least 2 curves");
    }
    constexpr double kChord = 0.01;
    constexpr double kBulge = 0.002;
    const auto n = static_cast<double>(curves);
    const double radius = 0.5 * kChord / std::sin(std::numbers::pi / n);
    const auto corner = [&](std::size_t i) {
        const double angle = -2.0 * std::numbers::pi * static_cast<double>(i % curves) / n;
        return radius * Vec2{std::cos(angle), std::sin(angle)};
    };
    Object ring{"ring", std::to_string(curves) + " cubics of 10 mm", {}};
    ring.curves.reserve(curves);
    for (std::size_t i = 0; i < curves; ++i) {
        const Vec2 from = corner(i);
        const Vec2 to = corner(i + 1);
        const Vec2 along = to - from;
        const Vec2 out = (kBulge * 4.0 / 3.0 / kChord) * engine::perp(along);
        ring.curves.push_back(
            cubic({from, from + 0.25 * along + out, to - 0.25 * along + out, to}));
    }
    return ring;
}

std::vector<RationalBezier<2>> spans_of(const Object& object) {
    std::vector<RationalBezier<2>> spans;
    for (const NurbsData<2>& data : object.curves) {
        const NurbsCurve<2> curve(data.degree, data.knots, data.points, data.weights);
        for (const auto& span : curve.spans()) {
            spans.push_back(span.curve);
        }
    }
    return spans;
}

engine::Outline outline_of(const Object& object, bool closed) {
    return {spans_of(object), closed};
}

}  // namespace palpate::bench
