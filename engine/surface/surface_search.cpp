#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/surface/surface_closest.hpp"
#include "engine/surface/surface_slide.hpp"

namespace palpate::engine {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A window reaches at most so many leaves from the foot's leaf to each side.
constexpr std::uint32_t kMaxReach = 2;

/// Strips that would leave HIP less slack than this are not added, m: four ticks of a fast hand.
constexpr double kWantedSlack = 8e-4;

/// A window that leaves less is not renewed but found anew, m.
constexpr double kRenewedSlack = 3e-4;

/// One leaf may cost so much, or half of what is left.
constexpr Work kLeafWork = 10'000'000;
constexpr Work kPolishWork = 100'000;
constexpr Work kNodeWork = 60;   ///< a node of the tree and its boxes
constexpr Work kBoundWork = 60;  ///< a leaf's oriented box
constexpr Work kBowlWork = 200;  ///< bounds of its second derivatives
constexpr int kMaxRestarts = 64;

/// So near to a pole, as a share of the size, a difference of squared distances is lost in the
/// rounding of a DistanceForm; then so many headings out of it are tried on each patch.
constexpr double kBesidePole = 1e-5;
constexpr int kHeadings = 8;

/// Down the tree to the leaf whose box seems nearest.
SurfacePlace SurfaceFeet::near_place(const Vec3& h) const noexcept {
    std::uint32_t at = 0;
    while (nodes_[at].high != 0) {
        const Box<3>& a = nodes_[nodes_[at].low].box;
        const Box<3>& b = nodes_[nodes_[at].high].box;
        const double to_a = a.distance2(h);
        const double to_b = b.distance2(h);
        const Vec3 gap_a = a.middle() - h;
        const Vec3 gap_b = b.middle() - h;
        const bool tie = to_a == to_b;
        const bool first = tie ? glm::dot(gap_a, gap_a) <= glm::dot(gap_b, gap_b) : to_a < to_b;
        at = first ? nodes_[at].low : nodes_[at].high;
    }
    PatchPart part;
    return middle_of(nodes_[at].low, part);
}

/// Least slack of the leaves of `strip`; negative when one of them is no proven bowl.
double SurfaceFeet::strip_slack(const Window& strip, const Vec3& h, double d2) const noexcept {
    double slack = kInfinity;
    const Grid& grid = grids_[strip.surface];
    for (std::uint32_t a = strip.low_u; a < strip.high_u; ++a) {
        for (std::uint32_t b = strip.low_v; b < strip.high_v; ++b) {
            const SurfaceLeaf::Bowl bowl = leaves_[grid.first + a * grid.across_v + b].bowl(h, d2);
            if (!(bowl.depth > 0.0)) {
                return -1.0;
            }
            slack = std::min(slack, bowl.slack);
        }
    }
    return slack;
}

/// With a foot at rest in it, the window is one bowl from here on, too: what lies outside need not
/// be looked at again.
bool SurfaceFeet::renew(SurfaceTrack& track, const Vec3& h, double distance) const noexcept {
    const double slack = strip_slack(track.window, h, distance * distance);
    if (slack < kRenewedSlack) {
        return false;
    }
    track.reference = h;
    track.distance = distance;
    track.slack = slack;
    return true;
}

/// Nothing pulls the foot along the surface, but over an open border: with a bowl, the minimum.
/// Else the descent gave up early, and the foot proves nothing.
bool SurfaceFeet::at_rest(const SurfaceTrack& track, const Vec3& h) const noexcept {
    const SurfaceJet& j = track.jet;
    const SurfacePlace& p = track.place;
    const Vec3 r = j.point - h;
    const double rounding = 1e-12 * (glm::length(r) + object_->size());
    const auto rests = [&](double at, const Vec3& along, bool leads_on) {
        const double slope = glm::dot(r, along);
        const double still = rounding * glm::length(along);
        const bool blocked = (at == 0.0 && slope > 0.0) || (at == 1.0 && slope < 0.0);
        return std::fabs(slope) <= still || (blocked && !leads_on);
    };
    const auto crossable = [&](bool in_u, double at) {
        SurfacePlace beyond = p;
        SurfaceHeading way{in_u, at == 1.0};
        return (at == 0.0 || at == 1.0) && object_->cross(beyond, way);
    };
    return rests(p.u, j.du, crossable(true, p.u)) && rests(p.v, j.dv, crossable(false, p.v));
}

/// The window: the foot's leaf, then whole strips on its four sides while they are bowls. It does
/// not cross an edge where the derivative breaks: there two bowls do not make one.
void SurfaceFeet::grow(SurfaceTrack& track, const Vec3& h, double d2) const noexcept {
    const SurfacePlace& p = track.place;
    const Grid& grid = grids_[p.surface];
    const NurbsSurface& surface = object_->surface_of(p);
    const auto leaf_of = [&grid](std::size_t patch, double t) {
        const auto k = static_cast<std::uint32_t>(t * grid.per_side);
        return static_cast<std::uint32_t>(patch) * grid.per_side + std::min(k, grid.per_side - 1);
    };
    const std::uint32_t a = leaf_of(p.i, p.u);
    const std::uint32_t b = leaf_of(p.j, p.v);
    Window& w = track.window;
    w = {static_cast<std::uint32_t>(p.surface), a, a + 1, b, b + 1};
    track.slack = at_rest(track, h) ? strip_slack(w, h, d2) : -1.0;
    if (track.slack < 0.0) {
        w = {};
        return;
    }
    const auto smooth = [&](bool in_u, std::uint32_t edge) {
        return edge % grid.per_side != 0 || surface.smooth(in_u, edge / grid.per_side);
    };
    // HIP has no more room than to where something outside of the window is as near as the foot.
    const double at_u = (static_cast<double>(p.i) + p.u) * grid.per_side;
    const double at_v = (static_cast<double>(p.j) + p.v) * grid.per_side;
    const double leaf_u = glm::length(track.jet.du) / grid.per_side;
    const double leaf_v = glm::length(track.jet.dv) / grid.per_side;
    const double d = std::sqrt(d2);
    const auto add = [&](const Window& strip, std::uint32_t& side, std::uint32_t to, double edge) {
        const double slack = strip_slack(strip, h, d2);
        const double room = std::sqrt(d2 + edge * edge) - d;
        if (slack >= std::min({track.slack, kWantedSlack, room})) {
            side = to;
            track.slack = std::min(track.slack, slack);
        }
    };
    for (std::uint32_t reach = 1; reach <= kMaxReach; ++reach) {
        if (w.low_u > 0 && w.low_u + reach == a + 1 && smooth(true, w.low_u)) {
            add({w.surface, w.low_u - 1, w.low_u, w.low_v, w.high_v}, w.low_u, w.low_u - 1,
                leaf_u * (at_u - w.low_u));
        }
        if (w.high_u < grid.across_u && w.high_u == a + reach && smooth(true, w.high_u)) {
            add({w.surface, w.high_u, w.high_u + 1, w.low_v, w.high_v}, w.high_u, w.high_u + 1,
                leaf_u * (w.high_u - at_u));
        }
        if (w.low_v > 0 && w.low_v + reach == b + 1 && smooth(false, w.low_v)) {
            add({w.surface, w.low_u, w.high_u, w.low_v - 1, w.low_v}, w.low_v, w.low_v - 1,
                leaf_v * (at_v - w.low_v));
        }
        if (w.high_v < grid.across_v && w.high_v == b + reach && smooth(false, w.high_v)) {
            add({w.surface, w.low_u, w.high_u, w.high_v, w.high_v + 1}, w.high_v, w.high_v + 1,
                leaf_v * (w.high_v - at_v));
        }
    }
}

bool SurfaceFeet::inside(const Window& window, std::uint32_t leaf) const noexcept {
    const Cell& c = cells_[leaf];
    return c.surface == window.surface && c.a >= window.low_u && c.a < window.high_u &&
           c.b >= window.low_v && c.b < window.high_v;
}

bool SurfaceFeet::in_window(const Window& window, const SurfacePlace& p) const noexcept {
    const std::uint32_t per_side = grids_[p.surface].per_side;
    const double a = (static_cast<double>(p.i) + p.u) * per_side;
    const double b = (static_cast<double>(p.j) + p.v) * per_side;
    return p.surface == window.surface && a >= window.low_u && a <= window.high_u &&
           b >= window.low_v && b <= window.high_v;
}

Verdict SurfaceFeet::look_at(std::uint32_t leaf,
                             const Vec3& h,
                             double d2,
                             Work& work) const noexcept {
    PatchPart part;
    const SurfacePlace patch = middle_of(leaf, part);
    Work share = std::min(std::max(work / 2, Work{1}), kLeafWork);
    work -= share;
    const Verdict verdict = any_closer(*object_, leaves_[leaf].form(), patch, part, h, d2, share);
    work += share;
    return verdict;
}

/// Everything outside of the window, nearest boxes first: something closer than d2, or the lower
/// bound of all of it in `lower2`.
Verdict SurfaceFeet::look_around(SurfaceTrack& track,
                                 const Vec3& h,
                                 double d2,
                                 Work& work) const noexcept {
    struct Waiting {
        std::uint32_t node;
        double bound2;
    };
    std::array<Waiting, 64> stack;  // one sibling waits on each level; 2^32 leaves are 64 levels
    std::size_t top = 0;
    Verdict all{.lower2 = kInfinity};
    stack[top++] = {0, nodes_[0].box.distance2(h)};
    while (top > 0) {
        const Waiting next = stack[--top];
        work -= kNodeWork;
        if (work < 0) {
            all.proven = false;
            break;
        }
        if (next.bound2 >= all.lower2) {
            continue;
        }
        const Node& node = nodes_[next.node];
        if (node.high != 0) {
            Waiting a{node.low, nodes_[node.low].box.distance2(h)};
            Waiting b{node.high, nodes_[node.high].box.distance2(h)};
            if (a.bound2 < b.bound2) {
                std::swap(a, b);
            }
            stack[top++] = a;
            stack[top++] = b;
            continue;
        }
        if (inside(track.window, node.low)) {
            continue;
        }
        work -= kBoundWork;
        const double bound2 = leaves_[node.low].bound2(h);
        if (bound2 >= d2) {
            all.lower2 = std::min(all.lower2, bound2);
            continue;
        }
        const Verdict leaf = look_at(node.low, h, d2, work);
        all.proven = all.proven && leaf.proven;
        if (leaf.closer) {
            return leaf;
        }
        all.lower2 = std::min(all.lower2, std::max(leaf.lower2, bound2));
    }
    return all;
}

/// In bent valleys a descent may stop early; the walk of a god-object without friction goes on.
void SurfaceFeet::polish(SurfaceTrack& track,
                         const Vec3& h,
                         SurfaceFoot& foot,
                         Work& work) const noexcept {
    const Work share = std::min(work / 2, kPolishWork);
    work -= share;
    const SurfaceSlide slide = slide_on_surface(*object_, foot.place, h, 0.0, share);
    const Vec3 r = slide.point - h;
    if (glm::dot(r, r) < foot.distance2) {
        foot.place = track.place = slide.place;
        foot.jet = track.jet = object_->local_jet(slide.place);
        foot.distance2 = glm::dot(r, r);
    }
}

/// All of a pole's edge is one point, at which a descent rests on every heading but those that lead
/// towards h: from each, where the tangent there is nearest to h, down. @return something is closer
bool SurfaceFeet::leave(const Pole& pole,
                        const Vec3& h,
                        SurfaceFoot& foot,
                        Work& work) const noexcept {
    bool closer = false;
    for (int k = 0; k <= kHeadings; ++k) {
        SurfacePlace start = pole.place;
        (pole.across_u ? start.v : start.u) = static_cast<double>(k) / kHeadings;
        const SurfaceJet jet = object_->local_jet(start);
        const Vec3& along = pole.across_u ? jet.du : jet.dv;
        double& at = pole.across_u ? start.u : start.v;
        const double way = glm::dot(h - jet.point, along) / glm::dot(along, along);
        if (!(at == 0.0 ? way > 0.0 : way < 0.0)) {
            continue;
        }
        at = std::clamp(at + way, 0.0, 1.0);
        const SurfaceFoot next = descend(*object_, h, start, work);
        if (next.distance2 < foot.distance2) {
            foot = next;
            closer = true;
        }
    }
    return closer;
}

SurfaceClosest SurfaceFeet::search(SurfaceTrack& track, const Vec3& h, Work work) const noexcept {
    ++track.searches;
    SurfacePlace start = track.started ? track.place : near_place(h);
    Verdict rest;
    SurfaceFoot foot;
    for (int i = 0; i < kMaxRestarts; ++i) {
        foot = descend(*object_, h, start, work);
        track.place = foot.place;
        track.jet = foot.jet;
        if (!at_rest(track, h)) {
            polish(track, h, foot, work);
        }
        grow(track, h, foot.distance2);
        work -= 25 * kBowlWork;  // (2 kMaxReach + 1)^2 leaves at most
        rest = look_around(track, h, foot.distance2, work);
        if (!rest.closer) {
            break;
        }
        start = rest.place;
    }
    track.started = true;
    track.reference = track.searched = h;
    track.distance = std::sqrt(foot.distance2);
    track.other = std::sqrt(rest.lower2) * (1.0 - 1e-14);
    track.certified = track.window.high_u > track.window.low_u && !rest.closer && rest.proven;
    for (const Pole& pole : poles_) {
        if (glm::length(h - pole.point) < kBesidePole * object_->size() &&
            leave(pole, h, foot, work)) {
            track.place = foot.place;
            track.jet = foot.jet;
            track.distance = std::sqrt(foot.distance2);
            track.certified = false;
        }
    }
    SurfaceClosest result = answer(track, h, {foot.place, foot.jet.point});
    result.proven = rest.proven && !rest.closer;
    return result;
}

}  // namespace palpate::engine
