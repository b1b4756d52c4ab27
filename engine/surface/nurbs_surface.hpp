#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "engine/geometry/nurbs_curve.hpp"
#include "engine/surface/bezier_patch.hpp"

namespace palpate::engine {

/// A place on a surface as its patch sees it: patch (i, j) and u, v in [0, 1] inside it; of several
/// surfaces that are one object, on the one of this index.
struct SurfacePlace {
    std::size_t i = 0;
    std::size_t j = 0;
    double u = 0.0;
    double v = 0.0;
    std::size_t surface = 0;
};

/// A way over an edge of a patch: the parameter that changes, and whether it grows.
struct SurfaceHeading {
    bool in_u = true;
    bool forward = true;
};

/// du x dv counts as vanished below this share of |du| |dv|, or of the size where one of them is 0.
inline constexpr double kFlat = 1e-10;

/// A NURBS surface, split once into its rational Bezier patches.
///
///     S(u, v) = sum N_i,p(u) N_j,q(v) w_ij P_ij / sum N_i,p(u) N_j,q(v) w_ij
///                                                            The NURBS Book, eq. 4.11
/// u and v run over the knots' [front, back]; the last patches are closed. The object lies on the
/// side away from the outward normal dS/du x dS/dv. Borders are open unless the first and the last
/// row of control points are the same: then the surface is closed in that direction, and its
/// patches are neighbours over the seam. Coordinates are kept about the middle of the control
/// points, so that an object a kilometre away from the world's origin is as exact as its
/// coordinates are.
class NurbsSurface {
public:
    /// @param degree_u  1 to 9, also degree_v
    /// @param knots_u   clamped, any spacing, as KnotVector asks; also knots_v
    /// @param points    points[u][v], m, finite; all rows of the same length; they may repeat
    /// @param weights   as many, finite and > 0; empty: all 1
    /// @throws std::invalid_argument with what, the value and the remedy; also for a patch that is
    ///     a mere curve (two equal rows of control points at degree 1 or between full knots): its
    ///     normal would be rounding
    NurbsSurface(int degree_u,
                 int degree_v,
                 std::vector<double> knots_u,
                 std::vector<double> knots_v,
                 const std::vector<std::vector<Vec3>>& points,
                 const std::vector<std::vector<double>>& weights = {});

    /// The knots in u, and in v.
    [[nodiscard]] const KnotVector& knots_u() const noexcept { return knots_u_; }
    [[nodiscard]] const KnotVector& knots_v() const noexcept { return knots_v_; }
    /// All weights are the same.
    [[nodiscard]] bool polynomial() const noexcept { return polynomial_; }
    /// What patches are relative to, m.
    [[nodiscard]] const Vec3& origin() const noexcept { return origin_; }
    /// Diagonal of the box of all control points, m.
    [[nodiscard]] double size() const noexcept { return size_; }
    /// That box, relative to origin(), m.
    [[nodiscard]] const Box<3>& box() const noexcept { return box_; }
    /// The same surface, kept about another origin, m.
    [[nodiscard]] NurbsSurface about(const Vec3& origin) const;
    /// What lies within [lo_u, hi_u] x [lo_v, hi_v], with the same parameters: an exact cut.
    /// @pre  both within the domain, low < high
    [[nodiscard]] NurbsSurface part(double lo_u, double hi_u, double lo_v, double hi_v) const;

    /// S and its derivatives, world frame. Outside of the domain the end patch goes on.
    [[nodiscard]] SurfaceJet at(double u, double v) const noexcept;
    /// Unit outward normal; on a collapsed edge the limit from inside along v or u. (0, 0, 1) on a
    /// surface without area.
    [[nodiscard]] Vec3 normal(double u, double v) const noexcept;

    /// Patch i of those along u, j along v.
    [[nodiscard]] std::size_t rows() const noexcept { return rows_; }        ///< patches along u
    [[nodiscard]] std::size_t columns() const noexcept { return columns_; }  ///< patches along v
    /// Patch i of those along u, j along v.
    [[nodiscard]] const BezierPatch& patch(std::size_t i, std::size_t j) const noexcept {
        return patches_[i * columns_ + j];
    }
    /// The patch and its own parameters of (u, v), which are clamped to the domain.
    [[nodiscard]] SurfacePlace place_of(double u, double v) const noexcept;
    /// The surface's u, or v, of a place.
    [[nodiscard]] double u_of(const SurfacePlace& p) const noexcept;
    [[nodiscard]] double v_of(const SurfacePlace& p) const noexcept;
    /// Jet per unit of the patch's own parameters, relative to origin().
    [[nodiscard]] SurfaceJet local_jet(const SurfacePlace& p) const noexcept {
        return patch(p.i, p.j).at(p.u, p.v);
    }
    /// Unit normal at `p`, whose local jet is `jet`.
    [[nodiscard]] Vec3 normal_at(const SurfacePlace& p, const SurfaceJet& jet) const noexcept {
        const Vec3 area = glm::cross(jet.du, jet.dv);
        const double area2 = glm::dot(area, area);
        const double a2 = glm::dot(jet.du, jet.du);
        const double b2 = glm::dot(jet.dv, jet.dv);
        const double tiny = kFlat * kFlat * size_ * size_;
        const bool flat = !(area2 > kFlat * kFlat * a2 * b2 && a2 > tiny && b2 > tiny);
        return flat ? limit_normal(p) : (1.0 / std::sqrt(area2)) * area;
    }

    /// Whether the borders at both ends of u (`in_u`), or v, are one.
    [[nodiscard]] bool closed(bool in_u) const noexcept { return in_u ? closed_u_ : closed_v_; }
    /// Whether the border u = first (or last) is one point: a pole. So for v.
    [[nodiscard]] bool pole(bool in_u, bool last) const noexcept {
        return poles_[(in_u ? 0U : 2U) + (last ? 1U : 0U)];
    }
    /// Moves a place on an edge of its patch, u (or v) = 0 or 1, to the same point on the next
    /// patch.
    /// @return false at an open border: nothing changed
    [[nodiscard]] bool cross(SurfacePlace& p, const SurfaceHeading& way) const noexcept;
    /// S W and W go on with a continuous derivative from patch row (or column) k - 1 to k > 0.
    [[nodiscard]] bool smooth(bool in_u, std::size_t k) const noexcept;

private:
    [[nodiscard]] Vec3 limit_normal(const SurfacePlace& p) const noexcept;

    KnotVector knots_u_;
    KnotVector knots_v_;
    std::size_t rows_ = 0;
    std::size_t columns_ = 0;
    Vec3 origin_{};
    double size_ = 0.0;
    Box<3> box_{};
    bool polynomial_ = false;
    bool closed_u_ = false;
    bool closed_v_ = false;
    std::array<bool, 4> poles_{};
    std::vector<BezierPatch> patches_;
};

}  // namespace palpate::engine
