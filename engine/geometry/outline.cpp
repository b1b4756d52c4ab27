#include "engine/geometry/outline.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "engine/geometry/cusps.hpp"
#include "engine/math/elementary.hpp"

namespace palpate::engine {
namespace {

/// Ends further apart than this, m, are not the same vertex: 1 nm, a thousandth of what is felt.
constexpr double kSameEnd = 1e-9;

/// Turns closer to pi than this, rad, are a cusp: the tangents alone no longer tell the side.
constexpr double kCuspTurn = 1e-6;

/// Side on which the outline goes on after turning back by pi: < 0 right, the object fills the
/// spike between the two branches; > 0 left, it surrounds it; 0 if the branches coincide.
double side_of_cusp(const RationalBezier<2>& in,
                    const RationalBezier<2>& out,
                    const Vec2& tangent) {
    const Vec2 tip = out.point(0);
    for (const double s : {1e-3, 1e-2, 0.1, 0.3, 0.6, 1.0}) {
        const Vec2 before = in.at(1.0 - s).point - tip;
        const Vec2 after = out.at(s).point - tip;
        // Compare at the same distance from the tip: the branches lie on curves tangent to each
        // other.
        const double scale = glm::dot(after, tangent) / glm::dot(before, tangent);
        const double side = cross(tangent, after) - scale * cross(tangent, before);
        if (std::fabs(side) > 1e-9 * glm::length(after)) {
            return side;
        }
    }
    return 0.0;
}

/// Control points nearer to an end of their span than this share of its size, or than rounding
/// tells, are that end.
constexpr double kSamePoint = 1e-12;
constexpr double kSameBits = 16.0 * kEpsilon;

/// The span with control points that all but repeat an end put onto it: there the curve stands
/// still, and does not go where rounding points. Nothing if it only waits.
std::optional<RationalBezier<2>> settled(const RationalBezier<2>& span) {
    const Box<2>& box = span.box();
    const Vec2 far = glm::max(glm::abs(box.low), glm::abs(box.high));
    const double bits = kSameBits * std::max(far.x, far.y);
    const double size = glm::length(box.size());
    if (!(size > bits)) {
        return std::nullopt;
    }
    const double same = std::max(kSamePoint * size, bits);
    std::vector<Vec2> points;
    std::vector<double> weights;
    for (std::size_t i = 0; i <= static_cast<std::size_t>(span.degree()); ++i) {
        points.push_back(span.local_point(i));
        weights.push_back(span.weight(i));
    }
    bool moved = false;
    const auto settle = [&](auto first, auto last) {
        for (auto next = first + 1; next != last && glm::length(*next - *first) <= same; ++next) {
            moved = moved || *next != *first;
            *next = *first;
        }
    };
    settle(points.begin(), points.end());
    settle(points.rbegin(), points.rend());
    return moved ? RationalBezier<2>(points, weights, span.origin()) : span;
}

std::string name_text(const SpanName& name) {
    return "segment " + std::to_string(name.segment + 1) +
           (name.lo == 0.0 ? "" : " at u = " + number_text(name.lo));
}

Seam join(const RationalBezier<2>& before, const RationalBezier<2>& after, const SpanName& name) {
    const Vec2 end = before.point(static_cast<std::size_t>(before.degree()));
    const Vec2 start = after.point(0);
    const double gap = glm::length(start - end);
    refuse_if(!(gap <= kSameEnd),
              "{} starts {:.9g} m away from the end of the one before: let them share the point",
              name_text(name), gap);
    Seam seam{.point = start,
              .tangent_in = end_tangent(before, true),
              .tangent_out = end_tangent(after, false)};
    double side = cross(seam.tangent_in, seam.tangent_out);
    seam.turn = std::fabs(arc_tan2(side, glm::dot(seam.tangent_in, seam.tangent_out)));
    if (seam.turn > kPi - kCuspTurn) {
        side = side_of_cusp(before, after, seam.tangent_in);
        refuse_if(side == 0.0, "the outline runs back along itself where {} starts: open the angle",
                  name_text(name));
    }
    seam.kind = seam.turn <= kSmoothTurn ? SeamKind::smooth
              : side < 0.0               ? SeamKind::convex
                                         : SeamKind::concave;
    return seam;
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

Outline::Outline(const std::vector<NurbsCurve<2>>& segments, bool closed) : closed_(closed) {
    for (std::size_t i = 0; i < segments.size(); ++i) {
        add_segment(segments[i], i);
    }
    join_all();
}

Outline::Outline(std::vector<RationalBezier<2>> segments, bool closed)
    : Outline(std::vector<NurbsCurve<2>>(segments.begin(), segments.end()), closed) {}

void Outline::add_segment(const NurbsCurve<2>& curve, std::size_t index) {
    refuse_if(index >= kMaxSegments,
              "an outline has at most {} segments: join some as spans of one NURBS", kMaxSegments);
    const std::size_t first = spans_.size();
    const auto add = [this](const std::optional<RationalBezier<2>>& moving, const SpanName& name) {
        if (moving) {
            spans_.push_back(*moving);
            names_.push_back(name);
        }
    };
    for (const auto& [span, name] : balanced_spans(curve, index)) {
        const std::optional<RationalBezier<2>> whole = settled(span);
        const std::vector<double> cusps = whole ? cusps_of(*whole) : std::vector<double>{};
        if (cusps.empty()) {
            add(whole, name);
            continue;
        }
        double from = 0.0;
        for (std::size_t i = 0; i <= cusps.size(); ++i) {
            const double to = i < cusps.size() ? cusps[i] : 1.0;
            const BalancedSpan<2> part = balanced(stretch_of(*whole, from, to));
            add(settled(part.curve),
                {index, name.parameter(from), name.parameter(to), part.name.ratio});
            from = to;
        }
    }
    refuse_if(spans_.size() == first,
              "segment {} is a mere point: give control points apart from one another", index + 1);
}

void Outline::join_all() {
    refuse_if(spans_.empty(), "an outline needs at least one segment");
    for (const RationalBezier<2>& span : spans_) {
        arcs_.push_back(Arc::of(span));
    }
    const std::size_t n = spans_.size();
    for (std::size_t i = 0; i + (closed_ ? 0 : 1) < n; ++i) {
        const std::size_t next = (i + 1) % n;
        Seam seam = join(spans_[i], spans_[next], names_[next]);
        seam.before = i;
        seam.after = next;
        seam.is_vertex = next <= i || names_[i].segment != names_[next].segment;
        seams_.push_back(seam);
    }
    refuse_if(closed_ && !(control_area(spans_) < 0.0),
              "a closed outline must run clockwise, the object on the right of travel: reverse the "
              "order of its points");
}

std::optional<std::size_t> Outline::seam_beyond(std::size_t span, bool forward) const noexcept {
    const std::size_t n = spans_.size();
    if (forward) {
        if (span + 1 < n || closed_) {
            return span;
        }
        return std::nullopt;
    }
    if (span > 0) {
        return span - 1;
    }
    if (closed_) {
        return n - 1;
    }
    return std::nullopt;
}

}  // namespace palpate::engine
