#include "stimuli/free_outline.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "engine/base/refuse.hpp"
#include "engine/geometry/arc.hpp"
#include "engine/geometry/cusps.hpp"
#include "engine/geometry/nurbs_curve.hpp"
#include "engine/geometry/outline.hpp"
#include "engine/math/elementary.hpp"

namespace palpate::stimuli {
namespace {

using engine::RationalBezier;
using engine::Vec2;

constexpr std::size_t kMaxPoints = 8192;
constexpr int kMaxHalvings = 12;

double distance_to_edge(const Vec2& p, const Vec2& from, const Vec2& to) {
    const Vec2 along = to - from;
    const double square = glm::dot(along, along);
    const double u = square > 0.0 ? std::clamp(glm::dot(p - from, along) / square, 0.0, 1.0) : 0.0;
    return glm::length(p - from - u * along);
}

/// The curve lies in the hull of its control points.
bool is_flat(const RationalBezier<2>& curve, double tolerance) {
    const auto last = static_cast<std::size_t>(curve.degree());
    for (std::size_t i = 1; i < last; ++i) {
        if (!(distance_to_edge(curve.point(i), curve.point(0), curve.point(last)) <= tolerance)) {
            return false;
        }
    }
    return true;
}

/// Points of `curve` without its end.
void append(std::vector<Vec2>& points,
            const RationalBezier<2>& curve,
            double tolerance,
            int halvings) {
    if (halvings == 0 || points.size() >= kMaxPoints || is_flat(curve, tolerance)) {
        points.push_back(curve.point(0));
        return;
    }
    append(points, engine::stretch_of(curve, 0.0, 0.5), tolerance, halvings - 1);
    append(points, engine::stretch_of(curve, 0.5, 1.0), tolerance, halvings - 1);
}

struct Edge {
    Vec2 from{}, to{};
    [[nodiscard]] double left() const { return std::min(from.x, to.x); }
    [[nodiscard]] double right() const { return std::max(from.x, to.x); }
};

/// -1, 0 or 1: the side of the edge on which p is.
int side_of(const Edge& edge, const Vec2& p) {
    const double area = engine::cross(edge.to - edge.from, p - edge.from);
    return area > 0.0 ? 1 : area < 0.0 ? -1 : 0;
}

bool in_box(const Edge& edge, const Vec2& p) {
    return p.x >= edge.left() && p.x <= edge.right() && p.y >= std::min(edge.from.y, edge.to.y) &&
           p.y <= std::max(edge.from.y, edge.to.y);
}

std::optional<Vec2> meeting(const Edge& a, const Edge& b) {
    const int b_from = side_of(a, b.from);
    const int b_to = side_of(a, b.to);
    const int a_from = side_of(b, a.from);
    const int a_to = side_of(b, a.to);
    if (b_from * b_to < 0 && a_from * a_to < 0) {
        const Vec2 along = a.to - a.from;
        const double u =
            engine::cross(b.from - a.from, b.to - b.from) / engine::cross(along, b.to - b.from);
        return a.from + u * along;
    }
    for (const auto& [side, edge, point] : {std::tuple{b_from, &a, &b.from},
                                            {b_to, &a, &b.to},
                                            {a_from, &b, &a.from},
                                            {a_to, &b, &a.to}}) {
        if (side == 0 && in_box(*edge, *point)) {
            return *point;
        }
    }
    return std::nullopt;
}

}  // namespace

Vec2 placed(const Pose& pose, const Vec2& point) noexcept {
    const engine::SinCos turn = engine::sin_cos(pose.turn);
    const Vec2 p = pose.size * point;
    return pose.offset + Vec2{turn.cos * p.x - turn.sin * p.y, turn.sin * p.x + turn.cos * p.y};
}

engine::NurbsCurve<2> curve_of(const Segment& segment, const Pose& pose) {
    std::vector<Vec2> points;
    points.reserve(segment.points.size());
    for (const Vec2& point : segment.points) {
        points.push_back(placed(pose, point));
    }
    if (segment.kind == Segment::Kind::nurbs) {
        return {segment.degree, segment.knots, points, segment.weights};
    }
    refuse_if(points.size() != 2, "a line or an arc has two ends");
    return engine::NurbsCurve<2>(
        engine::make_arc(points[0], points[1], segment.curvature / pose.size));
}

std::shared_ptr<const engine::Outline> make_outline(std::span<const Segment> segments,
                                                    const Pose& pose) {
    std::vector<engine::NurbsCurve<2>> curves;
    for (const Segment& segment : segments) {
        curves.push_back(curve_of(segment, pose));
    }
    return std::make_shared<const engine::Outline>(curves, true);
}

std::vector<Vec2> silhouette(const engine::Outline& outline, double tolerance) {
    std::vector<Vec2> points;
    for (const RationalBezier<2>& span : outline.spans()) {
        append(points, span, tolerance, kMaxHalvings);
    }
    if (!outline.closed()) {
        const RationalBezier<2>& last = outline.spans().back();
        points.push_back(last.point(static_cast<std::size_t>(last.degree())));
    }
    return points;
}

std::optional<Vec2> self_crossing(std::span<const Vec2> polyline, bool closed) {
    std::vector<Edge> edges;
    for (std::size_t i = 0; i + (closed ? 0 : 1) < polyline.size(); ++i) {
        const Edge edge{polyline[i], polyline[(i + 1) % polyline.size()]};
        if (edge.from != edge.to) {
            edges.push_back(edge);
        }
    }
    const std::size_t n = edges.size();
    std::vector<std::size_t> by_left(n);
    std::iota(by_left.begin(), by_left.end(), std::size_t{0});
    std::sort(by_left.begin(), by_left.end(),
              [&](std::size_t a, std::size_t b) { return edges[a].left() < edges[b].left(); });
    for (std::size_t i = 0; i < n; ++i) {
        const std::size_t a = by_left[i];
        for (std::size_t k = i + 1; k < n && edges[by_left[k]].left() <= edges[a].right(); ++k) {
            const std::size_t b = by_left[k];
            const std::size_t apart = a < b ? b - a : a - b;
            if (apart == 1 || (closed && apart + 1 == n)) {
                continue;  // they share a corner
            }
            if (const auto point = meeting(edges[a], edges[b])) {
                return point;
            }
        }
    }
    return std::nullopt;
}

}  // namespace palpate::stimuli
