#include "engine/contact/closest_point.hpp"

#include <algorithm>

#include "engine/geometry/cusps.hpp"
#include "engine/math/elementary.hpp"
#include "engine/math/twice.hpp"

namespace palpate::engine {

namespace {

/// Up to this turn, rad, the side of the mean tangent tells inside from outside at a vertex.
constexpr double kShallow = 1.0;

/// A point is no further from h than a foot is, but for rounding.
bool as_near(const Vec2& point, const Vec2& h, const Foot<2>& foot) noexcept {
    const double rounding = 8.0 * kEpsilon * (glm::length(point) + glm::length(h));
    return glm::length(point - h) <= std::sqrt(foot.distance2) + rounding;
}

/// Two control points at an end are one: there the foot polynomial vanishes with C'.
bool repeats(const RationalBezier<2>& span, bool at_last) noexcept {
    const auto last = static_cast<std::size_t>(span.degree());
    return at_last ? span.local_point(last) == span.local_point(last - 1)
                   : span.local_point(0) == span.local_point(1);
}

/// A foot beside a vertex that is in truth the vertex: h lies in its region, and is no nearer to
/// the foot than rounding can tell.
bool on_vertex(const Seam& vertex, const Vec2& h, const Foot<2>& foot) noexcept {
    const Vec2 gap = vertex.point - h;
    return glm::dot(gap, vertex.tangent_in) <= 0.0 && glm::dot(gap, vertex.tangent_out) >= 0.0 &&
           as_near(vertex.point, h, foot);
}

/// h lies past the open end of a curve, where all is outside. Without rounding, as a foot beside
/// the end is found to more than the last digit of h.
bool beyond_end(const RationalBezier<2>& span, bool at_last, const Vec2& h) noexcept {
    const auto last = static_cast<std::size_t>(span.degree());
    const Vec2& end = span.local_point(at_last ? last : 0);
    const Vec2 leg = end_leg(span, at_last);
    const auto gap = [&](int k) {
        return exact_sum(h[k], -span.origin()[k]) - end[k];
    };
    const double along = head(gap(0) * leg.x + gap(1) * leg.y);
    return at_last ? along >= 0.0 : along <= 0.0;
}

}  // namespace

OutlineFeet::OutlineFeet(const Outline& outline) : outline_(&outline), tree_(outline.spans()) {
    for (const RationalBezier<2>& span : outline.spans()) {
        plain_.push_back(!repeats(span, false) && !repeats(span, true));
    }
}

ClosestPoint OutlineFeet::at_seam(std::size_t seam, const Vec2& h) const noexcept {
    const Seam& vertex = outline_->seams()[seam];
    const Vec2 gap = h - vertex.point;
    const double distance = glm::length(gap);
    if (vertex.kind == SeamKind::smooth) {
        return {.place = {.index = vertex.after, .parameter = 0.0},
                .point = vertex.point,
                .distance = distance,
                .inside = cross(vertex.tangent_out, gap) < 0.0};
    }
    ClosestPoint result{
        .place = {.on_seam = true, .index = seam}, .point = vertex.point, .distance = distance};
    if (vertex.kind == SeamKind::convex) {
        const Vec2 normal = perp(vertex.tangent_in);
        const double phi = arc_tan2(glm::dot(gap, vertex.tangent_in), glm::dot(gap, normal));
        result.place.parameter = std::clamp(phi, 0.0, vertex.turn);
    }
    // At a shallow vertex rounding may name the vertex for the other side of the outline, too.
    const double side = cross(vertex.tangent_in + vertex.tangent_out, gap);
    result.inside =
        vertex.turn < kShallow ? side < 0.0 : vertex.kind == SeamKind::concave && distance > 0.0;
    return result;
}

/// The end of the span is no further from h than the foot is, but for rounding: at an end whose
/// control points repeat the foot may be anywhere that is as near.
ClosestPoint OutlineFeet::near_end(const Vec2& h,
                                   const Foot<2>& foot,
                                   const Vec2& tangent) const noexcept {
    const RationalBezier<2>& span = outline_->spans()[foot.span];
    const bool forward = foot.u > 0.5;
    const auto last = static_cast<std::size_t>(span.degree());
    bool beyond = false;
    const bool still = repeats(span, forward) && as_near(span.point(forward ? last : 0), h, foot);
    if (still || std::fabs(foot.u - (forward ? 1.0 : 0.0)) <= kNearEnd) {
        const auto seam = outline_->seam_beyond(foot.span, forward);
        const bool at_end = foot.u == 0.0 || foot.u == 1.0;
        if (seam && (at_end || on_vertex(outline_->seams()[*seam], h, foot))) {
            return at_seam(*seam, h);
        }
        beyond = !seam && beyond_end(span, forward, h);
    }
    // Where the curve stands still, C' is rounding: its side is that of the end.
    return on_span(h, foot, still ? end_leg(span, forward) : tangent, beyond);
}

ClosestPoint OutlineFeet::closest(const Vec2& h) const noexcept {
    const Foot<2> foot = tree_.closest(h);
    return named(h, foot, outline_->spans()[foot.span].at(foot.u).first);
}

}  // namespace palpate::engine
