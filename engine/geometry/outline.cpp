#include "engine/geometry/outline.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include "engine/math/elementary.hpp"

namespace palpate::engine {
namespace {

/// Ends further apart than this, m, are not the same vertex: 1 nm, a thousandth of what is felt.
constexpr double kSameEnd = 1e-9;

Joint join(const std::vector<RationalBezier<2>>& segments, std::size_t before, std::size_t after) {
    const Frame end = frame_at(segments[before], 1.0);
    const Frame start = frame_at(segments[after], 0.0);
    const double gap = glm::length(start.point - end.point);
    if (gap > kSameEnd) {
        throw std::invalid_argument("segment " + std::to_string(after) + " starts " +
                                    std::to_string(gap) + " m away from the end of segment " +
                                    std::to_string(before) + ": let them share the point");
    }
    Joint joint{.point = start.point,
                .before = before,
                .after = after,
                .tangent_in = end.tangent,
                .tangent_out = start.tangent};
    const double side = cross(end.tangent, start.tangent);
    joint.turn = std::fabs(arc_tan2(side, glm::dot(end.tangent, start.tangent)));
    if (joint.turn > kPi - 1e-6) {
        throw std::invalid_argument("the outline turns back on itself where segment " +
                                    std::to_string(after) + " starts: open the angle");
    }
    joint.kind = joint.turn <= kSmoothTurn ? JointKind::smooth
               : side < 0.0                ? JointKind::convex
                                           : JointKind::concave;
    return joint;
}

/// Twice the signed area of the polygon of control points: < 0 clockwise.
double control_area(const std::vector<RationalBezier<2>>& segments) {
    double area = 0.0;
    for (const auto& segment : segments) {
        for (std::size_t i = 0; i < static_cast<std::size_t>(segment.degree()); ++i) {
            area += cross(segment.point(i), segment.point(i + 1));
        }
    }
    return area;
}

}  // namespace

Frame frame_at(const RationalBezier<2>& curve, double u) noexcept {
    const Jet<2> jet = curve.at(u);
    Frame frame;
    frame.point = jet.point;
    frame.speed = glm::length(jet.first);
    if (frame.speed > 0.0) {
        const double inverse = 1.0 / frame.speed;
        frame.tangent = jet.first * inverse;
        frame.curvature = -cross(jet.first, jet.second) * (inverse * inverse * inverse);
    }
    frame.normal = perp(frame.tangent);
    return frame;
}

Outline::Outline(std::vector<RationalBezier<2>> segments, bool closed)
    : segments_(std::move(segments)), closed_(closed) {
    if (segments_.empty()) {
        throw std::invalid_argument("an outline needs at least one segment");
    }
    for (std::size_t i = 0; i + 1 < segments_.size(); ++i) {
        joints_.push_back(join(segments_, i, i + 1));
    }
    if (closed_) {
        joints_.push_back(join(segments_, segments_.size() - 1, 0));
        if (!(control_area(segments_) < 0.0)) {
            throw std::invalid_argument(
                "a closed outline must run clockwise, the object on the right "
                "of travel: reverse the order of its points");
        }
    }
}

std::optional<std::size_t> Outline::joint_beyond(std::size_t segment, bool forward) const noexcept {
    const std::size_t n = segments_.size();
    if (forward) {
        if (segment + 1 < n || closed_) {
            return segment;
        }
        return std::nullopt;
    }
    if (segment > 0) {
        return segment - 1;
    }
    if (closed_) {
        return n - 1;
    }
    return std::nullopt;
}

}  // namespace palpate::engine
