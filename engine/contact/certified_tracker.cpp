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

}  // namespace

CertifiedTracker::CertifiedTracker(const Outline& outline) : feet_(outline), windows_(feet_) {}

ClosestPoint CertifiedTracker::named(const TrackWindow& window,
                                     const WindowFoot& found,
                                     const Vec2& h) const noexcept {
    return found.on_seam ? feet_.at_seam(found.seam, h)
                         : feet_.named(h, found.foot, window.jet.first);
}

ClosestPoint CertifiedTracker::track(TrackState& s, const Vec2& h) const noexcept {
    const double moved2 = distance2(h, s.from);
    if (moved2 < s.slack2) {
        // distance + moved < bound, without the root of the second.
        const auto nearer = [](double distance, double way2, double bound) {
            const double spare = bound - distance;
            return spare > 0.0 && way2 < spare * spare;
        };
        WindowFoot found = windows_.follow(s.best, h);
        double distance = std::sqrt(found.foot.distance2);
        if (found.settled && s.has_rival &&
            !nearer(distance, distance2(h, s.rival_seen), s.rival_at)) {
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
        if (found.settled && nearer(distance, moved2, s.others)) {
            ++s.certified;
            return named(s.best, found, h);
        }
    }
    ++s.searched;
    return search(s, h);
}

ClosestPoint CertifiedTracker::search(TrackState& s, const Vec2& h) const noexcept {
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
    const Foot<2> foot = tree.closest_without(h, s.best.pieces);
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
