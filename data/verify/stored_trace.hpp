#pragma once

#include <cstdint>
#include <optional>
#include <span>

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
};

/// Checks every chunk: codec, checksum, streams, counts, order, that the replay of what it does not
/// hold has the hash that the recorder wrote, and that what everybody can read is what the exact
/// numbers say.
/// @param chunks     of the interval, in order
/// @param scene      as the trial's, with its decays
/// @param period_ns  of the session
/// @param room       for the ticks, if it is large enough: pages that the kernel need not clear again
[[nodiscard]] StoredTrace check_trace(std::span<const ChunkView> chunks,
                                      const engine::SceneView& scene,
                                      const std::optional<engine::PantographSpec>& machine,
                                      std::int64_t period_ns,
                                      Findings& findings,
                                      Ticks room);

}  // namespace palpate::data
