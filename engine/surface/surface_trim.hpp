#pragma once

#include <memory>
#include <span>
#include <vector>

#include "engine/surface/nurbs_surface.hpp"

namespace palpate::engine {

/// A closed way in (u, v) along lines of constant u and v, corner after corner; the last one leads
/// back to the first.
using TrimLoop = std::vector<Vec2>;

/// What loops leave of a surface, as surfaces for a SurfaceObject, which joins them again.
///
/// Kept is what lies to the left of the loops: inside of those that run counter-clockwise (seen
/// from outside, u to the right and v upwards), outside of those that run clockwise, the holes.
/// Without one that runs counter-clockwise everything but the holes is kept. The surface is cut
/// exactly, by inserting knots at the u and the v of every corner, and the cells that are kept stay
/// surfaces with their own u and v: closest points, open borders and proofs are those of any
/// object.
///
/// Loops that are not along lines of constant u and v are refused: their images on the surface have
/// degrees (degree_u + degree_v) times their own, for which no proved closest point is here.
/// @throws std::invalid_argument for fewer than 4 corners, an edge across u and v, a corner outside
///     of the domain, lines within 1e-9 of the domain, loops that cross or run the wrong way round,
///     more than kMaxCells cells, nothing left: which, the values, what to give
[[nodiscard]] std::vector<std::shared_ptr<const NurbsSurface>> trimmed(
    const NurbsSurface& surface, std::span<const TrimLoop> loops);

inline constexpr std::size_t kMaxCells = 256;

}  // namespace palpate::engine
