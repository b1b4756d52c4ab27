#pragma once

#include "engine/rendering/mode.hpp"
#include "engine/surface/surface_scene.hpp"

/// A trajectory over a NURBS surface with u kept still, as in the thesis' chapter 3.2.2.
namespace palpate::figures {

inline constexpr double kSurfaceU = 0.42;  ///< the u that is kept still

struct SurfaceTick {
    double t = 0.0;  ///< s
    engine::Vec3 hip{};
    engine::Mode mode = engine::Mode::free;
    engine::Vec3 go{};
    engine::Vec3 force{};         ///< on the user, N
    double depth = 0.0;           ///< of HIP behind the nearest point, m; 0 outside
    double normal_force = 0.0;    ///< N
    double friction_force = 0.0;  ///< N, >= 0
    double mu = 0.0;              ///< 0 while free
    int surface = 0;              ///< on which GO is
    double go_u = 0.0;
    double go_v = 0.0;
};

using SurfaceRun = std::vector<SurfaceTick>;

/// HIP, a place a tick, felt by a scene.
[[nodiscard]] SurfaceRun felt_along(const engine::SurfaceScene& scene,
                                    const std::vector<engine::Vec3>& path);

/// A rational bicubic dome of 4 x 4 control points, 0.1 m wide; inner weights 1.5.
[[nodiscard]] std::shared_ptr<const engine::NurbsSurface> dome();

/// In along the normal, along v at constant depth, deeper along the normal, along v again; felt by
/// engine::SurfaceScene with the numbers of chapter 3.2.1.
[[nodiscard]] SurfaceRun felt_on_dome(const std::shared_ptr<const engine::NurbsSurface>& surface);

/// The instants 1 to 8 of figure 3.2.7.
///
/// 1 contact begins   2 HIP begins to move along   3 GO breaks away   4 HIP goes deeper
/// 5 GO sticks        6 it stops going deeper      7 GO breaks away   8 mu is relaxed
using SurfaceMarkers = std::array<std::optional<std::size_t>, 8>;
[[nodiscard]] SurfaceMarkers find_markers(const SurfaceRun& run);

}  // namespace palpate::figures
