#pragma once

#include <memory>
#include <vector>

#include "engine/geometry/vec.hpp"

namespace palpate::engine {
class NurbsSurface;
}

namespace palpate::stimuli {

/// Side of a patch times the stronger of its curvatures, halved: no steeper than 30 degrees along x
/// or y.
inline constexpr double kMaxHalfSine = 0.5;
/// How far the level rim goes on beyond the patch on each side, m: out of every reach.
inline constexpr double kRim = 0.5;

/// A square patch that is curved along x and along y: convex, flat, concave, saddle, and what lies
/// between. Its middle is the origin, z points up, the object is below. All about the middle: the
/// patch at x = y = 0 passes through the origin, level.
struct SurfacePatch {
    double size = 0.060;       ///< along x and along y, m
    double curvature_x = 0.0;  ///< 1/m: > 0 bulges up, < 0 is hollow
    double curvature_y = 0.0;
};

/// The exact patch in a level rim: an arc of curvature_x in the plane y = 0, revolved about the
/// axis parallel to x that gives curvature_y, biquadratic and rational (The NURBS Book, 7.5 and
/// 8.5). Equal curvatures give a sphere, opposite ones the inner side of a torus, one of them 0 a
/// cylinder. Beyond its borders the surface goes on straight outwards for kRim, so that no finger
/// comes round an edge.
///
/// In the surface's parameters the patch is u, v in [1, 2]; the rim has the rest of [0, 3].
/// @throws std::invalid_argument if the size is not above 0 or a curvature too strong for it: the
///         value, and what to give
[[nodiscard]] std::shared_ptr<const engine::NurbsSurface> make_surface(const SurfacePatch& patch);

/// The border of a patch seen from above: a closed polyline, m.
[[nodiscard]] std::vector<engine::Vec2> border_of(const engine::NurbsSurface& surface);

/// A corner of a shaded triangle.
struct ShadedPoint {
    engine::Vec2 point{};  ///< m
    float dark = 0.0F;     ///< 0 in the light, to 1
};

/// How a patch is drawn: the top of a block in a light from above on the left, seen from in front
/// and above, at one scale, m. Whoever sees the block's front walls sees the patch cut there, and
/// knows a hill from a hollow.
struct PatchDrawing {
    std::vector<engine::Vec2> border;  ///< closed polyline; nothing of the patch lies outside
    std::vector<std::vector<engine::Vec2>> lines;  ///< of equal u and of equal v
    std::vector<ShadedPoint> shade;                ///< triangles, in threes
    std::vector<std::vector<engine::Vec2>> walls;  ///< the block's two front ones, closed polylines
};
/// Parallel projection, m, y up. For pictures, not for haptics: lines and shade are sampled.
[[nodiscard]] PatchDrawing drawing_of(const engine::NurbsSurface& surface);

}  // namespace palpate::stimuli
