#pragma once

#include <cstdint>
#include <vector>

#include "engine/realtime/tick_record.hpp"
#include "data/store/database.hpp"
#include "data/trace/replay.hpp"
#include "data/verify/findings.hpp"

namespace palpate::data {

/// The ticks of an interval of a trial up to the first chunk that is not what was written.
struct StoredTrace {
    std::vector<engine::TickRecord> ticks;
    bool whole = true;  ///< nothing is damaged or missing in between
};

/// Reads and checks every chunk: codec, checksum, zlib streams, counts, order, and that the replay of what it
/// does not hold has the hash that the recorder wrote.
/// @param scene      as the trial's, with its decays; nothing: it is not known
/// @param period_ns  of the session
[[nodiscard]] StoredTrace load_trace(Database& database,
                                     std::int64_t trial,
                                     std::int64_t interval,
                                     const engine::Scene* scene,
                                     const std::optional<engine::PantographSpec>& machine,
                                     std::int64_t period_ns,
                                     Findings& findings);

}  // namespace palpate::data
