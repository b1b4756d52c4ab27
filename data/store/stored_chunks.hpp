#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "data/store/database.hpp"
#include "data/trace/chunk.hpp"
#include "data/trace/replay.hpp"

namespace palpate::data {

/// The chunks of one interval as they lie in the file, by first_tick.
struct StoredChunks {
    std::vector<ChunkView> views;  ///< of `data`: move this, do not copy it
    std::vector<std::vector<std::byte>> data;
};

/// @throws TraceError if a row cannot be a chunk
[[nodiscard]] StoredChunks stored_chunks(Database& database,
                                         std::int64_t trial,
                                         std::int64_t interval = 1);

/// Whose a trial is, and what its scene was.
struct TrialContext {
    std::int64_t session = 0;
    TraceTrial trial;
};

/// @throws std::invalid_argument if there is no such trial
[[nodiscard]] TrialContext trial_context(Database& database,
                                         std::int64_t trial,
                                         std::int64_t interval = 1);

/// The protocol and the calibration with which the session began. @throws protocols::ProtocolError
[[nodiscard]] SessionTraces session_traces(Database& database, std::int64_t session);

/// The calibration text with which a session began; empty: its device has none.
[[nodiscard]] std::string first_calibration(Database& database, std::int64_t session);

}  // namespace palpate::data
