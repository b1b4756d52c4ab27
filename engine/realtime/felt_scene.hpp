#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <variant>

#include "engine/rendering/scene.hpp"
#include "engine/surface/surface_scene.hpp"

namespace palpate::engine {

/// What a trial renders: an outline in the plane, or surfaces in space. Which, is decided once a
/// trial.
class FeltScene {
public:
    /// @throws std::invalid_argument as Scene
    FeltScene(std::shared_ptr<const Outline> outline, const SceneSpec& spec)
        : scene_(std::in_place_type<Scene>, std::move(outline), spec) {}
    /// @throws std::invalid_argument as SurfaceScene
    FeltScene(std::shared_ptr<const NurbsSurface> surface, const SurfaceSceneSpec& spec)
        : scene_(std::in_place_type<SurfaceScene>, std::move(surface), spec) {}

    /// Null: it is in space.
    [[nodiscard]] const Scene* plane() const noexcept { return std::get_if<Scene>(&scene_); }
    /// Null: it is in the plane.
    [[nodiscard]] const SurfaceScene* space() const noexcept {
        return std::get_if<SurfaceScene>(&scene_);
    }

    /// What a replay has to be given.
    [[nodiscard]] const StribeckDecay& decay() const noexcept {
        return plane() != nullptr ? plane()->decay() : space()->decay();
    }
    /// The same scene with decay constants recorded earlier, for a replay to the bit.
    void restore_decay(const StribeckDecay& recorded) noexcept {
        std::visit([&recorded](auto& scene) { scene.restore_decay(recorded); }, scene_);
    }

private:
    std::variant<Scene, SurfaceScene> scene_;
};

/// A look at such a scene, which outlives it; or at none.
struct SceneView {
    const Scene* plane = nullptr;
    const SurfaceScene* space = nullptr;

    SceneView(std::nullptr_t = nullptr) noexcept {}                   // NOLINT(*-explicit-*)
    SceneView(const Scene& scene) noexcept : plane(&scene) {}         // NOLINT(*-explicit-*)
    SceneView(const Scene* scene) noexcept : plane(scene) {}          // NOLINT(*-explicit-*)
    SceneView(const SurfaceScene& scene) noexcept : space(&scene) {}  // NOLINT(*-explicit-*)
    SceneView(const FeltScene& scene) noexcept                        // NOLINT(*-explicit-*)
        : plane(scene.plane()), space(scene.space()) {}
    SceneView(const FeltScene* scene) noexcept {  // NOLINT(*-explicit-*)
        if (scene != nullptr) {
            *this = SceneView(*scene);
        }
    }

    /// There is one.
    [[nodiscard]] bool any() const noexcept { return plane != nullptr || space != nullptr; }
};

/// What lives on from tick to tick, of whichever scene it is.
struct FeltState {
    ContactState plane{};
    SurfaceState space{};
};

/// What lives on between questions for closest points.
struct FeltTrack {
    TrackState plane{};
    SurfaceTrack space{};
};

}  // namespace palpate::engine
