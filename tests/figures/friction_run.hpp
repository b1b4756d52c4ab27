#pragma once

#include "engine/geometry/vec.hpp"
#include "engine/rendering/mode.hpp"
#include "tests/figures/instants.hpp"

/// The pre-determined path of the thesis' chapter 3.2.1 on its object of two curves, felt by two
/// laws.
namespace palpate::figures {

struct FrictionTick {
    double t = 0.0;  ///< s
    engine::Vec2 hip{};
    engine::Mode mode = engine::Mode::free;
    engine::Vec2 cp{};
    engine::Vec2 go{};
    engine::Vec2 force{};         ///< on the user, N
    double depth = 0.0;           ///< of HIP behind the nearest point, m; 0 outside
    double normal_force = 0.0;    ///< N, at the god-object
    double friction_force = 0.0;  ///< N, along the tangent at the god-object, signed
    double mu = 0.0;              ///< 0 while free
    std::size_t cp_curve = 0;
    double cp_u = 0.0;
    std::size_t go_curve = 0;
    double go_u = 0.0;
};

using FrictionRun = std::vector<FrictionTick>;

/// HIP, a place a tick: in along the normal of the first curve, along it at constant depth, deeper
/// along the normal, along again, out; in again near the vertex, and level over it.
[[nodiscard]] std::vector<engine::Vec2> friction_path();

/// By engine::Scene (GOS), with vertex slew.
[[nodiscard]] FrictionRun felt_by_gos(const std::vector<engine::Vec2>& path);
/// By ThesisScene. @param latched  FN[k-1] read as "when slipping began", else as written
[[nodiscard]] FrictionRun felt_by_thesis(const std::vector<engine::Vec2>& path, bool latched);

/// The instants 1 to 13 of figures 3.2.1 to 3.2.4, as ticks of a run.
///
///  1 HIP begins to move along     2 GO breaks away             3 slipping ends: HIP goes deeper
///  4 the first stuck tick         5 it stops going deeper      6 GO breaks away
///  7 mu is relaxed                8 HIP begins to leave        9 contact ends
/// 10 contact begins              11 HIP begins to move level  12 GO breaks away
/// 13 mu is relaxed
///
/// None where a run has no such tick; what follows is looked for after the last one found.
using FrictionMarkers = std::array<std::optional<std::size_t>, 13>;
[[nodiscard]] FrictionMarkers find_markers(const FrictionRun& run);

/// Largest |F[k] - F[k-1]| over ticks from..to, N.
[[nodiscard]] double largest_jump(const FrictionRun& run, std::size_t from, std::size_t to);

}  // namespace palpate::figures
