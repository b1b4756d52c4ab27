#pragma once

#include <cstddef>

namespace palpate::engine {

class FeltScene;
class Scene;
class SurfaceScene;
struct FeltState;
struct FeltTrack;

/// A look at what is rendered, which outlives it; or at nothing. It knows the scene by name alone,
/// so that headers that pass one on drag no renderer along: engine/realtime/felt_scene.hpp for
/// those who ask it, and for those who look at a FeltScene.
struct SceneView {
    const Scene* plane = nullptr;
    const SurfaceScene* space = nullptr;

    SceneView(std::nullptr_t = nullptr) noexcept {}                   // NOLINT(*-explicit-*)
    SceneView(const Scene& scene) noexcept : plane(&scene) {}         // NOLINT(*-explicit-*)
    SceneView(const Scene* scene) noexcept : plane(scene) {}          // NOLINT(*-explicit-*)
    SceneView(const SurfaceScene& scene) noexcept : space(&scene) {}  // NOLINT(*-explicit-*)
    SceneView(const FeltScene& scene) noexcept;                       // NOLINT(*-explicit-*)
    SceneView(const FeltScene* scene) noexcept;                       // NOLINT(*-explicit-*)

    /// There is one.
    [[nodiscard]] bool any() const noexcept { return plane != nullptr || space != nullptr; }
};

}  // namespace palpate::engine
