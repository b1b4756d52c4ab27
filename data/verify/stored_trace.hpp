#pragma once

#include <cstdint>
#include <vector>

#include "engine/realtime/tick_record.hpp"
#include "data/store/database.hpp"
#include "data/verify/findings.hpp"

namespace palpate::data {

/// The ticks of a trial up to the first chunk that is not what was written.
struct StoredTrace {
    std::vector<engine::TickRecord> ticks;
    bool whole = true;  ///< nothing is damaged or missing in between
};

/// Reads and checks every chunk: codec, zlib stream, crc32, counts, order, and that its
/// bytes are what zlib makes of the ticks, where this zlib is the one that packed the trial.
[[nodiscard]] StoredTrace load_trace(Database& database, std::int64_t trial, Findings& findings);

}  // namespace palpate::data
