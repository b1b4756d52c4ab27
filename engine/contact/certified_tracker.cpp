#include "engine/contact/certified_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace palpate::engine {
namespace {

/// A last step that Taylor's series of second order finishes may be this wrong, relative to the span.
constexpr double kTaylorError = 1e-17;

/// And no longer than this: Newton's own error after the step is of the order of its square.
constexpr double kLongestTaylor = 0x1p-19;

/// The longest such step, from C_uuu step^3 / 6 with C_uuu seen at a few places. Only the
/// last digits hang on it, not the proof.
double taylor_step(const RationalBezier<2>& curve) {
    constexpr int kPlaces = 16;
    double third = 0.0;
    for (int i = 0; i < kPlaces; ++i) {
        const Vec2 before = curve.at(static_cast<double>(i) / kPlaces).second;
        const Vec2 after = curve.at(static_cast<double>(i + 1) / kPlaces).second;
        third = std::max(third, kPlaces * glm::length(after - before));
    }
    const double allowed = 6.0 * kTaylorError * glm::length(curve.box().size());
    double step = kLongestTaylor;
    while (third * step * step * step > allowed) {
        step *= 0.5;
    }
    return step;
}

/// Steps of a follow: two are usual; more means that a search is due.
constexpr int kMaxSteps = 12;

/// Pieces of a window on either side of the foot. More would make a search dearer than it saves.
constexpr std::size_t kReach = 12;

/// A window is not narrowed below this slack, m, if more can be had: 50 ticks at 0.1 m/s.
constexpr double kWanted = 0.005;

/// Rounding of distances in a certificate, relative to the lengths in it.
constexpr double kMargin = 1e-14;

}  // namespace

CertifiedTracker::CertifiedTracker(const Outline& outline) : feet_(outline) {
    for (const RationalBezier<2>& span : outline.spans()) {
        taylor_.push_back(taylor_step(span));
    }
}

bool CertifiedTracker::one_minimum(const TrackState& s, const Vec2& h) const noexcept {
    for (std::uint32_t i = 0; i < s.vertex_count; ++i) {
        const Joint& joint = feet_.outline().joints()[s.vertices[i]];
        const Vec2 gap = joint.point - h;
        if (glm::dot(gap, joint.tangent_in) > 0.0 && glm::dot(gap, joint.tangent_out) < 0.0) {
            return false;
        }
    }
    return true;
}

/// Newton's iteration on g(u) = (C - h) . C' from the last foot, across spans, within the window.
CertifiedTracker::Followed CertifiedTracker::follow(TrackState& s, const Vec2& h) const noexcept {
    const Outline& outline = feet_.outline();
    for (int i = 0; i < kMaxSteps; ++i) {
        const Vec2 gap = s.jet.point - h;
        const double g = glm::dot(gap, s.jet.first);
        const double slope = glm::dot(s.jet.first, s.jet.first) + glm::dot(gap, s.jet.second);
        if (!(slope > 0.0)) {
            return {};
        }
        const double step = -g / slope;
        const double next = s.u + step;
        const double lo = s.span == s.first_span ? s.first_u : 0.0;
        const double hi = s.span == s.last_span ? s.last_u : 1.0;
        if (next >= lo && next <= hi) {
            if (std::fabs(step) > taylor_[s.span]) {
                s.u = next;
                s.jet = outline.spans()[s.span].at(next);
                continue;
            }
            Followed found{.settled = true};
            found.foot.span = s.span;
            found.foot.u = next;
            found.foot.point = s.jet.point + step * (s.jet.first + (0.5 * step) * s.jet.second);
            const Vec2 rest = found.foot.point - h;
            found.foot.distance2 = glm::dot(rest, rest);
            return found;
        }
        const bool forward = next > hi;
        const double end = forward ? hi : lo;
        if (s.u != end) {
            s.u = end;
            s.jet = outline.spans()[s.span].at(end);
            continue;
        }
        // The distance still falls towards this end.
        Followed found{.settled = true, .foot = {s.span, end, s.jet.point, glm::dot(gap, gap)}};
        const bool window_ends = s.span == (forward ? s.last_span : s.first_span);
        const auto joint = outline.joint_beyond(s.span, forward);
        if (window_ends || !joint) {
            return found;
        }
        const Joint& vertex = outline.joints()[*joint];
        const Vec2 to_vertex = vertex.point - h;
        const double beyond = glm::dot(to_vertex, forward ? vertex.tangent_out : vertex.tangent_in);
        if (forward ? beyond >= 0.0 : beyond <= 0.0) {
            found.on_joint = true;
            found.joint = *joint;
            found.foot.distance2 = glm::dot(to_vertex, to_vertex);
            return found;
        }
        s.span = forward ? vertex.after : vertex.before;
        s.u = forward ? 0.0 : 1.0;
        s.jet = outline.spans()[s.span].at(s.u);
    }
    return {};
}

ClosestPoint CertifiedTracker::track(TrackState& s,
                                     const Vec2& h,
                                     TrackCounts& counts) const noexcept {
    if (s.valid) {
        const double moved = glm::length(h - s.from);
        if (moved < s.slack && one_minimum(s, h)) {
            const Followed found = follow(s, h);
            if (found.settled) {
                const ClosestPoint cp = found.on_joint ? feet_.at_joint(found.joint, h)
                                                       : feet_.named(h, found.foot, s.jet.first);
                if (cp.distance + moved < s.others) {
                    ++counts.certified;
                    return cp;
                }
            }
        }
    }
    ++counts.searched;
    return search(s, h);
}

ClosestPoint CertifiedTracker::search(TrackState& s, const Vec2& h) const noexcept {
    const Foot<2> foot = feet_.tree().closest(h);
    s.span = foot.span;
    s.u = foot.u;
    s.jet = feet_.outline().spans()[foot.span].at(foot.u);
    s.from = h;
    open_window(s, h);
    return feet_.named(h, foot, s.jet.first);
}

/// The window around the foot: pieces on either side as long as f rises over them with enough slack.
void CertifiedTracker::open_window(TrackState& s, const Vec2& h) const noexcept {
    const Outline& outline = feet_.outline();
    const Pieces<2>& pieces = feet_.tree().pieces();
    const std::size_t total = pieces.size();
    const std::size_t at = pieces.holding(s.span, s.u);
    s.vertex_count = 0;
    s.slack = pieces.rise_slack(pieces[at], h);
    s.valid = s.slack > 0.0;
    if (!s.valid) {
        return;
    }
    const double wanted = std::min(0.5 * s.slack, kWanted);
    // The piece beyond an end of the window, or none where the window has to stop.
    const auto beyond = [&](std::size_t edge, std::size_t other_edge,
                            bool forward) -> std::optional<std::size_t> {
        const Piece<2>& piece = pieces[edge];
        const bool at_joint = forward ? piece.hi == 1.0 : piece.lo == 0.0;
        std::size_t next = forward ? edge + 1 : edge - 1;
        std::optional<std::size_t> vertex;
        if (at_joint) {
            const auto joint = outline.joint_beyond(piece.span, forward);
            if (!joint) {
                return std::nullopt;
            }
            next = forward ? (edge + 1) % total : (edge + total - 1) % total;
            const std::uint32_t entered = pieces[next].span;
            if (entered == pieces[at].span || entered == pieces[other_edge].span) {
                return std::nullopt;  // around a closed outline: the window has two different ends
            }
            const Joint& corner = outline.joints()[*joint];
            if (corner.kind != JointKind::smooth) {
                const Vec2 gap = corner.point - h;
                if (s.vertex_count == s.vertices.size() ||
                    (glm::dot(gap, corner.tangent_in) > 0.0 &&
                     glm::dot(gap, corner.tangent_out) < 0.0)) {
                    return std::nullopt;
                }
                vertex = joint;
            }
        }
        const double slack = pieces.rise_slack(pieces[next], h);
        if (!(slack >= wanted)) {
            return std::nullopt;
        }
        if (vertex) {
            s.vertices[s.vertex_count++] = *vertex;
        }
        s.slack = std::min(s.slack, slack);
        return next;
    };
    std::size_t first = at;
    std::size_t last = at;
    std::size_t count = 1;
    for (std::size_t i = 0; i < kReach && count + 1 < total; ++i) {
        const auto next = beyond(last, first, true);
        if (!next) {
            break;
        }
        last = *next;
        ++count;
    }
    for (std::size_t i = 0; i < kReach && count + 1 < total; ++i) {
        const auto next = beyond(first, last, false);
        if (!next) {
            break;
        }
        first = *next;
        ++count;
    }
    s.first_span = pieces[first].span;
    s.first_u = pieces[first].lo;
    s.last_span = pieces[last].span;
    s.last_u = pieces[last].hi;
    const double others = feet_.tree().bound_without(h, first, count);
    s.others = others * (1.0 - kMargin) - kMargin * glm::length(h);
}

}  // namespace palpate::engine
