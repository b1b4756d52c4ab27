#pragma once

#include <cstdint>
#include <vector>

#include "engine/realtime/tick_record.hpp"
#include "data/store/database.hpp"

namespace palpate::data {

/// Ids of the answered trials, in the order in which they were run.
[[nodiscard]] std::vector<std::int64_t> answered_trials(Database& database);

/// All stored ticks of a trial, each chunk checked.
/// @throws TraceError if a chunk is damaged or ticks are missing between two
/// @throws StoreError if there is no such trial
[[nodiscard]] std::vector<engine::TickRecord> read_trace(Database& database, std::int64_t trial);

}  // namespace palpate::data
