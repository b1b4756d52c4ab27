#pragma once

#include <cstdint>

#include "engine/device/gantry.hpp"
#include "engine/realtime/scene_view.hpp"
#include "data/verify/stored_trace.hpp"

namespace palpate::data {

/// Where chunks hold contacts: runs the trial's recorded HIP through `scene` again and compares, to
/// the bit: force, normal and tangential force, GO, mu, u, segment, mode, and the flags skipped and
/// outside cone. One finding a column, with its first tick and how many differ. Other contacts are
/// the scene's already.
void check_replay(const engine::SceneView& scene, const StoredTrace& trace, Findings& findings);

/// Of three straight axes: HIP is where the counts say, in one finding with its first tick and how
/// many differ. A tick whose device gave no place, having no counts or some outside the workspace,
/// keeps that before it.
void check_counts(const engine::Gantry& gantry, const StoredTrace& trace, Findings& findings);

/// What is stored of a virtual clock's ticks: none is late, time goes in whole periods. A real
/// clock's ticks: time never goes back.
/// @param period_ns  T, ns
void check_times(const StoredTrace& trace, std::int64_t period_ns, Findings& findings);

/// No tick was ever late by anything: the trial ran on a virtual clock.
[[nodiscard]] bool on_virtual_clock(const StoredTrace& trace) noexcept;

}  // namespace palpate::data
