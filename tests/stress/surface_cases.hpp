#pragma once

#include "engine/surface/surface_scene.hpp"
#include "tests/stress/stress_scene.hpp"
#include "tests/support/surface_oracle.hpp"

/// Random surfaces and random hands over them.
namespace palpate::stress {

struct SurfaceCase {
    std::uint64_t seed = 0;
    tests::SurfaceData
        data;  ///< over which the hand goes: what is felt, or the whole of its pieces
    std::vector<tests::SurfaceData> pieces;  ///< joined; empty: one surface
    std::string law = "frictionless";
    engine::SceneSpec spec{};
    std::shared_ptr<const engine::NurbsSurface> surface;
    std::vector<engine::Vec3> path;
};

/// One seed is one case. Gentle: balls, rings, tubes, sheets of soft waves and hands as people move
/// them. Wild: degrees 1 to 9, weights 1e-3 to 1e3, sizes 1e-6 to 1e3 m, folded and degenerate
/// sheets, edges that are a point, heavy control points far away, hands that jump.
[[nodiscard]] SurfaceCase random_surface_case(std::uint64_t seed, Mood mood);
/// The same in two or four pieces, turned at random; in half of the cases bent, so that their
/// joints are creases. None where folds lie on each other, which are no object.
[[nodiscard]] std::optional<SurfaceCase> random_patches_case(std::uint64_t seed, Mood mood);

/// What is felt, ready for a scene.
[[nodiscard]] std::vector<std::shared_ptr<const engine::NurbsSurface>> surfaces_of(
    const SurfaceCase& c);

/// As `palpate render` reads them, every number with all its digits.
[[nodiscard]] std::string scene_text(const SurfaceCase& c);
[[nodiscard]] std::string path_text(const SurfaceCase& c);

}  // namespace palpate::stress
