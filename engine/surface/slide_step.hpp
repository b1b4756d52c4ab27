#pragma once

#include "engine/surface/surface_step.hpp"

/// The steps of a god-object that does not follow the flow: without friction, along an edge, where
/// the flow has no direction.
namespace palpate::engine {

/// The step of this length: into the patch, or along its edge.
[[nodiscard]] SurfaceStep step_of(const Footing& at,
                                  const SurfaceSteps& steps,
                                  double length) noexcept;
/// A step ends on the edge of its patch.
[[nodiscard]] SurfaceStep cut(const SurfaceSpot& s, SurfaceStep step) noexcept;
/// Below the last bits of the parameters.
[[nodiscard]] bool still(const SurfaceStep& step) noexcept;
/// Part of the stretch along the way of `step`, m.
[[nodiscard]] double ahead(const SurfaceStep& step, const SurfaceSpot& s) noexcept;
/// Excess over the cone, m; along an edge only that of the part along it.
[[nodiscard]] double measure(const Footing& at,
                             const SurfaceStep& step,
                             const SurfaceSpot& s) noexcept;
/// How far from the cone a step ends, m.
[[nodiscard]] double left(const Footing& at,
                          const SurfaceStep& step,
                          const SurfaceSpot& s) noexcept;

}  // namespace palpate::engine
