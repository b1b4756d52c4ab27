#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "engine/device/machine.hpp"
#include "engine/realtime/scene_view.hpp"
#include "engine/realtime/tick_record.hpp"
#include "data/trace/replay.hpp"
#include "data/trace/ticks.hpp"
#include "data/verify/findings.hpp"

namespace palpate::data {

/// The ticks of an interval of a trial up to the first chunk that is not what was written.
struct StoredTrace {
    Ticks ticks;
    bool whole = true;  ///< nothing is damaged or missing in between
    /// Contacts are what chunks hold; else all are what the scene makes of HIP.
    bool holds_contacts = false;
    bool on_virtual_clock = true;  ///< no tick was ever late by anything
    bool punctual = true;          ///< all ticks are whole periods after the first deadline
};

/// Checks every chunk: codec, checksum, streams, counts, order, that the replay of what it does not
/// hold has the hash that the recorder wrote, and that what everybody can read is what the exact
/// numbers say.
/// @param chunks     of the interval, in order
/// @param scene      as the trial's, with its decays
/// @param period_ns  of the session
/// @param room       for the ticks, if it is large enough: pages that need not be cleared again
[[nodiscard]] StoredTrace check_trace(std::span<const ChunkView> chunks,
                                      const engine::SceneView& scene,
                                      const std::optional<engine::PantographSpec>& machine,
                                      std::int64_t period_ns,
                                      Findings& findings,
                                      Ticks room);

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

}  // namespace palpate::data
