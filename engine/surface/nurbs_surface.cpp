#include "engine/surface/nurbs_surface.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"

namespace palpate::engine {
namespace {

using Points = std::vector<std::vector<Vec3>>;
using Weights = std::vector<std::vector<double>>;

std::size_t row_length(const Points& points) {
    return points.empty() ? 0 : points.front().size();
}

void check_shape(const Points& points, const Weights& weights) {
    for (std::size_t i = 0; i < points.size(); ++i) {
        refuse_if(points[i].size() != row_length(points),
                  "points[{}] has {} points, points[0] {}: give rows of the same length", i,
                  points[i].size(), row_length(points));
    }
    if (weights.empty()) {
        return;
    }
    refuse_if(weights.size() != points.size(),
              "{} rows of weights for {} rows of points: give one weight a point, or none",
              weights.size(), points.size());
    for (std::size_t i = 0; i < weights.size(); ++i) {
        refuse_if(weights[i].size() != points[i].size(),
                  "weights[{}] has {} values for {} points: give one weight a point, or none", i,
                  weights[i].size(), points[i].size());
    }
}

/// Points and weights in one row after the other, about an origin.
struct Net {
    Vec3 origin{};
    double size = 0.0;
    Box<3> box{};
    bool polynomial = true;
    std::vector<Quad> values;
};

Net make_net(const Points& points, const Weights& weights) {
    check_shape(points, weights);
    std::vector<Vec3> flat;
    std::vector<double> w;
    for (std::size_t i = 0; i < points.size(); ++i) {
        for (std::size_t j = 0; j < points[i].size(); ++j) {
            w.push_back(weights.empty() ? 1.0 : weights[i][j]);
            flat.push_back(points[i][j]);
            check_control_point<3>(flat.back(), w.back(), flat.size() - 1);
        }
    }
    Net net;
    const Box<3> box = box_of<3>(flat);
    net.origin = box.middle();
    net.size = glm::length(box.size());
    net.box = {box.low - net.origin, box.high - net.origin};
    net.polynomial = std::all_of(w.begin(), w.end(), [&w](double x) { return x == w[0]; });
    for (std::size_t k = 0; k < flat.size(); ++k) {
        const double weight = net.polynomial ? 1.0 : w[k];
        net.values.push_back(quad(weight * (flat[k] - net.origin), weight));
    }
    return net;
}

/// The same point and weight, up to the rounding of whoever wrote a circle down.
bool same(const Quad& a, const Quad& b, double size) {
    const double w = std::max(a.w(), b.w());
    const Vec3 gap = (1.0 / a.w()) * a.xyz() - (1.0 / b.w()) * b.xyz();
    return std::fabs(a.w() - b.w()) <= 1e-12 * w && glm::length(gap) <= 1e-12 * size;
}

bool one_point(std::span<const Quad> row, double size) {
    return std::all_of(row.begin(), row.end(), [&](const Quad& q) {
        return glm::length((1.0 / q.w()) * q.xyz() - (1.0 / row[0].w()) * row[0].xyz()) <=
               1e-12 * size;
    });
}

/// Whether du x dv vanishes all over the patch: it is nowhere wider than kFlat of the size. There
/// normal_at() finds nothing, and the last bits of coordinates, 1e-16 of them, turn what it would
/// find by 1e-6 rad, the share of the size to which a slide's end is found. Numerator and
/// denominator of du x dv are of at most thrice the degree each way: so many places speak for all.
bool has_no_width(const BezierPatch& patch, double size) {
    const int rows = 3 * patch.degree_u() + 1;
    const int columns = 3 * patch.degree_v() + 1;
    for (int i = 0; i < rows; ++i) {
        for (int j = 0; j < columns; ++j) {
            const SurfaceJet jet = patch.at((i + 0.5) / rows, (j + 0.5) / columns);
            const double longer = std::max(glm::length(jet.du), glm::length(jet.dv));
            if (glm::length(glm::cross(jet.du, jet.dv)) > kFlat * size * longer) {
                return false;
            }
        }
    }
    return true;
}

/// A patch of which a curve is left, or a point. Weights alone may gather most of a patch at a
/// heavy point: without them it is still wide.
bool is_mere_curve(const BezierPatch& patch, double size) {
    if (!has_no_width(patch, size)) {
        return false;
    }
    std::vector<Quad> plain;
    for (const Quad& q : patch.net()) {
        plain.push_back(quad((1.0 / q.w()) * q.xyz(), 1.0));
    }
    return has_no_width(BezierPatch(patch.degree_u(), patch.degree_v(), plain, true), size);
}

/// "u from 0 to 1", of a patch.
std::string interval_text(const char* name, const KnotVector::Interval& interval) {
    return std::string(name) + " from " + number_text(interval.lo) + " to " +
           number_text(interval.hi);
}

/// Row by row. @param n  points of a row
std::vector<BezierPatch> patches_of(const KnotVector& knots_u,
                                    const KnotVector& knots_v,
                                    const Net& net,
                                    std::size_t n) {
    std::vector<BezierPatch> patches;
    const auto p = static_cast<std::size_t>(knots_u.degree());
    for (std::size_t i = 0; i < knots_u.intervals().size(); ++i) {
        std::vector<std::vector<Quad>> lines(p + 1);  // Bezier in u, still B-splines in v
        for (std::size_t j = 0; j < n; ++j) {
            const std::vector<Quad> column =
                knots_u.bezier_points(i, std::span<const Quad>(net.values).subspan(j), n);
            for (std::size_t k = 0; k <= p; ++k) {
                lines[k].push_back(column[k]);
            }
        }
        for (std::size_t j = 0; j < knots_v.intervals().size(); ++j) {
            std::vector<Quad> patch;
            for (const std::vector<Quad>& line : lines) {
                const std::vector<Quad> row = knots_v.bezier_points(j, std::span<const Quad>(line));
                patch.insert(patch.end(), row.begin(), row.end());
            }
            patches.emplace_back(knots_u.degree(), knots_v.degree(), patch, net.polynomial);
            refuse_if(is_mere_curve(patches.back(), net.size),
                      "the patch with {} and {} is a mere curve, without an outside: give its rows "
                      "of control points apart from one another",
                      interval_text("u", knots_u.intervals()[i]),
                      interval_text("v", knots_v.intervals()[j]));
        }
    }
    return patches;
}

}  // namespace

NurbsSurface::NurbsSurface(int degree_u,
                           int degree_v,
                           std::vector<double> knots_u,
                           std::vector<double> knots_v,
                           const Points& points,
                           const Weights& weights)
    : knots_u_(std::move(knots_u), degree_u, points.size(), "knots_u"),
      knots_v_(std::move(knots_v), degree_v, row_length(points), "knots_v"),
      rows_(knots_u_.intervals().size()),
      columns_(knots_v_.intervals().size()) {
    const Net net = make_net(points, weights);
    origin_ = net.origin;
    size_ = net.size;
    box_ = net.box;
    polynomial_ = net.polynomial;
    const std::size_t n = row_length(points);
    const std::size_t last = points.size() - 1;
    std::array<std::vector<Quad>, 4> edges;  // first and last of u, then of v
    for (std::size_t j = 0; j < n; ++j) {
        edges[0].push_back(net.values[j]);
        edges[1].push_back(net.values[last * n + j]);
    }
    for (std::size_t i = 0; i <= last; ++i) {
        edges[2].push_back(net.values[i * n]);
        edges[3].push_back(net.values[i * n + n - 1]);
    }
    std::ranges::transform(edges, poles_.begin(),
                           [this](const auto& edge) { return one_point(edge, size_); });
    // Two poles are no seam: an edge that is one point has no other side.
    const auto closed = [&](std::size_t first) {
        return !poles_[first] &&
               std::ranges::equal(edges[first], edges[first + 1],
                                  [this](auto& a, auto& b) { return same(a, b, size_); });
    };
    closed_u_ = points.size() > 2 && closed(0);
    closed_v_ = n > 2 && closed(2);
    patches_ = patches_of(knots_u_, knots_v_, net, n);
}

NurbsSurface NurbsSurface::about(const Vec3& origin) const {
    NurbsSurface moved = *this;
    const Vec3 by = origin_ - origin;
    moved.origin_ = origin;
    moved.box_ = {box_.low + by, box_.high + by};
    for (BezierPatch& patch : moved.patches_) {
        std::vector<Quad> net(patch.net().begin(), patch.net().end());
        for (Quad& q : net) {
            q += quad(q.w() * by, 0.0);
        }
        patch = BezierPatch(patch.degree_u(), patch.degree_v(), net, patch.polynomial());
    }
    return moved;
}

SurfacePlace NurbsSurface::place_of(double u, double v) const noexcept {
    const std::size_t i = knots_u_.interval_of(u);
    const std::size_t j = knots_v_.interval_of(v);
    const KnotVector::Interval& a = knots_u_.intervals()[i];
    const KnotVector::Interval& b = knots_v_.intervals()[j];
    return {i, j, (u - a.lo) / (a.hi - a.lo), (v - b.lo) / (b.hi - b.lo)};
}

double NurbsSurface::u_of(const SurfacePlace& p) const noexcept {
    const KnotVector::Interval& a = knots_u_.intervals()[p.i];
    return p.u == 1.0 ? a.hi : a.lo + p.u * (a.hi - a.lo);
}

double NurbsSurface::v_of(const SurfacePlace& p) const noexcept {
    const KnotVector::Interval& b = knots_v_.intervals()[p.j];
    return p.v == 1.0 ? b.hi : b.lo + p.v * (b.hi - b.lo);
}

SurfaceJet NurbsSurface::at(double u, double v) const noexcept {
    const SurfacePlace p = place_of(u, v);
    const KnotVector::Interval& a = knots_u_.intervals()[p.i];
    const KnotVector::Interval& b = knots_v_.intervals()[p.j];
    const double ru = 1.0 / (a.hi - a.lo);
    const double rv = 1.0 / (b.hi - b.lo);
    SurfaceJet jet = local_jet(p);
    jet.point += origin_;
    jet.du *= ru;
    jet.dv *= rv;
    jet.duu *= ru * ru;
    jet.duv *= ru * rv;
    jet.dvv *= rv * rv;
    return jet;
}

Vec3 NurbsSurface::normal(double u, double v) const noexcept {
    const SurfacePlace p = place_of(u, v);
    return normal_at(p, local_jet(p));
}

/// First along v, then u, then both, towards the middle of the patch: the derivative of du x dv on
/// that way if it does not vanish, else du x dv itself a few steps further.
Vec3 NurbsSurface::limit_normal(const SurfacePlace& p) const noexcept {
    const double to_u = p.u < 0.5 ? 1.0 : -1.0;
    const double to_v = p.v < 0.5 ? 1.0 : -1.0;
    const SurfaceJet jet = local_jet(p);
    const double scale = kFlat * size_ * size_;
    const double ways[3][2] = {{0.0, to_v}, {to_u, 0.0}, {to_u, to_v}};
    for (const auto& way : ways) {
        const Vec3 turn_u = way[0] * jet.duu + way[1] * jet.duv;
        const Vec3 turn_v = way[0] * jet.duv + way[1] * jet.dvv;
        const Vec3 slope = glm::cross(turn_u, jet.dv) + glm::cross(jet.du, turn_v);
        const double length = glm::length(slope);
        if (length > scale) {
            return (1.0 / length) * slope;
        }
    }
    for (double step = 1e-4; step < 0.3; step *= 10.0) {
        const SurfaceJet near = patch(p.i, p.j).at(p.u + step * to_u, p.v + step * to_v);
        const Vec3 area = glm::cross(near.du, near.dv);
        const double length = glm::length(area);
        if (length > 1e-16 * size_ * size_) {
            return (1.0 / length) * area;
        }
    }
    return Vec3{0.0, 0.0, 1.0};
}

bool NurbsSurface::cross(SurfacePlace& p, const SurfaceHeading& way) const noexcept {
    const std::size_t last = (way.in_u ? rows_ : columns_) - 1;
    std::size_t& k = way.in_u ? p.i : p.j;
    const bool at_end = k == (way.forward ? last : 0);
    if (at_end && !closed(way.in_u)) {
        return false;
    }
    k = !at_end ? (way.forward ? k + 1 : k - 1) : (way.forward ? 0 : last);
    (way.in_u ? p.u : p.v) = way.forward ? 0.0 : 1.0;
    return true;
}

bool NurbsSurface::smooth(bool in_u, std::size_t k) const noexcept {
    const KnotVector& knots = in_u ? knots_u_ : knots_v_;
    const auto& pieces = knots.intervals();
    return pieces[k].knot - pieces[k - 1].knot < static_cast<std::size_t>(knots.degree());
}

}  // namespace palpate::engine
