#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/surface/surface_closest.hpp"
#include "engine/surface/surface_slide.hpp"

namespace palpate::engine {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A window reaches at most so many leaves from the foot's leaf to each side.
constexpr std::uint32_t kMaxReach = 2;

/// Strips that would leave HIP less slack than this are not added, m: four ticks of a fast hand.
constexpr double kWantedSlack = 8e-4;

/// One leaf may cost so much, or half of what is left.
constexpr Work kLeafWork = 10'000'000;
constexpr Work kPolishWork = 100'000;
constexpr Work kNodeWork = 60;   ///< a node of the tree and its boxes
constexpr Work kBoundWork = 60;  ///< a leaf's oriented box
constexpr Work kBowlWork = 200;  ///< bounds of its second derivatives
constexpr int kMaxRestarts = 64;

}  // namespace

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
    const std::uint32_t a = nodes_[at].low / across_v_;
    const std::uint32_t b = nodes_[at].low % across_v_;
    return {a / per_side_, b / per_side_, (a % per_side_ + 0.5) / per_side_,
            (b % per_side_ + 0.5) / per_side_};
}

/// Least slack of the leaves of `strip`; negative when one of them is no proven bowl.
double SurfaceFeet::strip_slack(const Window& strip, const Vec3& h, double d2) const noexcept {
    double slack = kInfinity;
    for (std::uint32_t a = strip.low_u; a < strip.high_u; ++a) {
        for (std::uint32_t b = strip.low_v; b < strip.high_v; ++b) {
            const SurfaceLeaf::Bowl bowl = leaves_[a * across_v_ + b].bowl(h, d2);
            if (!(bowl.depth > 0.0)) {
                return -1.0;
            }
            slack = std::min(slack, bowl.slack);
        }
    }
    return slack;
}

/// Nothing pulls the foot along the surface, but over an open border: with a bowl, the minimum.
/// Else the descent gave up early, and the foot proves nothing.
bool SurfaceFeet::at_rest(const SurfaceTrack& track, const Vec3& h) const noexcept {
    const SurfaceJet& j = track.jet;
    const SurfacePlace& p = track.place;
    const Vec3 r = j.point - h;
    const double rounding = 1e-12 * (glm::length(r) + surface_->size());
    const auto rests = [&](double at, const Vec3& along, bool crossable) {
        const double slope = glm::dot(r, along);
        const double still = rounding * glm::length(along);
        const bool blocked = (at == 0.0 && slope > 0.0) || (at == 1.0 && slope < 0.0);
        return std::fabs(slope) <= still || (blocked && !crossable);
    };
    SurfacePlace beyond = p;
    const bool over_u = (p.u == 0.0 || p.u == 1.0) && surface_->cross_u(beyond, p.u == 1.0);
    const bool over_v = (p.v == 0.0 || p.v == 1.0) && surface_->cross_v(beyond, p.v == 1.0);
    return rests(p.u, j.du, over_u) && rests(p.v, j.dv, over_v);
}

/// The window: the foot's leaf, then whole strips on its four sides while they are bowls. It does
/// not cross an edge where the derivative breaks: there two bowls do not make one.
void SurfaceFeet::grow(SurfaceTrack& track, const Vec3& h, double d2) const noexcept {
    const SurfacePlace& p = track.place;
    const auto leaf_of = [this](std::size_t patch, double t) {
        const auto k = static_cast<std::uint32_t>(t * per_side_);
        return static_cast<std::uint32_t>(patch) * per_side_ + std::min(k, per_side_ - 1);
    };
    const std::uint32_t a = leaf_of(p.i, p.u);
    const std::uint32_t b = leaf_of(p.j, p.v);
    Window& w = track.window;
    w = {a, a + 1, b, b + 1};
    track.slack = at_rest(track, h) ? strip_slack(w, h, d2) : -1.0;
    if (track.slack < 0.0) {
        w = {};
        return;
    }
    const auto smooth = [this](bool in_u, std::uint32_t edge) {
        return edge % per_side_ != 0 ||
               (in_u ? surface_->smooth_u(edge / per_side_) : surface_->smooth_v(edge / per_side_));
    };
    const auto add = [&](const Window& strip, std::uint32_t& side, std::uint32_t to) {
        const double slack = strip_slack(strip, h, d2);
        if (slack >= std::min(track.slack, kWantedSlack)) {
            side = to;
            track.slack = std::min(track.slack, slack);
        }
    };
    for (std::uint32_t reach = 1; reach <= kMaxReach; ++reach) {
        if (w.low_u > 0 && w.low_u + reach == a + 1 && smooth(true, w.low_u)) {
            add({w.low_u - 1, w.low_u, w.low_v, w.high_v}, w.low_u, w.low_u - 1);
        }
        if (w.high_u < across_u_ && w.high_u == a + reach && smooth(true, w.high_u)) {
            add({w.high_u, w.high_u + 1, w.low_v, w.high_v}, w.high_u, w.high_u + 1);
        }
        if (w.low_v > 0 && w.low_v + reach == b + 1 && smooth(false, w.low_v)) {
            add({w.low_u, w.high_u, w.low_v - 1, w.low_v}, w.low_v, w.low_v - 1);
        }
        if (w.high_v < across_v_ && w.high_v == b + reach && smooth(false, w.high_v)) {
            add({w.low_u, w.high_u, w.high_v, w.high_v + 1}, w.high_v, w.high_v + 1);
        }
    }
}

bool SurfaceFeet::inside(const Window& window, std::uint32_t leaf) const noexcept {
    const std::uint32_t a = leaf / across_v_;
    const std::uint32_t b = leaf % across_v_;
    return a >= window.low_u && a < window.high_u && b >= window.low_v && b < window.high_v;
}

bool SurfaceFeet::in_window(const Window& window, const SurfacePlace& p) const noexcept {
    const double a = (static_cast<double>(p.i) + p.u) * per_side_;
    const double b = (static_cast<double>(p.j) + p.v) * per_side_;
    return a >= window.low_u && a <= window.high_u && b >= window.low_v && b <= window.high_v;
}

Verdict SurfaceFeet::look_at(std::uint32_t leaf,
                             const Vec3& h,
                             double d2,
                             Work& work) const noexcept {
    const std::uint32_t a = leaf / across_v_;
    const std::uint32_t b = leaf % across_v_;
    const std::size_t i = a / per_side_;
    const std::size_t j = b / per_side_;
    const double side = 1.0 / per_side_;
    const PatchPart part{side * (a % per_side_), side * (a % per_side_ + 1), side * (b % per_side_),
                         side * (b % per_side_ + 1)};
    Work share = std::min(std::max(work / 2, Work{1}), kLeafWork);
    work -= share;
    const Verdict verdict = any_closer(*surface_, leaves_[leaf].form(), i, j, part, h, d2, share);
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
    const SurfaceSlide slide = slide_on_surface<false>(*surface_, foot.place, h, 0.0, share);
    const Vec3 r = slide.point - h;
    if (glm::dot(r, r) < foot.distance2) {
        foot.place = track.place = slide.place;
        foot.jet = track.jet = surface_->local_jet(slide.place);
        foot.distance2 = glm::dot(r, r);
    }
}

SurfaceClosest SurfaceFeet::search(SurfaceTrack& track, const Vec3& h, Work work) const noexcept {
    ++track.searches;
    SurfacePlace start = track.started ? track.place : near_place(h);
    Verdict rest;
    SurfaceFoot foot;
    for (int i = 0; i < kMaxRestarts; ++i) {
        foot = descend(*surface_, h, start, work);
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
    track.reference = h;
    track.distance = std::sqrt(foot.distance2);
    track.other = std::sqrt(rest.lower2) * (1.0 - 1e-14);
    track.certified = track.window.high_u > track.window.low_u && !rest.closer && rest.proven;
    SurfaceClosest result = answer(track, h, {foot.place, foot.jet.point});
    result.proven = rest.proven && !rest.closer;
    return result;
}

}  // namespace palpate::engine
