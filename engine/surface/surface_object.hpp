#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "engine/surface/nurbs_surface.hpp"

namespace palpate::engine {

/// A parameter of a patch on an edge of it.
[[nodiscard]] constexpr bool at_end(double t) noexcept {
    return t == 0.0 || t == 1.0;
}
/// The last bits before an edge belong to it: there the next patch, or the border, takes over.
[[nodiscard]] constexpr double snapped(double t) noexcept {
    return t < 8.0 * kEpsilon ? 0.0 : t > 1.0 - 8.0 * kEpsilon ? 1.0 : t;
}
/// A way with this part leaves the patch at once.
[[nodiscard]] constexpr bool leaves(double t, double by) noexcept {
    return (t == 0.0 && by < 0.0) || (t == 1.0 && by > 0.0);
}

/// One NURBS surface or several that are joined into one object.
///
/// Two open borders of different surfaces are joined when they are the same curve in one of the two
/// directions: in equal shares of their knot ranges they are nowhere farther apart than kJoined of
/// the object's size, shown by the Bernstein coefficients of their difference. A joined border is
/// an edge like those between the patches of one surface; a border without a neighbour is open. A
/// border that is one point (a pole) is joined to nothing. At a corner up to kMaxAround patches may
/// meet, reached one from the next over their edges.
///
/// All surfaces are kept about the middle of the whole object. A place on an edge or a corner is
/// many places, one on each patch that meets there: around().
class SurfaceObject {
public:
    /// Of the object's size. What the god-object's stretch may gain when it crosses a border.
    static constexpr double kJoined = 1e-9;
    static constexpr std::size_t kMaxAround = 24;

    /// @throws std::invalid_argument for no or a null surface; for borders that are nearly the same
    ///     (within 1e-3 of the size), or that run along each other in part or with other
    ///     parameters; for a border of three surfaces; for neighbours whose outward normals lie on
    ///     different sides; for more than kMaxAround patches round a corner: which, how much, what
    ///     to give
    explicit SurfaceObject(std::vector<std::shared_ptr<const NurbsSurface>> surfaces);

    /// Its surfaces by index, and the one of a place. @pre k < count()
    [[nodiscard]] std::size_t count() const noexcept { return surfaces_.size(); }
    [[nodiscard]] const NurbsSurface& surface(std::size_t k) const noexcept {
        return *surfaces_[k];
    }
    [[nodiscard]] const NurbsSurface& surface_of(const SurfacePlace& p) const noexcept {
        return *surfaces_[p.surface];
    }
    /// What places and patches are relative to, m, world frame.
    [[nodiscard]] const Vec3& origin() const noexcept { return origin_; }
    /// Diagonal of the box of all control points, m.
    [[nodiscard]] double size() const noexcept { return size_; }

    /// The patch that a place lies on.
    [[nodiscard]] const BezierPatch& patch(const SurfacePlace& p) const noexcept {
        return surface_of(p).patch(p.i, p.j);
    }
    /// As NurbsSurface's, relative to origin().
    [[nodiscard]] SurfaceJet local_jet(const SurfacePlace& p) const noexcept {
        return patch(p).at(p.u, p.v);
    }
    [[nodiscard]] Vec3 normal_at(const SurfacePlace& p, const SurfaceJet& jet) const noexcept {
        return surface_of(p).normal_at(p, jet);
    }
    [[nodiscard]] double u_of(const SurfacePlace& p) const noexcept {
        return surface_of(p).u_of(p);
    }
    [[nodiscard]] double v_of(const SurfacePlace& p) const noexcept {
        return surface_of(p).v_of(p);
    }

    /// Moves a place on the edge to which `way` leads to the same point on the patch beyond it, and
    /// turns `way` to how it goes on there.
    /// @return false at an open border and at a pole: nothing changed
    [[nodiscard]] bool cross(SurfacePlace& p, SurfaceHeading& way) const noexcept;

    /// The place lies on a pole that ends u (`in_u`), or v; or either.
    [[nodiscard]] bool pole(bool in_u, const SurfacePlace& p) const noexcept;
    [[nodiscard]] bool on_pole(const SurfacePlace& p) const noexcept {
        return pole(true, p) || pole(false, p);
    }

    /// A point as all patches see it that meet there.
    struct Around {
        std::array<SurfacePlace, kMaxAround> places{};  ///< the one that was asked for first
        std::size_t count = 0;
        bool open = false;  ///< one of them ends at an open border
        bool pole = false;  ///< one of them ends in a pole
        bool full = false;  ///< there are more
    };
    /// The same point as a place of each patch that meets there; one alone inside a patch.
    [[nodiscard]] Around around(const SurfacePlace& p) const noexcept;

    /// A HIP beside an edge or a corner of the object, whose foot it is, lies behind the surface:
    /// by the normals of the patches round it, each weighed with its angle there (Baerentzen &
    /// Aanaes 2005). False at an open border.
    /// @param r  HIP - foot, m
    [[nodiscard]] bool behind_edge(const SurfacePlace& p, const Vec3& r) const noexcept;

private:
    struct Join {
        bool joined = false;
        bool reversed = false;
        bool same_pieces = false;  ///< spans of one border are spans of the other
        std::uint8_t side = 0;     ///< of the neighbour: u first, u last, v first, v last
        std::size_t surface = 0;
    };
    void join_borders();

    std::vector<std::shared_ptr<const NurbsSurface>> surfaces_;
    Vec3 origin_{};
    double size_ = 0.0;
    std::vector<Join> joins_;  ///< side s of surface k at 4 k + s; empty: nothing is joined
};

}  // namespace palpate::engine
