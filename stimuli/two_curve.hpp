#pragma once

#include <memory>
#include <vector>

#include "engine/geometry/outline.hpp"

namespace palpate::stimuli {

/// The stimulus of the thesis (4.3): two curves A-V and V-B joined at the vertex V, closed by the
/// base line B-A, so that a finger that slides off an end meets a corner and not a hole.
struct TwoCurve {
    engine::Vec2 a{-0.040, 0.0};  ///< m
    engine::Vec2 vertex{0.0, 0.040};
    engine::Vec2 b{0.040, 0.0};
    double curvature = 0.0;  ///< of both curves, 1/m: > 0 convex, 0 straight, < 0 concave
};

/// The exact outline: circular arcs as rational quadratics, segments in the order A-V, V-B, B-A.
/// @throws std::invalid_argument if the curvature is too strong for a chord or the outline runs the
///         wrong way round (A, V, B must be clockwise: the object is on the right of travel)
[[nodiscard]] std::shared_ptr<const engine::Outline> make_outline(const TwoCurve& object);

/// The outline as a closed polyline for pictures, at most `tolerance` m away from it.
/// Starts at A and keeps A, V and B exactly. @pre tolerance > 0
[[nodiscard]] std::vector<engine::Vec2> silhouette(const TwoCurve& object,
                                                   double tolerance = 20e-6);

}  // namespace palpate::stimuli
