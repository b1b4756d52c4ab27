#include "engine/surface/surface_closest.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/processor.hpp"
#include "engine/base/refuse.hpp"

namespace palpate::engine {

/// Leaves are halved until the distance from the surface itself is a bowl on nearly all of them.
constexpr double kGoodBowl = 0.3;
constexpr double kGoodShare = 0.95;
constexpr std::size_t kMaxLeaves = 4096;

/// An edge that is nowhere longer than this share of the object's size is one point.
constexpr double kPoint = 1e-12;

SurfaceFeet::SurfaceFeet(std::shared_ptr<const SurfaceObject> object) : object_(std::move(object)) {
    refuse_if(!object_, "the object is null: give one of surfaces");
    const auto count = static_cast<std::uint32_t>(object_->count());
    grids_.resize(count);
    for (std::uint32_t k = 0; k < count; ++k) {
        Grid& grid = grids_[k];
        divide(k, 1);
        const auto finer = [&grid] {
            return 4 * std::size_t{grid.across_u} * grid.across_v;
        };
        while (resolved(grid) < kGoodShare &&
               finer() <= std::max(kMaxLeaves / count, kMaxLeaves / 16)) {
            divide(k, 2 * grid.per_side);
        }
        find_poles(k);
    }
    nodes_.reserve(2 * leaves_.size());
    static_cast<void>(build(0, count));
}

void SurfaceFeet::divide(std::uint32_t surface, std::uint32_t per_side) {
    const NurbsSurface& s = object_->surface(surface);
    Grid& grid = grids_[surface];
    if (per_side == 1) {
        grid.first = static_cast<std::uint32_t>(leaves_.size());
    }
    leaves_.erase(leaves_.begin() + grid.first, leaves_.end());
    cells_.resize(grid.first);
    grid.per_side = per_side;
    grid.across_u = per_side * static_cast<std::uint32_t>(s.rows());
    grid.across_v = per_side * static_cast<std::uint32_t>(s.columns());
    for (std::uint32_t a = 0; a < grid.across_u; ++a) {
        for (std::uint32_t b = 0; b < grid.across_v; ++b) {
            cells_.push_back({surface, a, b});
            PatchPart part;
            const BezierPatch& patch =
                object_->patch(middle_of(static_cast<std::uint32_t>(cells_.size() - 1), part));
            leaves_.emplace_back(patch.degree_u(), patch.degree_v(), part_of_net(patch, part),
                                 patch.polynomial());
        }
    }
}

void SurfaceFeet::find_poles(std::uint32_t surface) {
    const NurbsSurface& s = object_->surface(surface);
    const double point = kPoint * object_->size();
    for (std::size_t k = 0; k < 4 * s.rows() * s.columns(); ++k) {
        const bool across_u = k % 4 < 2;
        const double edge = k % 2 == 0 ? 0.0 : 1.0;
        const SurfacePlace middle{k / 4 / s.columns(), k / 4 % s.columns(), across_u ? edge : 0.5,
                                  across_u ? 0.5 : edge, surface};
        const BezierPatch& patch = object_->patch(middle);
        const int length = across_u ? patch.degree_v() : patch.degree_u();
        const auto at = [&](int i) {
            const Quad& c = across_u ? patch.net(edge == 0.0 ? 0 : patch.degree_u(), i)
                                     : patch.net(i, edge == 0.0 ? 0 : patch.degree_v());
            return c.xyz() / c.w();
        };
        bool one = true;
        for (int i = 1; i <= length && one; ++i) {
            one = glm::length(at(i) - at(0)) <= point;
        }
        if (one) {
            poles_.push_back({middle, across_u, object_->local_jet(middle).point});
        }
    }
}

SurfacePlace SurfaceFeet::middle_of(std::uint32_t leaf, PatchPart& part) const noexcept {
    const Cell& cell = cells_[leaf];
    const std::uint32_t per_side = grids_[cell.surface].per_side;
    const std::uint32_t a = cell.a % per_side;
    const std::uint32_t b = cell.b % per_side;
    const double side = 1.0 / per_side;
    part = {side * a, side * (a + 1), side * b, side * (b + 1)};
    return {cell.a / per_side, cell.b / per_side, (a + 0.5) / per_side, (b + 0.5) / per_side,
            cell.surface};
}

/// Share of leaves on which a point of the surface itself sees a bowl.
double SurfaceFeet::resolved(const Grid& grid) const noexcept {
    const auto first = leaves_.begin() + grid.first;
    const auto good = std::count_if(
        first, leaves_.end(), [](const SurfaceLeaf& leaf) { return leaf.quality() >= kGoodBowl; });
    return static_cast<double>(good) / static_cast<double>(leaves_.end() - first);
}

/// A node over two.
std::uint32_t SurfaceFeet::above(std::uint32_t low, std::uint32_t high, std::uint32_t index) {
    Box<3> box = nodes_[low].box;
    box.add(nodes_[high].box);
    nodes_[index] = {box, low, high};
    return index;
}

/// The surfaces from `first` to before `last`.
std::uint32_t SurfaceFeet::build(std::uint32_t first, std::uint32_t last) {
    if (last - first == 1) {
        return build(Window{first, 0, grids_[first].across_u, 0, grids_[first].across_v});
    }
    const auto index = static_cast<std::uint32_t>(nodes_.size());
    nodes_.emplace_back();
    const std::uint32_t middle = first + (last - first) / 2;
    const std::uint32_t low = build(first, middle);
    const std::uint32_t high = build(middle, last);
    return above(low, high, index);
}

std::uint32_t SurfaceFeet::build(const Window& part) {
    const auto index = static_cast<std::uint32_t>(nodes_.size());
    nodes_.emplace_back();
    const std::uint32_t size_u = part.high_u - part.low_u;
    const std::uint32_t size_v = part.high_v - part.low_v;
    if (size_u == 1 && size_v == 1) {
        const Grid& grid = grids_[part.surface];
        const std::uint32_t leaf = grid.first + part.low_u * grid.across_v + part.low_v;
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
    return above(low, high, index);
}

SurfaceClosest SurfaceFeet::closest(const Vec3& hip) const noexcept {
    SurfaceTrack fresh;
    return track(fresh, hip);
}

SurfaceClosest SurfaceFeet::track(SurfaceTrack& track, const Vec3& hip, Work work) const noexcept {
    const Vec3 h = hip - object_->origin();
    if (!(glm::dot(h, h) < 1e300)) {  // also NaN: nothing to look for, and nothing to remember
        return {.distance = std::numeric_limits<double>::infinity(), .proven = false};
    }
    if (!track.certified || !track.started) {
        return search(track, h, work);
    }
    FootPlace foot_now;
    if (!as_this_processor_can([&] { return follow(track, h, foot_now); })) {
        const SurfaceFoot foot = descend(*object_, h, track.place, work);
        track.place = foot.place;
        track.jet = foot.jet;
        foot_now = {foot.place, foot.jet.point};
        if (!at_rest(track, h)) {
            return search(track, h, work);
        }
    }
    const double distance = glm::length(foot_now.point - h);
    const double rounding = 1e-15 * (object_->size() + distance);
    const double moved = glm::length(h - track.reference);
    if (distance > track.distance + moved + rounding || !in_window(track.window, foot_now.place) ||
        distance + glm::length(h - track.searched) > track.other ||
        (moved > track.slack && !renew(track, h, distance))) {
        return search(track, h, work);
    }
    ++track.certified_calls;
    return answer(track, h, foot_now);
}

/// Newton's step from the last jet, then from new ones until a step is so small that the second
/// order of Taylor's series is exact to rounding. False at an edge of the patch, or where there is
/// no bowl.
bool SurfaceFeet::follow(SurfaceTrack& track, const Vec3& h, FootPlace& moved) const noexcept {
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
        track.jet = object_->local_jet(track.place);
    }
    return false;
}

SurfaceClosest SurfaceFeet::answer(const SurfaceTrack& track,
                                   const Vec3& h,
                                   const FootPlace& moved) const noexcept {
    const Vec3 r = moved.point - h;
    SurfaceClosest result;
    result.place = moved.place;
    result.u = object_->u_of(result.place);
    result.v = object_->v_of(result.place);
    result.point = moved.point + object_->origin();
    result.distance = glm::length(r);
    // On an edge, and beyond an open border, the pull has a part along the surface.
    const Vec3 normal = object_->normal_at(track.place, track.jet);
    const double above = -glm::dot(r, normal);
    const Vec3 along = r + above * normal;
    const bool beyond = glm::length(along) > 1e-6 * result.distance + 1e-14 * object_->size();
    result.inside = beyond ? object_->behind_edge(result.place, -r) : above < 0.0;
    return result;
}

}  // namespace palpate::engine
