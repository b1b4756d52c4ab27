#pragma once

#include <array>
#include <vector>

#include "engine/surface/distance_form.hpp"

namespace palpate::engine {

/// A small part of a patch with bounds that hold for every point of it, from its control points.
class SurfaceLeaf {
public:
    /// @param net         control values w (P, 1) of this part alone
    /// @param polynomial  all w are 1
    SurfaceLeaf(int degree_u, int degree_v, std::span<const Quad> net, bool polynomial);

    /// No point of the leaf is closer to h: squared distance to its oriented box, m^2.
    [[nodiscard]] double bound2(const Vec3& h) const noexcept;

    struct Bowl {
        double depth = 0.0;  ///< > 0: |S - h|^2 has one minimum here; a lower bound of a curvature
        double slack = 0.0;  ///< HIP may move so far, m, and it still has
    };
    /// Is g = (|S - h|^2 - d2) W^2 convex over the leaf, and how far can h move? Linear in h.
    /// A minimum x of |S - h|^2 with |S(x) - h|^2 = d2 is then the only one: g is convex, and flat
    /// and 0 at x, so that it is nowhere negative.
    [[nodiscard]] Bowl bowl(const Vec3& h, double d2) const noexcept;

    /// bowl() for a point on the leaf itself: how well the leaf is resolved.
    [[nodiscard]] double quality() const noexcept { return bowl(centre_, 0.0).depth; }
    [[nodiscard]] const Box<3>& box() const noexcept { return box_; }
    [[nodiscard]] const DistanceForm& form() const noexcept { return form_; }

private:
    /// A second derivative of g: constant part, part linear in q = h - centre, part with W^2.
    struct Bend {
        double low = 0.0;
        double high = 0.0;
        Vec3 slope{};         ///< of -q: middle of the range
        double spread = 0.0;  ///< radius of that range
        double ww_low = 0.0;
        double ww_high = 0.0;
    };
    DistanceForm set_box(int degree_u, int degree_v, std::span<const Quad> net);
    void scale(Bend& bend, double by) const noexcept;

    std::array<Vec3, 3> axes_{};
    Vec3 centre_{};
    Vec3 half_{};
    Bend uu_{};
    Bend uv_{};
    Bend vv_{};
    double drift_ = 0.0;     ///< change of the second derivatives per m of h, without W
    double drift_ww_ = 0.0;  ///< and per m^2 of |q|^2 - d2
    Box<3> box_{};
    DistanceForm form_;  ///< of this part
};

/// Control values of the part [u0, u1] x [v0, v1] of a patch.
[[nodiscard]] std::vector<Quad> part_of_net(const BezierPatch& patch, const PatchPart& part);

}  // namespace palpate::engine
