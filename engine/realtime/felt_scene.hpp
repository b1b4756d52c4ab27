#pragma once

#include <memory>
#include <utility>
#include <variant>

#include "engine/realtime/scene_view.hpp"
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

/// Of a scene, plane or in space, that outlives the view; of none, the view of nothing.
inline SceneView::SceneView(const FeltScene& scene) noexcept
    : plane(scene.plane()), space(scene.space()) {}

inline SceneView::SceneView(const FeltScene* scene) noexcept {
    if (scene != nullptr) {
        *this = SceneView(*scene);
    }
}

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
