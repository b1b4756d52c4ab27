#include "engine/surface/surface_closest.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace palpate::engine {
namespace {

/// Leaves are halved until the distance from the surface itself is a bowl on nearly all of them.
constexpr double kGoodBowl = 0.3;
constexpr double kGoodShare = 0.95;
constexpr std::size_t kMaxLeaves = 4096;

}  // namespace

SurfaceFeet::SurfaceFeet(std::shared_ptr<const NurbsSurface> surface)
    : surface_(std::move(surface)) {
    if (!surface_) {
        throw std::invalid_argument("the surface is null: give a surface");
    }
    divide(1);
    while (resolved() < kGoodShare && 4 * leaves_.size() <= kMaxLeaves) {
        divide(2 * per_side_);
    }
    nodes_.reserve(2 * leaves_.size());
    static_cast<void>(build({0, across_u_, 0, across_v_}));
}

void SurfaceFeet::divide(std::uint32_t per_side) {
    per_side_ = per_side;
    across_u_ = per_side * static_cast<std::uint32_t>(surface_->rows());
    across_v_ = per_side * static_cast<std::uint32_t>(surface_->columns());
    leaves_.clear();
    leaves_.reserve(std::size_t{across_u_} * across_v_);
    for (std::uint32_t a = 0; a < across_u_; ++a) {
        for (std::uint32_t b = 0; b < across_v_; ++b) {
            const BezierPatch& patch = surface_->patch(a / per_side, b / per_side);
            const double side = 1.0 / per_side;
            const PatchPart part{side * (a % per_side), side * (a % per_side + 1),
                                 side * (b % per_side), side * (b % per_side + 1)};
            leaves_.emplace_back(patch.degree_u(), patch.degree_v(), part_of_net(patch, part),
                                 patch.polynomial());
        }
    }
}

/// Share of leaves on which a point of the surface itself sees a bowl.
double SurfaceFeet::resolved() const noexcept {
    const auto good = std::count_if(leaves_.begin(), leaves_.end(), [](const SurfaceLeaf& leaf) {
        return leaf.quality() >= kGoodBowl;
    });
    return static_cast<double>(good) / static_cast<double>(leaves_.size());
}

std::uint32_t SurfaceFeet::build(const Window& part) {
    const auto index = static_cast<std::uint32_t>(nodes_.size());
    nodes_.emplace_back();
    const std::uint32_t size_u = part.high_u - part.low_u;
    const std::uint32_t size_v = part.high_v - part.low_v;
    if (size_u == 1 && size_v == 1) {
        const std::uint32_t leaf = part.low_u * across_v_ + part.low_v;
        nodes_[index] = {leaves_[leaf].box(), leaf, 0};
        return index;
    }
    Window first = part;
    Window second = part;
    if (size_u >= size_v) {
        first.high_u = second.low_u = part.low_u + size_u / 2;
    } else {
        first.high_v = second.low_v = part.low_v + size_v / 2;
    }
    const std::uint32_t low = build(first);
    const std::uint32_t high = build(second);
    Box<3> box = nodes_[low].box;
    box.add(nodes_[high].box);
    nodes_[index] = {box, low, high};
    return index;
}

SurfaceClosest SurfaceFeet::closest(const Vec3& hip) const noexcept {
    SurfaceTrack fresh;
    return track(fresh, hip);
}

SurfaceClosest SurfaceFeet::track(SurfaceTrack& track, const Vec3& hip, Work work) const noexcept {
    const Vec3 h = hip - surface_->origin();
    if (!(glm::dot(h, h) < 1e300)) {  // also NaN: nothing to look for, and nothing to remember
        return {.distance = std::numeric_limits<double>::infinity(), .proven = false};
    }
    if (!track.certified || !track.started) {
        return search(track, h, work);
    }
    const double moved = glm::length(h - track.reference);
    if (moved > track.slack) {
        return search(track, h, work);
    }
    Moved foot_now;
    if (!follow(track, h, foot_now)) {
        const SurfaceFoot foot = descend(*surface_, h, track.place, work);
        track.place = foot.place;
        track.jet = foot.jet;
        foot_now = {foot.place, foot.jet.point};
        if (!at_rest(track, h)) {
            return search(track, h, work);
        }
    }
    const double distance = glm::length(foot_now.point - h);
    const double rounding = 1e-15 * (surface_->size() + distance);
    if (distance > track.distance + moved + rounding || distance + moved > track.other ||
        !in_window(track.window, foot_now.place)) {
        return search(track, h, work);
    }
    ++track.certified_calls;
    return answer(track, h, foot_now);
}

/// Newton's step from the last jet, then from new ones until a step is so small that the second
/// order of Taylor's series is exact to rounding. False at an edge of the patch, or where there is
/// no bowl.
bool SurfaceFeet::follow(SurfaceTrack& track, const Vec3& h, Moved& moved) const noexcept {
    for (int i = 0; i < 6; ++i) {
        const SurfaceJet& j = track.jet;
        const FootSlope g(j, j.point - h);
        if (!g.bowl()) {
            return false;
        }
        const double inverse = 1.0 / (g.uu * g.vv - g.uv * g.uv);
        const double du = (g.uv * g.v - g.vv * g.u) * inverse;
        const double dv = (g.uv * g.u - g.uu * g.v) * inverse;
        const double u = track.place.u + du;
        const double v = track.place.v + dv;
        if (!(u >= 0.0 && u <= 1.0 && v >= 0.0 && v <= 1.0)) {
            return false;
        }
        if (std::fabs(du) + std::fabs(dv) <= 1e-7) {
            moved.place = track.place;
            moved.place.u = u;
            moved.place.v = v;
            moved.point = j.point + (du * (j.du + (0.5 * du) * j.duu + dv * j.duv) +
                                     dv * (j.dv + (0.5 * dv) * j.dvv));
            return true;
        }
        track.place.u = u;
        track.place.v = v;
        track.jet = surface_->local_jet(track.place);
    }
    return false;
}

SurfaceClosest SurfaceFeet::answer(const SurfaceTrack& track,
                                   const Vec3& h,
                                   const Moved& moved) const noexcept {
    const Vec3 r = moved.point - h;
    SurfaceClosest result;
    result.place = moved.place;
    result.u = surface_->u_of(result.place);
    result.v = surface_->v_of(result.place);
    result.point = moved.point + surface_->origin();
    result.distance = glm::length(r);
    // Beyond an open border the pull has a part along the surface.
    const Vec3 normal = surface_->normal_at(track.place, track.jet);
    const double above = -glm::dot(r, normal);
    const Vec3 along = r + above * normal;
    const bool beyond = glm::length(along) > 1e-6 * result.distance + 1e-14 * surface_->size();
    result.inside = above < 0.0 && !beyond;
    return result;
}

}  // namespace palpate::engine
