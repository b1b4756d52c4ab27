#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "engine/contact/piece_tree.hpp"
#include "engine/geometry/outline.hpp"

namespace palpate::engine {

/// Where a point of the outline is: on a span at u, or on the seam between two spans.
/// A seam at a convex or concave vertex owns a Voronoi region of its own.
struct Place {
    bool on_seam = false;
    std::size_t index = 0;   ///< of the span or of the seam
    double parameter = 0.0;  ///< u in [0, 1] on a span; fan angle phi in [0, turn] on a seam, rad
};

/// A place of an outline in the words of who wrote it, whatever spans its segments consist of.
struct SegmentPlace {
    std::size_t segment = 0;  ///< on vertex j, where segments j and j + 1 meet: j
    double u = 0.0;  ///< the segment's own parameter (its knots'); on a vertex that of its end
    bool on_vertex = false;
    double angle = 0.0;  ///< on a vertex the fan angle phi, rad in [0, turn]; else 0
};

/// @pre `place` is one of `outline`. A kink or a cusp within a segment is no vertex: it is that
/// place of the segment, and its fan angle has no name.
[[nodiscard]] inline SegmentPlace segment_place(const Outline& outline,
                                                const Place& place) noexcept {
    const Seam* seam = place.on_seam ? &outline.seams()[place.index] : nullptr;
    const SpanName& name = outline.name(seam != nullptr ? seam->before : place.index);
    const bool on_vertex = seam != nullptr && seam->is_vertex;
    return {.segment = name.segment,
            .u = name.parameter(seam != nullptr ? 1.0 : place.parameter),
            .on_vertex = on_vertex,
            .angle = on_vertex ? place.parameter : 0.0};
}

/// The foot of h on an outline, m, in the frame of the outline.
struct ClosestPoint {
    Place place{};
    Vec2 point{};
    double distance = 0.0;  ///< |h - point|, m
    bool inside = false;  ///< h lies strictly inside the object (never for a point on the outline)
};

/// The global closest point of a whole outline: the nearest of all spans and vertices.
class OutlineFeet {
public:
    /// Builds the tree of pieces. @param outline  outlives this
    explicit OutlineFeet(const Outline& outline);

    /// Global answer. Ties go to either place. What is nearest decides between outside and inside:
    /// a span by the side of its normal; a convex vertex is seen from outside only, a concave one
    /// from inside only; beyond an open end everything is outside.
    [[nodiscard]] ClosestPoint closest(const Vec2& h) const noexcept;

    /// The outline that was given.
    [[nodiscard]] const Outline& outline() const noexcept { return *outline_; }
    /// Its spans in pieces; span i of the tree is span i of the outline.
    [[nodiscard]] const PieceTree<2>& tree() const noexcept { return tree_; }

    /// The foot as a place of the outline, with its side. `tangent`: any vector along C' there.
    [[nodiscard]] ClosestPoint named(const Vec2& h,
                                     const Foot<2>& foot,
                                     const Vec2& tangent) const noexcept {
        return amid(foot.span, foot.u) ? on_span(h, foot, tangent, false)
                                       : near_end(h, foot, tangent);
    }
    /// Far from the ends of the span, where named() is no matter of seams.
    [[nodiscard]] bool amid(std::size_t span, double u) const noexcept {
        return std::fabs(u - 0.5) < 0.5 - kNearEnd && plain_[span];
    }
    /// The closest point of h where h is nearest to a seam.
    [[nodiscard]] ClosestPoint at_seam(std::size_t seam, const Vec2& h) const noexcept;

private:
    /// Rounding puts a foot at an end this near to it.
    static constexpr double kNearEnd = 1e-6;

    [[nodiscard]] static ClosestPoint on_span(const Vec2& h,
                                              const Foot<2>& foot,
                                              const Vec2& tangent,
                                              bool beyond) noexcept {
        return {.place = {.index = foot.span, .parameter = foot.u},
                .point = foot.point,
                .distance = std::sqrt(foot.distance2),
                .inside = !beyond && cross(tangent, h - foot.point) < 0.0};
    }
    [[nodiscard]] ClosestPoint near_end(const Vec2& h,
                                        const Foot<2>& foot,
                                        const Vec2& tangent) const noexcept;

    const Outline* outline_;
    PieceTree<2> tree_;
    std::vector<char> plain_;  ///< of each span: at neither end do control points repeat
};

}  // namespace palpate::engine
