#pragma once

#include <cstddef>

#include "engine/contact/piece_tree.hpp"
#include "engine/geometry/outline.hpp"

namespace palpate::engine {

/// Where a point of the outline is: on a span at u, or on the joint between two spans.
/// A joint at a convex or concave vertex owns a Voronoi region of its own.
struct Place {
    bool on_joint = false;
    std::size_t index = 0;   ///< of the span or of the joint
    double parameter = 0.0;  ///< u in [0, 1] on a span; fan angle phi in [0, turn] on a joint, rad
};

struct ClosestPoint {
    Place place{};
    Vec2 point{};
    double distance = 0.0;  ///< |h - point|, m
    bool inside = false;  ///< h lies strictly inside the object (never for a point on the outline)
};

/// The global closest point of a whole outline: nearest feature over all spans and joints.
class OutlineFeet {
public:
    explicit OutlineFeet(const Outline& outline);

    /// Global answer. Ties go to either feature. Outside and inside are decided by the nearest
    /// feature: on a span by the side of its normal; a convex vertex is seen from outside only, a
    /// concave one from inside only; beyond an open end everything is outside.
    [[nodiscard]] ClosestPoint closest(const Vec2& h) const noexcept;

    [[nodiscard]] const Outline& outline() const noexcept { return *outline_; }
    [[nodiscard]] const PieceTree<2>& tree() const noexcept { return tree_; }

    /// The foot as a place of the outline, with its side. `tangent`: any vector along C' there.
    [[nodiscard]] ClosestPoint named(const Vec2& h,
                                     const Foot<2>& foot,
                                     const Vec2& tangent) const noexcept;
    /// The joint as closest feature of h.
    [[nodiscard]] ClosestPoint at_joint(std::size_t joint, const Vec2& h) const noexcept;

private:
    const Outline* outline_;
    PieceTree<2> tree_;
};

}  // namespace palpate::engine
