#include "engine/contact/certified_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace palpate::engine {
namespace {

/// Rounding of distances in a certificate, relative to the lengths in it.
constexpr double kMargin = 1e-14;

/// A second stretch of the outline that comes this near to the first, m, is followed as well: a
/// hand at 0.1 m/s would otherwise ask for a search within 40 ticks, and beside the medial axis on
/// each.
constexpr double kRivalry = 0.004;

/// Least slack of a rival's window, m, for it to be worth following.
constexpr double kRivalSlack = 0.0005;

double distance2(const Vec2& a, const Vec2& b) noexcept {
    const Vec2 way = a - b;
    return glm::dot(way, way);
}

/// A lower bound of a distance, with room for rounding.
double safe(double bound, const Vec2& h) noexcept {
    return bound * (1.0 - kMargin) - kMargin * glm::length(h);
}

/// distance + moved < bound, without the root of the second.
bool nearer(double distance, double moved2, double bound) noexcept {
    const double spare = bound - distance;
    return spare > 0.0 && moved2 < spare * spare;
}

}  // namespace

CertifiedTracker::CertifiedTracker(const Outline& outline) : feet_(outline), windows_(feet_) {}

ClosestPoint CertifiedTracker::track(TrackState& s, const Vec2& h) const noexcept {
    const Outline& outline = feet_.outline();
    if (const Arc* arc = outline.arc(s.best.span)) {
        return track_apart(*arc, s, h);
    }
    const RationalBezier<2>& span = outline.spans()[s.best.span];
    return span.is_its_taylor_series() ? track_on(Cubic{span}, s, h) : track_apart(span, s, h);
}

/// Apart, so that cubics have all registers.
template <class Curve>
ClosestPoint CertifiedTracker::track_apart(const Curve& curve,
                                           TrackState& s,
                                           const Vec2& h) const noexcept {
    return track_on(curve, s, h);
}

/// Mostly the foot settles amid its span, the rival is far, and the certificate holds.
template <class Curve>
inline ClosestPoint CertifiedTracker::track_on(const Curve& curve,
                                               TrackState& s,
                                               const Vec2& h) const noexcept {
    const double moved2 = distance2(h, s.from);
    if (!(moved2 < s.slack2)) {
        return search(s, h);
    }
    PairFoot foot;
    if (!windows_.glide(curve, s.best, h, foot)) {
        return rest(s, h);
    }
    const std::size_t span = s.best.span;
    const double distance = std::sqrt(foot.distance2);
    if (!feet_.amid(span, foot.u) || !nearer(distance, moved2, s.others) ||
        rival_is_due(s, distance, h)) {
        return judge(s, {.settled = true, .foot = foot.on(span)}, h);
    }
    ++s.certified;
    return {.place = {.on_seam = false, .index = span, .parameter = foot.u},
            .point = Vec2{foot.point[0], foot.point[1]},
            .distance = distance,
            .inside = cross(pair(s.best.jet.first), pair(h) - foot.point) < 0.0};
}

[[gnu::noinline]] ClosestPoint CertifiedTracker::rest(TrackState& s, const Vec2& h) const noexcept {
    return judge(s, windows_.rest(s.best, h), h);
}

/// The rival may have come nearer than the foot since it was followed last.
bool CertifiedTracker::rival_is_due(const TrackState& s, double distance, const Vec2& h) noexcept {
    return s.has_rival && !nearer(distance, distance2(h, s.rival_seen), s.rival_at);
}

/// What was found in the window of the best is the answer, or that of the rival, or a search has to
/// say.
[[gnu::noinline]] ClosestPoint CertifiedTracker::judge(TrackState& s,
                                                       const WindowFoot& best,
                                                       const Vec2& h) const noexcept {
    WindowFoot found = best;
    double distance = std::sqrt(found.foot.distance2);
    if (found.settled && rival_is_due(s, distance, h)) {
        const WindowFoot other = windows_.follow(s.rival, h);
        found.settled = other.settled;
        double beyond = std::sqrt(other.foot.distance2);
        if (beyond < distance) {
            std::swap(s.best, s.rival);
            std::swap(distance, beyond);
            found = other;
        }
        s.rival_seen = h;
        s.rival_at = safe(beyond, h);
    }
    if (found.settled && nearer(distance, distance2(h, s.from), s.others)) {
        ++s.certified;
        return found.on_seam ? feet_.at_seam(found.seam, h)
                             : feet_.named(h, found.foot, s.best.jet.first);
    }
    return search(s, h);
}

ClosestPoint CertifiedTracker::search(TrackState& s, const Vec2& h) const noexcept {
    ++s.searched;
    const PieceTree<2>& tree = feet_.tree();
    const Foot<2> foot = tree.closest(h);
    const double distance = std::sqrt(foot.distance2);
    s.from = h;
    const double slack = windows_.open(s.best, foot, h, {});
    s.slack2 = slack > 0.0 ? slack * slack : 0.0;
    s.has_rival = false;
    if (slack > 0.0) {
        s.others = safe(tree.bound_without(h, s.best.pieces), h);
        if (s.others - distance < kRivalry) {
            open_rival(s, h);
        }
    }
    return feet_.named(h, foot, s.best.jet.first);
}

/// The nearest foot outside the first window gets a window of its own.
void CertifiedTracker::open_rival(TrackState& s, const Vec2& h) const noexcept {
    const PieceTree<2>& tree = feet_.tree();
    const Foot<2> foot = tree.closest(h, s.best.pieces);
    if (!(foot.distance2 < std::numeric_limits<double>::infinity())) {
        return;
    }
    const double slack = windows_.open(s.rival, foot, h, s.best.pieces);
    if (!(slack > kRivalSlack)) {
        return;
    }
    s.has_rival = true;
    s.slack2 = std::min(s.slack2, slack * slack);
    s.rival_seen = h;
    s.rival_at = safe(std::sqrt(foot.distance2), h);
    s.others = safe(tree.bound_without(h, s.best.pieces, s.rival.pieces), h);
}

}  // namespace palpate::engine
