#include "engine/surface/surface_object.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/base/refuse.hpp"
#include "engine/math/elementary.hpp"
#include "engine/surface/surface_border.hpp"

namespace palpate::engine {
namespace {

/// Borders that are closer than this share of the size were meant to be one.
constexpr double kNearly = 1e-3;

std::uint8_t side_of(const SurfaceHeading& way) noexcept {
    return static_cast<std::uint8_t>((way.in_u ? 0 : 2) + (way.forward ? 1 : 0));
}

bool open(const NurbsSurface& s, int side) noexcept {
    const bool in_u = side < 2;
    return !s.closed(in_u) && !s.pole(in_u, side % 2 == 1);
}

/// A part of one border lies on the other.
bool runs_along(const SurfaceBorder& a, const SurfaceBorder& b, double near) {
    constexpr int kLooks = 16;
    int on = 0;
    for (int k = 1; k < kLooks; ++k) {
        const Vec3 p = a.at(static_cast<double>(k) / kLooks);
        on = b.box().distance2(p) <= near * near && b.distance(p) <= near ? on + 1 : 0;
        if (on == 3) {
            return true;
        }
    }
    return false;
}

/// Their boxes are farther apart than `near` m.
bool far_apart(const SurfaceBorder& a, const SurfaceBorder& b, double near) {
    const Vec3 gap =
        glm::max(glm::max(a.box().low - b.box().high, b.box().low - a.box().high), Vec3{});
    return glm::dot(gap, gap) > near * near;
}

/// One is the other within `same` m: as it runs, or reversed (true).
std::optional<bool> joined_as(const SurfaceBorder& a, const SurfaceBorder& b, double same) {
    for (const bool reversed : {false, true}) {
        if (!far_apart(a, b, same) && glm::length(a.at(0.0) - b.at(reversed ? 1.0 : 0.0)) <= same &&
            same_curve(a, b, reversed, same)) {
            return reversed;
        }
    }
    return std::nullopt;
}

bool same_breaks(const SurfaceBorder& a, const SurfaceBorder& b, bool reversed) {
    std::vector<double> others = b.breaks();
    if (reversed) {
        std::reverse(others.begin(), others.end());
        std::transform(others.begin(), others.end(), others.begin(),
                       [](double s) { return 1.0 - s; });
    }
    return std::equal(a.breaks().begin(), a.breaks().end(), others.begin(), others.end(),
                      [](double s, double t) { return std::fabs(s - t) < 1e-13; });
}

/// Two borders that are not joined were not meant to be.
/// @param same  what joins, m @param near  what is nearer was meant to be one, m
void check_apart(const SurfaceBorder& a, const SurfaceBorder& b, double same, double near) {
    const double gap = std::min(sampled_gap(a, b, false), sampled_gap(a, b, true));
    refuse_if(gap <= near,
              "{} and {} are up to {:.9g} m apart: give both the same control points, weights and "
              "knots (up to direction), within {:.9g} m, or leave more than {:.9g} m between them",
              a.name(), b.name(), gap, same, near);
    refuse_if(runs_along(a, b, 10.0 * same),
              "{} runs along {}, but not from end to end at the same pace: cut the longer surface "
              "where the other ends, and give both borders the same weights and knots",
              a.name(), b.name());
}

void check_corners(const SurfaceObject& object) {
    for (std::size_t k = 0; k < object.count(); ++k) {
        const NurbsSurface& s = object.surface(k);
        for (int corner = 0; corner < 4; ++corner) {
            SurfacePlace p{
                .u = corner % 2 == 0 ? 0.0 : 1.0, .v = corner < 2 ? 0.0 : 1.0, .surface = k};
            p.i = corner % 2 == 0 ? 0 : s.rows() - 1;
            p.j = corner < 2 ? 0 : s.columns() - 1;
            refuse_if(object.around(p).full,
                      "more than {} patches meet at a corner of surface {}: give fewer",
                      SurfaceObject::kMaxAround, k + 1);
        }
    }
}

}  // namespace

SurfaceObject::SurfaceObject(std::vector<std::shared_ptr<const NurbsSurface>> surfaces)
    : surfaces_(std::move(surfaces)) {
    refuse_if(surfaces_.empty(), "an object has no surface: give at least one");
    for (const auto& surface : surfaces_) {
        refuse_if(!surface, "the surface is null: give a surface");
    }
    origin_ = surfaces_[0]->origin();
    size_ = surfaces_[0]->size();
    if (surfaces_.size() == 1) {
        return;
    }
    const auto box = [](const NurbsSurface& s) {
        return Box<3>{s.origin() + s.box().low, s.origin() + s.box().high};
    };
    Box<3> all = box(*surfaces_[0]);
    for (const auto& surface : surfaces_) {
        all.add(box(*surface));
    }
    origin_ = all.middle();
    size_ = glm::length(all.size());
    for (auto& surface : surfaces_) {
        surface = std::make_shared<const NurbsSurface>(surface->about(origin_));
    }
    join_borders();
}

void SurfaceObject::join_borders() {
    joins_.resize(4 * surfaces_.size());
    std::vector<SurfaceBorder> borders;
    for (std::size_t k = 0; k < surfaces_.size(); ++k) {
        for (std::uint8_t side = 0; side < 4; ++side) {
            if (open(*surfaces_[k], side)) {
                borders.emplace_back(*surfaces_[k], k, side);
            }
        }
    }
    const double same = kJoined * size_;
    const auto of = [this](const SurfaceBorder& b) -> Join& {
        return joins_[4 * b.surface() + b.side()];
    };
    for (std::size_t m = 0; m < borders.size(); ++m) {
        for (std::size_t n = m + 1; n < borders.size(); ++n) {
            const SurfaceBorder& a = borders[m];
            const SurfaceBorder& b = borders[n];
            // Within a surface: closed or not, as the surface says.
            const auto reversed = a.surface() == b.surface() ? std::nullopt : joined_as(a, b, same);
            if (!reversed) {
                continue;
            }
            refuse_if(of(a).joined || of(b).joined,
                      "{} has more than one neighbour: give each border at most one, so that the "
                      "surface has one outside",
                      (of(a).joined ? a : b).name());
            refuse_if((a.counter_clockwise() == b.counter_clockwise()) != *reversed,
                      "{} and {} are one, but the outward normals lie on different sides of it: "
                      "give the rows of points of one surface in the other order",
                      a.name(), b.name());
            const bool pieces = same_breaks(a, b, *reversed);
            of(a) = {true, *reversed, pieces, b.side(), b.surface()};
            of(b) = {true, *reversed, pieces, a.side(), a.surface()};
        }
    }
    const double near = kNearly * size_;
    for (const SurfaceBorder& a : borders) {
        for (const SurfaceBorder& b : borders) {
            if (a.surface() != b.surface() && !of(a).joined && !of(b).joined &&
                !far_apart(a, b, near)) {
                check_apart(a, b, same, near);
            }
        }
    }
    check_corners(*this);
}

bool SurfaceObject::cross(SurfacePlace& p, SurfaceHeading& way) const noexcept {
    const NurbsSurface& s = surface_of(p);
    if (s.cross(p, way)) {
        return true;
    }
    const std::uint8_t side = side_of(way);
    if (joins_.empty() || !joins_[4 * p.surface + side].joined) {
        return false;
    }
    const Join& join = joins_[4 * p.surface + side];
    const NurbsSurface& next = *surfaces_[join.surface];
    std::size_t k = way.in_u ? p.j : p.i;
    double t = way.in_u ? p.v : p.u;
    const bool lands_in_u = join.side < 2;
    const KnotVector& to = lands_in_u ? next.knots_v() : next.knots_u();
    if (join.same_pieces) {
        k = join.reversed ? to.intervals().size() - 1 - k : k;
        t = join.reversed ? 1.0 - t : t;
    } else {
        const KnotVector& from = way.in_u ? s.knots_v() : s.knots_u();
        const double at = way.in_u ? s.v_of(p) : s.u_of(p);
        const double share = (at - from.front()) / (from.back() - from.front());
        const double whole = to.back() - to.front();
        const double there = join.reversed ? to.back() - share * whole : to.front() + share * whole;
        k = to.interval_of(there);
        const KnotVector::Interval& piece = to.intervals()[k];
        t = snapped(std::clamp((there - piece.lo) / (piece.hi - piece.lo), 0.0, 1.0));
    }
    const bool first = join.side % 2 == 0;
    const double edge = first ? 0.0 : 1.0;
    p.surface = join.surface;
    p.i = !lands_in_u ? k : first ? 0 : next.rows() - 1;
    p.j = lands_in_u ? k : first ? 0 : next.columns() - 1;
    p.u = lands_in_u ? edge : t;
    p.v = lands_in_u ? t : edge;
    way = {lands_in_u, first};
    return true;
}

bool SurfaceObject::pole(bool in_u, const SurfacePlace& p) const noexcept {
    const NurbsSurface& s = surface_of(p);
    const double t = in_u ? p.u : p.v;
    const std::size_t k = in_u ? p.i : p.j;
    return (t == 0.0 && k == 0 && s.pole(in_u, false)) ||
           (t == 1.0 && k + 1 == (in_u ? s.rows() : s.columns()) && s.pole(in_u, true));
}

SurfaceObject::Around SurfaceObject::around(const SurfacePlace& p) const noexcept {
    Around all;
    const auto add = [&all](const SurfacePlace& q) {
        for (std::size_t k = 0; k < all.count; ++k) {
            const SurfacePlace& o = all.places[k];
            if (o.surface == q.surface && o.i == q.i && o.j == q.j &&
                std::fabs(o.u - q.u) + std::fabs(o.v - q.v) < 1e-9) {
                return;
            }
        }
        all.full = all.full || all.count == kMaxAround;
        if (!all.full) {
            all.places[all.count++] = q;
        }
    };
    add(p);
    for (std::size_t k = 0; k < all.count; ++k) {
        const SurfacePlace at = all.places[k];
        for (const bool in_u : {true, false}) {
            const double t = in_u ? at.u : at.v;
            if (!at_end(t)) {
                continue;
            }
            SurfacePlace next = at;
            if (pole(in_u, at)) {  // round it: to both of its ends
                all.pole = true;
                const NurbsSurface& s = surface_of(at);
                (in_u ? next.j : next.i) = 0;
                (in_u ? next.v : next.u) = 0.0;
                add(next);
                (in_u ? next.j : next.i) = (in_u ? s.columns() : s.rows()) - 1;
                (in_u ? next.v : next.u) = 1.0;
                add(next);
                continue;
            }
            SurfaceHeading way{in_u, t == 1.0};
            if (cross(next, way)) {
                add(next);
            } else {
                all.open = true;
            }
        }
    }
    return all;
}

bool SurfaceObject::behind_edge(const SurfacePlace& p, const Vec3& r) const noexcept {
    constexpr double kHalfTurn = 3.14159265358979323846;
    const Around all = around(p);
    if (all.open || all.pole) {
        return false;
    }
    Vec3 sum{};
    for (std::size_t k = 0; k < all.count; ++k) {
        const SurfacePlace& q = all.places[k];
        const SurfaceJet jet = local_jet(q);
        double angle = kHalfTurn;
        if (at_end(q.u) && at_end(q.v)) {
            const Vec3 a = q.u == 0.0 ? jet.du : -jet.du;
            const Vec3 b = q.v == 0.0 ? jet.dv : -jet.dv;
            const double lengths = std::sqrt(glm::dot(a, a) * glm::dot(b, b));
            angle = lengths > 0.0 ? arc_cos(glm::dot(a, b) / lengths) : 0.0;
        }
        sum += angle * normal_at(q, jet);
    }
    return glm::dot(r, sum) < 0.0;
}

}  // namespace palpate::engine
